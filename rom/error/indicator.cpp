#include "indicator.hpp"

#include <Eigen/LU>
#include <Eigen/QR>
#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "../../lib/errors.hpp"

namespace tact {
namespace {

constexpr Index block_rows = 512;  // a block of gaps at 40 times then stays in cache
constexpr Index screening_modes = 16;

bool is_diagonal(const SparseMatrix& A) {
    for (Index j = 0; j < A.cols(); ++j)
        for (SparseMatrix::InnerIterator it(A, j); it; ++it)
            if (it.row() != j) return false;
    return true;
}

/// (B')^+ X = (B B')^-1 B X.
DenseMatrix multiplier_of(const Matrix& B, const DenseMatrix& X) {
    if (const DenseMatrix* dense = B.dense())
        return Eigen::CompleteOrthogonalDecomposition<DenseMatrix>(dense->transpose()).solve(X);
    DenseMatrix result = B.times(X);
    const SparseMatrix rows = B.to_sparse();
    const SparseMatrix gram = SparseMatrix(rows * SparseMatrix(rows.transpose())).pruned(0.0, 0.0);
    if (is_diagonal(gram)) {  // rows that share no unknown
        const Vector d = gram.diagonal();
        for (Index i = 0; i < d.size(); ++i) result.row(i) *= d[i] > 0 ? 1 / d[i] : 0;
        return result;
    }
    const Eigen::SimplicialLDLT<SparseMatrix> factor(gram);
    if (factor.info() != Eigen::Success || !(factor.vectorD().minCoeff() > 1e-13 * factor.vectorD().maxCoeff()))
        throw NumericalError("Indicator: B B' (" + Matrix(gram).shape() +
                             ") is singular, the rows of B are dependent");
    return factor.solve(result);
}

/// Coefficients of an affine vector at the given times, a column each.
DenseMatrix coefficients_at(const AffineVector& a, const std::vector<double>& times) {
    DenseMatrix result = DenseMatrix::Ones(a.mode_count(), static_cast<Index>(times.size()));
    if (a.constant()) return result;
    for (std::size_t j = 0; j < times.size(); ++j)
        a.coefficients(times[j], Side::right, result.col(static_cast<Index>(j)));
    return result;
}

/// block -= modes * coefficients, of a gap that is constant in time or not.
void subtract_gap(const Eigen::Ref<const DenseMatrix>& modes, bool constant, const DenseMatrix& coefficients,
                  Eigen::Ref<DenseMatrix> block) {
    if (constant && modes.cols() == 1)
        block.colwise() -= modes.col(0);
    else
        block.noalias() -= modes * coefficients;
}

void check_weight(const char* name, double value) {
    if (!(value >= 0) || !std::isfinite(value))
        throw InputError(std::string("IndicatorWeights: ") + name + " is " + shown(value) +
                         ", expected a finite number >= 0");
}

}  // namespace

ReducedStateRecorder::ReducedStateRecorder(std::vector<long> steps) : steps_(std::move(steps)) {
    if (!std::is_sorted(steps_.begin(), steps_.end()))
        throw InputError("ReducedStateRecorder: steps are not ascending");
    states_.times.reserve(steps_.size());
}

Observer ReducedStateRecorder::observer(const ContactProblem& reduced) {
    const Index count = static_cast<Index>(steps_.size());
    states_.times.clear();
    states_.q.resize(reduced.size(), count);
    states_.v.resize(reduced.size(), reduced.second_order() ? count : 0);
    states_.s.resize(reduced.constraints(), count);
    return [this](const State& state, const StepReport&) {
        const Index j = states_.size();
        if (j == states_.q.cols() || steps_[static_cast<std::size_t>(j)] != state.step) return Flow::proceed;
        states_.q.col(j) = state.u();
        if (states_.v.cols() > 0) states_.v.col(j) = state.v();
        states_.s.col(j) = state.lambda;
        states_.times.push_back(state.t);
        return Flow::proceed;
    };
}

Indicator::Indicator(const Shared<ContactFamily>& family, const ReducedBasis& basis, IndicatorWeights weights)
    : family_(family), weights_(weights), parametric_(!family->names().empty()), p_(basis.primal_size()) {
    check_weight("penetration", weights.penetration);
    check_weight("complementarity", weights.complementarity);
    check_weight("negativity", weights.negativity);
    const std::vector<std::string> varying = family->varying();
    const bool forces_needed = weights.complementarity != 0 || weights.negativity != 0;
    if ((forces_needed && !only_gap_varies(*family)) || std::ranges::find(varying, "B") != varying.end())
        throw InputError(
            "Indicator: more than the gap of the family varies, expected the gap only; without "
            "complementarity and negativity all but B may");
    const ContactProblem full = family->at((family->lower() + family->upper()) / 2);
    validate(basis, full);
    c_ = full.c;
    rows_.resize(static_cast<std::size_t>(full.constraints()));
    std::iota(rows_.begin(), rows_.end(), Index{0});
    B_U_ = full.B.times(basis.U);
    if (!forces_needed) {
        const Index screening = std::min(screening_modes, p_);
        U_B_ = B_U_.transpose();
        tail_norm_ = U_B_.bottomRows(p_ - screening).colwise().norm();
        row_norm_ = U_B_.colwise().norm();
        B_U_.conservativeResize(Eigen::NoChange, screening);
        return;
    }
    if (full.constraints() == 0) return;

    const Index p = basis.primal_size();
    const bool damped = full.M && full.D;
    DenseMatrix forces(full.size(), p * (full.is_static() ? 1 : damped ? 3 : 2));
    forces.leftCols(p) = full.K.times(basis.U);
    if (!full.is_static()) forces.middleCols(p, p) = (full.M ? *full.M : *full.D).times(basis.U);
    if (damped) forces.rightCols(p) = full.D->times(basis.U);
    force_ = multiplier_of(full.B, forces);
    load_ = {multiplier_of(full.B, full.f.dense_modes("Indicator: f")), full.f.coefficients, full.f.jumps};
}

/// [q; a; v], what `force_` is multiplied with.
DenseMatrix Indicator::rates(const ContactProblem& reduced, const ReducedStates& states) const {
    const Index p = reduced.size(), count = states.size();
    DenseMatrix result(force_.cols(), count);
    const auto q = states.q.leftCols(count);
    result.topRows(p) = q;
    if (reduced.is_static()) return result;
    DenseMatrix balance = reduced.f.modes * coefficients_at(reduced.f, states.times) - reduced.K.times(q);
    if (reduced.constraints() > 0) balance += reduced.B.transposed_times(states.s.leftCols(count));
    const bool damped = reduced.M && reduced.D;
    if (damped) {
        balance -= reduced.D->times(states.v.leftCols(count));
        result.bottomRows(p) = states.v.leftCols(count);
    }
    const Matrix& leading = reduced.M ? *reduced.M : *reduced.D;
    if (const Vector* d = leading.diagonal_entries())
        result.middleRows(p, p) = d->cwiseInverse().asDiagonal() * balance;
    else
        result.middleRows(p, p) = leading.to_dense().partialPivLu().solve(balance);
    return result;
}

/// sum |[B U q - c]_-|^2. The first modes prove most gaps open: of the others the Cauchy-Schwarz inequality says how much
/// they can add, and in modal coordinates that is little.
double Indicator::penetration(const AffineVector& c, const Eigen::Ref<const DenseMatrix>& q,
                              const DenseMatrix& c_coefficients) const {
    constexpr double rounding = 1e-12;
    const Index m = B_U_.rows(), count = q.cols(), screening = B_U_.cols();
    const Vector tail = q.bottomRows(p_ - screening).colwise().norm(), whole = q.colwise().norm();
    DenseMatrix gap(block_rows, count);
    double sum = 0;
    for (Index i = 0; i < m; i += block_rows) {
        const Index rows = std::min(block_rows, m - i);
        auto block = gap.topRows(rows);
        block.noalias() = B_U_.middleRows(i, rows) * q.topRows(screening);
        subtract_gap(c.modes.middleRows(i, rows), c.constant(), c_coefficients, block);
        for (Index j = 0; j < count; ++j)
            for (Index k = 0; k < rows; ++k) {
                const double first = gap(k, j);
                if (first >= tail[j] * tail_norm_[i + k] + rounding * whole[j] * row_norm_[i + k]) continue;
                const double rest = U_B_.col(i + k).tail(p_ - screening).dot(q.col(j).tail(p_ - screening));
                const double violated = std::min(first + rest, 0.0);
                sum += violated * violated;
            }
    }
    return sum;
}

double Indicator::operator()(const Parameter& gamma, const ContactProblem& reduced,
                             const ReducedStates& states) const {
    const Index m = B_U_.rows(), count = states.size();
    if (m == 0 || count == 0) return 0;
    if (states.q.rows() != p_ || reduced.size() != p_)
        throw InputError("Indicator: q has " + std::to_string(states.q.rows()) + " rows, expected " +
                         std::to_string(p_));
    AffineVector c = c_;
    if (parametric_) {
        Vector values(m);
        family_->gap(gamma, rows_, values);
        c = AffineVector(std::move(values));
    }
    const DenseMatrix c_coefficients = coefficients_at(c, states.times);
    const auto q = states.q.leftCols(count);
    if (force_.size() == 0) return weights_.penetration * penetration(c, q, c_coefficients);
    const DenseMatrix rate = rates(reduced, states);
    const DenseMatrix f_coefficients = coefficients_at(load_, states.times);

    double penetrated = 0, complementarity = 0, negativity = 0;
    DenseMatrix gap(block_rows, count), force(block_rows, count);
    for (Index i = 0; i < m; i += block_rows) {
        const Index rows = std::min(block_rows, m - i);
        auto r1 = gap.topRows(rows);
        r1.noalias() = B_U_.middleRows(i, rows) * q;
        subtract_gap(c.modes.middleRows(i, rows), c.constant(), c_coefficients, r1);
        penetrated += r1.array().min(0).square().sum();
        auto r3 = force.topRows(rows);
        r3.noalias() = force_.middleRows(i, rows) * rate;
        r3.noalias() -= load_.modes.middleRows(i, rows) * f_coefficients;
        for (Index k = 0; k < rows; ++k)
            if (c.modes(i + k, 0) == -infinity) {  // switched off
                r1.row(k).setZero();
                r3.row(k).setZero();
            }
        complementarity += r1.cwiseProduct(r3).squaredNorm();
        negativity += r3.array().min(0).square().sum();
    }
    return weights_.penetration * penetrated + weights_.complementarity * complementarity +
           weights_.negativity * negativity;
}

}  // namespace tact
