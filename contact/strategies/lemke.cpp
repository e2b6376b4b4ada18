#include "lemke.hpp"

#include <algorithm>
#include <cmath>

namespace tact {
namespace {

/// The dictionary  x_basic + T x_nonbasic = q  of  w - S lambda - 1 z = -g, kept whole: columns w, lambda, z, q.
class Tableau {
public:
    Tableau(const DenseMatrix& S, const ConstVectorRef& g) : m_(g.size()), T_(m_, 2 * m_ + 2), basis_(m_) {
        T_.leftCols(m_).setIdentity();
        T_.middleCols(m_, m_) = -S;
        T_.col(z()).setConstant(-1);
        T_.col(2 * m_ + 1) = -g;
        for (Index i = 0; i < m_; ++i) basis_[i] = i;
    }
    Index z() const { return 2 * m_; }
    double right(Index row) const { return T_(row, 2 * m_ + 1); }
    double entry(Index row, Index column) const { return T_(row, column); }
    Index basic(Index row) const { return basis_[row]; }
    Index complement(Index variable) const { return variable < m_ ? variable + m_ : variable - m_; }

    void pivot(Index row, Index column) {
        T_.row(row) /= T_(row, column);
        T_(row, column) = 1;
        const Vector factors = T_.col(column);
        const Eigen::RowVectorXd pivot_row = T_.row(row);
        for (Index j = 0; j < T_.cols(); ++j) {
            if (pivot_row[j] == 0) continue;
            T_.col(j) -= pivot_row[j] * factors;
            T_(row, j) = pivot_row[j];
        }
        T_.col(column).setZero();
        T_(row, column) = 1;
        basis_[row] = column;
    }

    /// The row that blocks the entering column first, -1 if none; in a tie z leaves, then the lexicographically least.
    Index blocking_row(Index column) const {
        const double floor = 1e-11 * T_.col(column).cwiseAbs().maxCoeff();
        Index best = -1;
        for (Index i = 0; i < m_; ++i)
            if (T_(i, column) > floor && (best < 0 || comes_before(i, best, column))) best = i;
        return best;
    }
    /// The first row to leave for z: the smallest right-hand side, in the same order.
    Index most_violated() const {
        Index worst = 0;
        for (Index i = 1; i < m_; ++i)
            if (right(i) < right(worst)) worst = i;
        return worst;
    }

private:
    bool comes_before(Index i, Index j, Index column) const {
        const double ti = T_(i, column), tj = T_(j, column);
        const double a = right(i) / ti, b = right(j) / tj;
        const double tie = 1e-13 * std::max(std::abs(a), std::abs(b));
        if (std::abs(a - b) > tie) return a < b;
        if (basis_[i] == z() || basis_[j] == z()) return basis_[i] == z();
        for (Index k = 0; k < m_; ++k) {
            const double x = T_(i, k) / ti, y = T_(j, k) / tj;
            if (x != y) return x < y;
        }
        return false;
    }
    Index m_;
    DenseMatrix T_;
    Eigen::Matrix<Index, Eigen::Dynamic, 1> basis_;
};

}  // namespace

LemkeReport lemke(const DenseMatrix& S, const ConstVectorRef& g) {
    const Index m = g.size();
    LemkeReport report;
    report.basic.assign(static_cast<std::size_t>(m), 0);
    if (m == 0 || !(g.maxCoeff() > 0)) return report;
    Tableau tableau(S, g);
    Index row = tableau.most_violated();
    Index entering = tableau.z();
    const int limit = 1000 + 50 * static_cast<int>(m);
    while (true) {
        const Index leaving = tableau.basic(row);
        tableau.pivot(row, entering);
        if (leaving == tableau.z()) break;
        entering = tableau.complement(leaving);
        if (++report.pivots > limit) {
            report.outcome = Outcome::iteration_limit;
            return report;
        }
        row = tableau.blocking_row(entering);
        if (row >= 0) continue;
        report.outcome = Outcome::infeasible;
        report.ray = Vector::Zero(m);
        if (entering >= m) report.ray[entering - m] = 1;
        for (Index i = 0; i < m; ++i)
            if (const Index j = tableau.basic(i); j >= m && j < 2 * m)
                report.ray[j - m] = std::max(0.0, -tableau.entry(i, entering));
        return report;
    }
    for (Index i = 0; i < m; ++i)
        if (const Index j = tableau.basic(i); j >= m) report.basic[static_cast<std::size_t>(j - m)] = 1;
    return report;
}

}  // namespace tact
