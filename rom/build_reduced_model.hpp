// From a family and its bases to a model that needs neither.
#pragma once

#include "tact/rom/reduced_model.hpp"

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

/// Projects the family at probes of its box to see which parts depend on gamma: a part that is the same everywhere is stored
/// once. The gap is interpolated empirically on the rows that U_lambda touches, the other parts in their reduced form, and
/// the values at the interpolation's points become Chebyshev series; where the box has too many parameters for those, the
/// gap is left to a GapFunction. Basis in modal coordinates (modal_basis). InputError as `reduce`; if the problem has internal
/// forces r, a gap that varies both in time and in gamma, or other parts without a series; for quantities and rows that
/// do not fit.
ReducedModelData build_reduced_model(const ContactFamily& family, const ReducedBasis& basis,
                                     const ReducedModelOptions& options = {});

}  // namespace tact
