// What a reduced model's own indicators say about its error, learnt from full solutions.
#pragma once

#include "../model/build_reduced_model.hpp"
#include "greedy.hpp"

namespace tact {

/// One full solution beside its reduced one: the indicators of ErrorChecks, and the relative error
/// (sum over the steps of |U q - u|^2 / sum |u|^2)^(1/2).
struct ErrorSample {
    double penetration = 0, residual = 0, error = 0;
};

/// Sets the weights of the estimate, w_P P + w_R R with w >= 0, to the least on average (in units of the errors) that are no
/// less than the error of any sample, times `safety`; and the effectivities estimate / error of each sample where the
/// others set the weights. Samples without error count for nothing. InputError if a sample has an error and no indicator, safety
/// is less than 1 or there are fewer than two samples with an error.
void calibrate(ErrorChecks& checks, const std::vector<ErrorSample>& samples, double safety = 1.2);

/// Rows of B where the reduced answers at these parameters penetrate: the points of empirical interpolation of their
/// penetrations [c - B U q]_+, at most `count`. Marches are looked at every `stride` steps. Where answers do not converge they
/// tell nothing.
std::vector<Index> penetrated_rows(const Shared<ContactFamily>& family, const ReducedBasis& basis,
                                   const TrainingMethod& method, const TrainingContact& contact,
                                   const std::vector<Parameter>& parameters, Index count, long stride = 10);

/// The samples at these parameters, full and reduced; runs that do not converge are left out.
std::vector<ErrorSample> error_samples(const ContactFamily& family, const ReducedBasis& basis,
                                       const ReducedModel& model, const TrainingMethod& method,
                                       const TrainingContact& contact, const std::vector<Parameter>& parameters);

/// The history of a training as a model keeps it.
TrainingRecord training_record(const TrainingResult& result);

}  // namespace tact
