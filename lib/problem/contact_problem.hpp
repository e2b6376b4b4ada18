// The semi-discrete contact problem, in one notation for full and reduced, static and dynamic.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "matrix.hpp"

namespace tact {

/// Which limit of a function that jumps: f(t-) or f(t+).
enum class Side { left, right };

/// A vector in time: modes * coefficients(t), affine in a few scalar functions. Loads and gaps come in this form so that they
/// are projected once and a reduced step never touches the full size. The modes are dense, or sparse where a load acts on a
/// few unknowns of many. A vector that is no sum of few modes is a `function` of its full size; it cannot be reduced.
class AffineVector {
public:
    using Coefficients = std::function<void(double t, Side side, VectorRef out)>;

    AffineVector() = default;
    /// Constant in time: any Eigen column.
    AffineVector(Vector constant) : modes(std::move(constant)) {}  // NOLINT: a vector is a constant load
    template <class Column>
    requires(Column::ColsAtCompileTime == 1) AffineVector(const Eigen::MatrixBase<Column>& constant)
        : modes(constant) {}  // NOLINT
    /// n x k modes; `coefficients` fills k numbers and must not allocate; where it is empty they are all ones, for ever.
    /// `jumps`: times where it is discontinuous, in order.
    AffineVector(DenseMatrix modes_, Coefficients coefficients_, std::vector<double> jumps_ = {})
        : modes(std::move(modes_)), coefficients(std::move(coefficients_)), jumps(std::move(jumps_)) {}
    AffineVector(SparseMatrix modes, Coefficients coefficients, std::vector<double> jumps = {});
    /// `values` writes the n numbers at t and must not allocate. InputError if it is empty or n < 0.
    static AffineVector function(Index n, Coefficients values, std::vector<double> jumps = {});

    Index size() const { return function_ ? size_ : sparse_ ? sparse_->rows() : modes.rows(); }
    /// k; 0 for a function of full size.
    Index mode_count() const { return sparse_ ? sparse_->cols() : modes.cols(); }
    bool constant() const { return !coefficients && !function_; }
    /// Whether it has no modes.
    bool is_function() const { return function_ != nullptr; }
    /// The vector at t; `scratch` holds at least mode_count() numbers.
    void evaluate(double t, Side side, VectorRef scratch, VectorRef out) const;
    Vector at(double t, Side side = Side::right) const;

    /// The k modes, sparse ones too, as a dense n x k matrix. InputError in the name of `what` for a function of full size.
    DenseMatrix dense_modes(std::string_view what) const;
    /// Modes with few entries as they are stored; else nullptr.
    const SparseMatrix* sparse_modes() const { return sparse_.get(); }

    DenseMatrix modes;          ///< n x k if they are dense, else empty
    Coefficients coefficients;  ///< empty: constant, or a function of full size
    std::vector<double> jumps;

private:
    std::shared_ptr<const SparseMatrix> sparse_;
    Coefficients function_;
    Index size_ = 0;
};

/// Internal forces that are not linear in u, beside K u, with their tangent.
struct InternalForce {
    /// out = r(u), n numbers; must not allocate in a step.
    std::function<void(const ConstVectorRef& u, VectorRef out)> force;
    /// dr/du at u, n x n.
    std::function<Matrix(const ConstVectorRef& u)> tangent;
    /// r as a potential, for the energy ledger; may be empty: no energy is then reported for it.
    std::function<double(const ConstVectorRef& u)> energy = {};
};

/// M u'' + D u' + K u + r(u) = f(t) + B' lambda,   B u - c(t) >= 0,   lambda >= 0,   lambda . (B u - c) = 0
///
/// n unknowns, m contact constraints. What a scene lacks is absent: no M is first order in time, no M and no D is
/// static, a B without rows is free of contact. c_i = -infinity switches row i off. Passive data: steppers, contact
/// solvers and `reduce` read it; none is stored in it. (Balajewicz, Amsallem, Farhat, eq. 3.)
struct ContactProblem {
    std::optional<Matrix> M;  ///< n x n, symmetric
    std::optional<Matrix> D;  ///< n x n
    Matrix K;                 ///< n x n
    Matrix B;                 ///< m x n
    AffineVector c;           ///< m, the gap function's offset
    AffineVector f;           ///< n
    Vector u0;                ///< n
    Vector v0;                ///< n, or empty unless second order in time
    std::optional<InternalForce> r = {};
    /// Rows of other kinds (RowBounds): an upper bound B u <= c_up(t), m; none: infinity. Rows with c_i = c_up_i are equations.
    std::optional<AffineVector> c_up = {};
    /// Bounds of the multipliers, m numbers or empty: -infinity and infinity. A friction bound s: c = c_up, -s and s.
    Vector force_lo = {}, force_up = {};

    Index size() const { return K.rows(); }
    Index constraints() const { return B.rows(); }
    bool second_order() const { return M.has_value(); }
    bool is_static() const { return !M && !D; }
    /// Whether all rows are B u >= c with lambda >= 0.
    bool contact_only() const { return !c_up && force_lo.size() == 0 && force_up.size() == 0; }
};

/// Throws InputError naming the first field, and its first entry, that has a wrong shape, a NaN or infinite entry (c may hold
/// -infinity, c_up infinity), rows with c > c_up, a force_lo above or a force_up below zero, jumps that are not in order, or an
/// M that is not symmetric, or a function that is missing in r.
void validate(const ContactProblem& problem);

/// InputError in the name of `who` unless all rows are contact rows.
void require_contact_rows(const char* who, const ContactProblem& problem);

}  // namespace tact
