// From a family and its bases to a model that needs neither.
#pragma once

#include "reduced_model.hpp"

namespace tact {

/// A number to be read off every state: u . displacement + lambda . force.
struct QuantityOfInterest {
    std::string name;
    Vector displacement;  ///< n, or empty
    Vector force;         ///< m, or empty
};

struct ReducedModelOptions {
    ReducedMethod method = {};
    double tolerance = 1e-11;      ///< of interpolation in gamma, as a fraction of the largest entry
    double acceptable = 1e-6;      ///< error of a series over the box; one with more is left to ExactFunctions
    Index max_terms = 100;         ///< of empirical interpolation
    Index samples = 300;           ///< parameters it learns from, besides the box's corners
    ChebyshevOptions series = {};  ///< its tolerance is set to the one above
    long time_refinement = 1;      ///< points of the tables of time to a step
    bool keep_basis = true;        ///< without it the model cannot lift
    std::vector<QuantityOfInterest> quantities = {};
    std::vector<Index> check_rows = {};      ///< rows of B for ErrorChecks
    std::vector<Index> check_unknowns = {};  ///< rows of K; not read where M, D, K, B or f depend on gamma
    long check_stride = 10;
    TrainingRecord training = {};
};

/// What does not depend on gamma (ContactFamily::varying) is stored once; probes of the box see whether that is true. The gap
/// is interpolated empirically on the rows that U_lambda touches, the other parts in their reduced form or, where the
/// family tells its coefficients, by the terms that belong to these. The values at the interpolation's points, or the
/// coefficients, become Chebyshev series; where those do not come close, as in a box of many parameters, they are left to
/// ExactFunctions. Basis in modal
/// coordinates (modal_basis). InputError as `reduce`; if the problem has internal forces r, a gap that varies both in
/// time and in gamma, a part that varies against what the family says, parts that are not affine in its coefficients, or others
/// without a series; for quantities and rows that do not fit.
ReducedModelData build_reduced_model(const ContactFamily& family, const ReducedBasis& basis,
                                     const ReducedModelOptions& options = {});

}  // namespace tact
