#include "klu_active_set.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "../../lib/sparse/klu_solver.hpp"
#include "../dense/acceptance.hpp"
#include "../prepare/matrix_facts.hpp"
#include "../prepare/rows.hpp"

namespace tact {
namespace {

using Triplet = Eigen::Triplet<double, long>;

/// The system of one active set, in one pattern for all of them. Unknowns: u, and mu_i for the rows without an
/// unknown of their own.
///   active row i with own unknown o:   row o:      B_i u = c_i
///                                      row j:      A_j u - (B_ij/B_io) A_o u = b_j - (B_ij/B_io) b_o,  j in row i
///   row i without:                     row n + k:  B_i u = c_i (active) or mu_i = 0;   A u - B_i' mu_i in the rows of u
class CondensedSystem {
public:
    CondensedSystem(const SparseMatrix& A, const ConstraintRows& rows)
        : rows_(rows),
          n_(A.rows()),
          by_row_(SparseMatrix(A.transpose())),
          own_(find_own_unknowns()),
          klu_(pattern()) {}

    Index size() const { return klu_.matrix().rows(); }

    /// Other numbers; false, and nothing done, if the pattern is another one.
    bool take(const SparseMatrix& A) {
        const SparseMatrix by_row(A.transpose());
        const auto same = [](const auto* a, const auto* b, Index count) { return std::equal(a, a + count, b); };
        if (by_row.rows() != n_ || by_row.nonZeros() != by_row_.nonZeros() ||
            !same(by_row.outerIndexPtr(), by_row_.outerIndexPtr(), n_ + 1) ||
            !same(by_row.innerIndexPtr(), by_row_.innerIndexPtr(), by_row.nonZeros()))
            return false;
        by_row_ = by_row;
        return true;
    }

    /// Fills in the values of this set and refactors; false if singular.
    bool factor(const std::vector<char>& active) {
        SparseMatrix& S = klu_.matrix();
        Eigen::Map<Vector>(S.valuePtr(), S.nonZeros()).setZero();
        for (Index r = 0; r < n_; ++r) {
            const long i = owner_[static_cast<std::size_t>(r)];
            if (i >= 0 && active[static_cast<std::size_t>(i)]) {
                const auto columns = rows_.columns(i);
                for (std::size_t k = 0; k < columns.size(); ++k) at(r, columns[k]) += rows_.weights(i)[k];
            } else {
                add_row(r, r, 1);
            }
        }
        for (Index i = 0; i < rows_.rows(); ++i) {
            const bool on = active[static_cast<std::size_t>(i)];
            const auto columns = rows_.columns(i);
            const auto weights = rows_.weights(i);
            const Index own = own_[static_cast<std::size_t>(i)];
            if (own >= 0) {
                if (!on) continue;
                for (std::size_t k = 0; k < columns.size(); ++k)
                    if (columns[k] != own) add_row(columns[k], own, -weights[k] / weight_of(i, own));
            } else {
                const Index extra = extra_[static_cast<std::size_t>(i)];
                for (std::size_t k = 0; k < columns.size(); ++k) {
                    at(columns[k], extra) = -weights[k];
                    if (on) at(extra, columns[k]) = weights[k];
                }
                if (!on) at(extra, extra) = 1;
            }
        }
        return klu_.refactor();
    }

    /// Solves for u and lambda on the set last factored.
    void solve(const ConstVectorRef& b, const ConstVectorRef& c, const std::vector<char>& active, Vector& u,
               Vector& lambda) {
        x_.setZero(size());
        x_.head(n_) = b;
        for (Index i = 0; i < rows_.rows(); ++i) {
            if (!active[static_cast<std::size_t>(i)]) continue;
            const Index own = own_[static_cast<std::size_t>(i)];
            if (own < 0) {
                x_[extra_[static_cast<std::size_t>(i)]] = c[i];
                continue;
            }
            const auto columns = rows_.columns(i);
            for (std::size_t k = 0; k < columns.size(); ++k)
                if (columns[k] != own) x_[columns[k]] -= rows_.weights(i)[k] / weight_of(i, own) * b[own];
            x_[own] = c[i];
        }
        klu_.solve(x_);
        u = x_.head(n_);
        lambda.setZero(rows_.rows());
        for (Index i = 0; i < rows_.rows(); ++i) {
            if (!active[static_cast<std::size_t>(i)]) continue;
            const Index own = own_[static_cast<std::size_t>(i)];
            if (own < 0) {
                lambda[i] = x_[extra_[static_cast<std::size_t>(i)]];
                continue;
            }
            double force = -b[own];
            for (SparseMatrix::InnerIterator it(by_row_, own); it; ++it) force += it.value() * u[it.index()];
            lambda[i] = force / weight_of(i, own);
        }
    }

private:
    double weight_of(Index row, Index column) const {
        const auto columns = rows_.columns(row);
        for (std::size_t k = 0; k < columns.size(); ++k)
            if (columns[k] == column) return rows_.weights(row)[k];
        return 0;
    }

    /// An unknown is a row's own if no other row touches it: then its equilibrium gives the row's multiplier alone.
    std::vector<Index> find_own_unknowns() {
        std::vector<int> uses(static_cast<std::size_t>(n_), 0);
        for (Index i = 0; i < rows_.rows(); ++i)
            for (const int j : rows_.columns(i)) ++uses[static_cast<std::size_t>(j)];
        std::vector<Index> own(static_cast<std::size_t>(rows_.rows()), -1);
        owner_.assign(static_cast<std::size_t>(n_), -1);
        extra_.assign(own.size(), -1);
        Index extras = 0;
        for (Index i = 0; i < rows_.rows(); ++i) {
            double largest = 0;
            const auto columns = rows_.columns(i);
            for (std::size_t k = 0; k < columns.size(); ++k) {
                const double weight = std::abs(rows_.weights(i)[k]);
                if (uses[static_cast<std::size_t>(columns[k])] == 1 && weight > largest) {
                    largest = weight;
                    own[static_cast<std::size_t>(i)] = columns[k];
                }
            }
            if (largest > 0)
                owner_[static_cast<std::size_t>(own[static_cast<std::size_t>(i)])] = i;
            else
                extra_[static_cast<std::size_t>(i)] = n_ + extras++;
        }
        extras_ = extras;
        return own;
    }

    SparseMatrix pattern() {
        std::vector<Triplet> entries;
        const auto copy_row = [&](Index target, Index source) {
            for (SparseMatrix::InnerIterator it(by_row_, source); it; ++it)
                entries.emplace_back(target, it.index(), 1.0);
        };
        for (Index r = 0; r < n_; ++r) copy_row(r, r);
        for (Index i = 0; i < rows_.rows(); ++i) {
            const auto columns = rows_.columns(i);
            const Index own = own_[static_cast<std::size_t>(i)];
            const Index extra = extra_[static_cast<std::size_t>(i)];
            if (own < 0) entries.emplace_back(extra, extra, 1.0);
            for (std::size_t k = 0; k < columns.size(); ++k) {
                if (own >= 0) {
                    entries.emplace_back(own, columns[k], 1.0);
                    if (columns[k] != own) copy_row(columns[k], own);
                } else {
                    entries.emplace_back(extra, columns[k], 1.0);
                    entries.emplace_back(columns[k], extra, 1.0);
                }
            }
        }
        SparseMatrix S(n_ + extras_, n_ + extras_);
        S.setFromTriplets(entries.begin(), entries.end());
        return S;
    }

    double& at(Index row, Index column) {
        SparseMatrix& S = klu_.matrix();
        const long* first = S.innerIndexPtr() + S.outerIndexPtr()[column];
        const long* last = S.innerIndexPtr() + S.outerIndexPtr()[column + 1];
        return S.valuePtr()[std::lower_bound(first, last, row) - S.innerIndexPtr()];
    }

    void add_row(Index target, Index source, double factor) {
        for (SparseMatrix::InnerIterator it(by_row_, source); it; ++it) at(target, it.index()) += factor * it.value();
    }

    const ConstraintRows& rows_;
    Index n_;
    Index extras_ = 0;
    SparseMatrix by_row_;  // A', so that its columns are A's rows
    std::vector<long> owner_;
    std::vector<Index> extra_;
    std::vector<Index> own_;
    KluRefactorable klu_;
    Vector x_;
};

/// A power of two, so that scaling rounds nothing, near 1 / sqrt(x); 1 where x is not positive.
double unit_of(double x) { return x > 0 ? std::exp2(std::round(-0.5 * std::log2(x))) : 1; }

Vector unit_rows(const SparseMatrix& B) {
    Vector square = Vector::Zero(B.rows());
    for (Index j = 0; j < B.outerSize(); ++j)
        for (SparseMatrix::InnerIterator it(B, j); it; ++it) square[it.row()] += it.value() * it.value();
    return square.unaryExpr(&unit_of);
}

/// In unknowns of unit stiffness and rows of unit length, where pivots say whether the system of a set is singular.
class PreparedKlu final : public PreparedContact {
public:
    PreparedKlu(const Matrix& A, const Matrix& B)
        : given_B_(B),
          accept_(A, B),
          unit_(A.main_diagonal().unaryExpr(&unit_of)),
          B_(B.to_sparse() * unit_.asDiagonal()),
          row_unit_(unit_rows(B_)),
          rows_(Matrix(SparseMatrix(row_unit_.asDiagonal() * B_))),
          system_(unit_.asDiagonal() * A.to_sparse() * unit_.asDiagonal(), rows_),
          active_(static_cast<std::size_t>(B.rows()), 0) {}

    /// In the units of the first A, while the new one's are within a factor of 16.
    bool update(const Matrix& A) override {
        if (A.rows() != unit_.size() || A.cols() != unit_.size()) return false;
        check_no_negative_diagonal("KluActiveSet", A);
        const Vector change = A.main_diagonal().unaryExpr(&unit_of).cwiseQuotient(unit_);
        if (!(change.minCoeff() >= 1.0 / 16 && change.maxCoeff() <= 16)) return false;
        if (!system_.take(unit_.asDiagonal() * A.to_sparse() * unit_.asDiagonal())) return false;
        accept_ = Acceptance(A, given_B_);
        factored_.reset();
        return true;
    }

    ContactReport solve(const ConstVectorRef& b, const ConstVectorRef& c, ContactPoint point) override {
        ContactReport report;
        report.strategy = "KLU condensed";
        const Index m = rows_.rows();
        b_ = b.cwiseProduct(unit_);
        c_ = c.cwiseProduct(row_unit_);
        for (Index i = 0; i < m; ++i) active_[static_cast<std::size_t>(i)] = point.lambda[i] > 0 && c[i] != -infinity;
        std::vector<std::uint64_t> visited;
        for (report.iterations = 1;; ++report.iterations) {
            const auto print = fingerprint();
            if (std::find(visited.begin(), visited.end(), print) != visited.end()) {
                report.set_repeated = true;
                report.outcome = Outcome::cycling;
                return report;
            }
            visited.push_back(print);
            if (report.iterations > iteration_limit) {
                report.outcome = Outcome::iteration_limit;
                return report;
            }
            if (active_ != factored_) {
                if (!system_.factor(active_)) {
                    if (std::find(active_.begin(), active_.end(), char{1}) == active_.end())
                        throw NumericalError("KluActiveSet: A is singular (" + std::to_string(b.size()) + "x" +
                                             std::to_string(b.size()) + ")");
                    factored_.reset();
                    report.outcome = Outcome::inaccurate;  // dependent rows in contact
                    return report;
                }
                factored_ = active_;
            }
            system_.solve(b_, c_, active_, u_, lambda_);
            bool changed = false;
            for (Index i = 0; i < m; ++i) {
                auto& on = active_[static_cast<std::size_t>(i)];
                bool now = false;
                if (c[i] != -infinity) {
                    const double gap = rows_.gather(i, u_.data()) - c_[i];
                    now =
                        on ? lambda_[i] > 0 : gap < -2e-14 * (std::abs(c_[i]) + rows_.gather_absolute(i, u_.data()));
                }
                changed |= now != static_cast<bool>(on);
                on = now;
            }
            if (!changed) break;
        }
        // A bound is met exactly: a gap of zero then is zero, not rounding.
        for (Index i = 0; i < m; ++i)
            if (active_[static_cast<std::size_t>(i)] && rows_.columns(i).size() == 1)
                u_[rows_.columns(i)[0]] = c_[i] / rows_.weights(i)[0];
        u_ = u_.cwiseProduct(unit_).eval();
        lambda_ = lambda_.cwiseProduct(row_unit_).eval();
        accept_.certify(report, b, c, u_, lambda_, acceptable, 0, point);
        return report;
    }

private:
    static constexpr double acceptable = 1e-10;
    static constexpr int iteration_limit = 100;

    std::uint64_t fingerprint() const {
        std::uint64_t hash = 1469598103934665603ULL;
        for (const char on : active_) hash = (hash ^ static_cast<std::uint64_t>(on)) * 1099511628211ULL;
        return hash;
    }

    Matrix given_B_;
    Acceptance accept_;
    Vector unit_;
    SparseMatrix B_;  // in these units
    Vector row_unit_;
    ConstraintRows rows_;
    CondensedSystem system_;
    std::vector<char> active_;
    std::optional<std::vector<char>> factored_;  // the set in the factor
    Vector b_, c_, u_, lambda_;
};

}  // namespace

std::unique_ptr<PreparedContact> KluActiveSet::prepare(const Matrix& A, const Matrix& B) const {
    check_contact_matrices("KluActiveSet", A, B);
    check_no_negative_diagonal("KluActiveSet", A);
    return std::make_unique<PreparedKlu>(A, B);
}

}  // namespace tact
