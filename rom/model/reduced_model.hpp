// A reduced model that needs nothing of the full one: data, and the family of problems it stands for.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "chebyshev_series.hpp"
#include "reduced_basis.hpp"
#include "time_table.hpp"

namespace tact {

/// x(gamma) ~ terms * theta(gamma): N numbers from k functions of gamma.
struct ParameterExpansion {
    DenseMatrix terms;      ///< N x k
    ChebyshevSeries theta;  ///< k; empty where a function has to give them (ExactFunctions)
    bool empty() const { return terms.size() == 0; }
};

/// How the model was trained to be marched and solved; the caller makes the objects.
struct ReducedMethod {
    std::string integrator;  ///< Integrator::name(); empty: static
    TimeGrid grid;
    double compliance = 0;  ///< of the dense contact solver
    bool screening = true;
};

/// Numbers to be read off each state: Q q + Q_lambda s.
struct ReducedQuantities {
    std::vector<std::string> names;
    DenseMatrix Q;         ///< k x p
    DenseMatrix Q_lambda;  ///< k x p_lambda
};

/// Few rows of the full problem on which an answer is checked, and what was learnt about the error from them:
///   penetration  P = (sum over J of |[c - B U q]_+|^2 / sum over J of |q|^2)^(1/2) on some rows of B,
///   residual     R = the same of M U a + D U v + K U q - f - B'U_lambda s on some rows of K,
///   estimate     e = penetration_weight P + residual_weight R,
/// with the accelerations a of the reduced balance and J every `stride`-th step (statics: the solution).
struct ErrorChecks {
    std::vector<Index> rows;      ///< of B
    DenseMatrix B_U;              ///< rows x p
    DenseMatrix gap;              ///< rows x modes of c, or x terms of theta where the gap depends on gamma
    std::vector<Index> unknowns;  ///< rows of K
    DenseMatrix M_U, D_U, K_U, load, multipliers;  ///< on `unknowns`: M U, D U, K U, modes of f, B'U_lambda
    long stride = 1;

    Index calibrated_on = 0;  ///< full solutions; 0: there is no estimate
    double penetration_weight = 0, residual_weight = 0;
    double tolerance = infinity;  ///< estimates above it are not trusted
    /// Estimate over true error where each solution is estimated by what the others taught.
    double least_effectivity = 0, median_effectivity = 0, largest_effectivity = 0;
};

/// What training was.
struct TrainingRecord {
    std::vector<Parameter> samples;      ///< in their order
    std::vector<double> max_indicators;  ///< after each sample; NaN without a scan
    std::string stop_reason;
};

/// All a reduced model is. The parts of `centre` in `parts` and, where `gap` is not empty, its c are those of the box's
/// centre only; functions of time are tables.
struct ReducedModelData {
    std::vector<std::string> names;
    Parameter lower, upper;
    ReducedBasis basis;              ///< for lifting; may be empty
    ContactProblem centre;           ///< reduced
    TimeTable load, moving;          ///< the coefficients of f and of c, where they vary in time
    ParameterExpansion gap;          ///< c
    std::vector<Index> gap_rows;     ///< theta of `gap` is c in these rows of the full problem
    ParameterExpansion others;       ///< the entries of `parts`, one after the other, matrices by columns
    std::vector<std::string> parts;  ///< of M, D, K, B, f, u0, v0, which depend on gamma
    bool affine = false;             ///< theta of `others` is ContactFamily::coefficients
    double parameter_error = 0;      ///< largest at 16 points of the box, as a fraction of the part's largest entry
    ReducedMethod method;
    ReducedQuantities quantities;
    ErrorChecks checks;
    TrainingRecord training;
};

/// What stands in for series over the box; either may be empty.
struct ExactFunctions {
    /// c of the full problem on `rows`, which are the model's gap_rows.
    std::function<void(const Parameter& gamma, std::span<const Index> rows, VectorRef out)> gap = {};
    /// ContactFamily::coefficients, for families that offer them.
    std::function<Vector(const Parameter& gamma)> coefficients = {};
};

/// The problems of a reduced model. Those of all gammas share what does not depend on gamma; none touches the full size.
class ReducedModel final : public ContactFamily {
public:
    /// InputError that names the field if the data do not fit together.
    explicit ReducedModel(ReducedModelData data, ExactFunctions exact = {});

    std::vector<std::string> names() const override { return data_.names; }
    Parameter lower() const override { return data_.lower; }
    Parameter upper() const override { return data_.upper; }
    std::vector<std::string> varying() const override;
    /// InputError unless gamma holds one finite number a parameter, or where there is neither a series nor a function.
    ContactProblem at(const Parameter& gamma) const override;
    void gap(const Parameter& gamma, std::span<const Index> rows, VectorRef out) const override;

    /// Whether gamma is in the box.
    bool covers(const Parameter& gamma) const;
    /// c on the rows of `checks`; time is read only where c varies in it.
    void checked_gap(const Parameter& gamma, double t, VectorRef out) const;
    const ReducedModelData& data() const { return data_; }
    /// The same model in storage of its own. Threads that share matrices wait for each other where they count who holds them.
    ReducedModel unshared() const;

private:
    Vector gap_coefficients(const Parameter& gamma) const;
    Vector other_coefficients(const Parameter& gamma) const;
    void check(const Parameter& gamma) const;
    ReducedModelData data_;
    ExactFunctions exact_;
};

/// Singular values and conditions that say how well a pair of bases carries contact.
struct BasisReport {
    Index p = 0, p_lambda = 0;
    double inf_sup_constant = 0;  ///< of B_r, see reduce.hpp
    double schur_condition = 0;  ///< largest over smallest eigenvalue of S_r = B_r A_r^-1 B_r'; infinite if dependent
    Index schur_rank = 0;        ///< eigenvalues above 1e-12 of the largest
};
/// For the combination of M, D and K that is solved with (a stage's: a^2, a, 1). NumericalError if it is singular.
BasisReport report_basis(const ContactProblem& reduced, const Combination& combination = {});

}  // namespace tact
