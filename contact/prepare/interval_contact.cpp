#include "interval_contact.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

namespace tact {
namespace {

std::size_t at(Index i) { return static_cast<std::size_t>(i); }

/// One side of a row: sign B_i u >= bound with a force up to `most`.
struct Side {
    Index row;
    double sign;
};

/// The rows of B, then those with an upper bound once more with their sign turned.
class Sides {
public:
    Sides(const Matrix& B, const RowBounds& rows, const std::vector<Side>& before) {
        for (Index i = 0; i < B.rows(); ++i) sides_.push_back({i, 1});
        std::vector<char> turned(at(B.rows()), 0);
        for (const Side& side : before) turned[at(side.row)] |= side.sign < 0;
        for (Index i = 0; i < B.rows(); ++i)
            if (turned[at(i)] || rows.upper_of(i) < infinity) sides_.push_back({i, -1});
        const SparseMatrix Bt = B.to_sparse().transpose();
        std::vector<Eigen::Triplet<double, long>> entries;
        for (Index k = 0; k < count(); ++k)
            for (SparseMatrix::InnerIterator it(Bt, sides_[at(k)].row); it; ++it)
                entries.emplace_back(k, it.index(), sides_[at(k)].sign * it.value());
        SparseMatrix expanded(count(), B.cols());
        expanded.setFromTriplets(entries.begin(), entries.end());
        B_ = B.sparse() || B.diagonal_entries() ? Matrix(std::move(expanded)) : Matrix(DenseMatrix(expanded));
    }

    Index count() const { return static_cast<Index>(sides_.size()); }
    const Matrix& B() const { return B_; }
    const std::vector<Side>& all() const { return sides_; }
    const Side& operator[](Index k) const { return sides_[at(k)]; }

    double bound(const RowBounds& rows, Index k) const {
        const auto& [row, sign] = sides_[at(k)];
        return sign > 0 ? rows.lower[row] : -rows.upper_of(row);
    }
    double most(const RowBounds& rows, Index k) const {
        const auto& [row, sign] = sides_[at(k)];
        return sign > 0 ? rows.most_force(row) : -rows.least_force(row);
    }
    /// Whether every row with an upper bound has both sides.
    bool cover(const RowBounds& rows) const {
        Index turned = 0;
        for (Index i = 0; i < rows.size(); ++i) turned += rows.upper_of(i) < infinity;
        if (turned == 0) return true;
        std::vector<char> there(at(rows.size()), 0);
        for (const Side& side : sides_) there[at(side.row)] |= side.sign < 0;
        for (Index i = 0; i < rows.size(); ++i)
            if (rows.upper_of(i) < infinity && !there[at(i)]) return false;
        return true;
    }

private:
    std::vector<Side> sides_;
    Matrix B_;
};

class PreparedIntervals final : public PreparedContact {
public:
    PreparedIntervals(const Matrix& A, const Matrix& B, std::shared_ptr<const ContactSolver> inner)
        : A_(A), B_(B), recipe_(std::move(inner)), certificate_(A, B) {}

    bool reads_guess() const override { return !inner_ || inner_->reads_guess(); }

    ContactReport solve(const ConstVectorRef& b, const ConstVectorRef& c, ContactPoint point) override {
        return solve_rows(b, RowBounds(c), point);
    }

    ContactReport solve_rows(const ConstVectorRef& b, const RowBounds& rows, ContactPoint point) override {
        check_row_bounds(rows);
        if (!sides_ || !sides_->cover(rows)) {
            sides_.emplace(B_, rows, sides_ ? sides_->all() : std::vector<Side>{});
            inner_ = recipe_->prepare(A_, sides_->B());
        }
        read(rows, point);
        ContactReport report = find_yielding(b);
        if (report.outcome == Outcome::cycling) report = solve_with_slack(b, std::move(report));
        fold_certificate(report);
        if (report.outcome != Outcome::converged) return report;
        Vector lambda = Vector::Zero(rows.size());
        double gap_size = 0;
        for (Index k = 0; k < sides_->count(); ++k) {
            const auto& [row, sign] = (*sides_)[k];
            lambda[row] += sign * (yields_[at(k)] ? most_[k] : lambda_[k]);
            if (std::abs(bound_[k]) < infinity) gap_size = std::max(gap_size, std::abs(bound_[k]));
        }
        certify(report, certificate_, b, rows, u_, lambda, acceptable, gap_size, point);
        return report;
    }

private:
    static constexpr double acceptable = 1e-9;

    void read(const RowBounds& rows, const ContactPoint& point) {
        const Index count = sides_->count();
        u_ = point.u;
        lambda_.resize(count);
        bound_.resize(count);
        most_.resize(count);
        yields_.assign(at(count), 0);
        for (Index k = 0; k < count; ++k) {
            const auto& [row, sign] = (*sides_)[k];
            bound_[k] = sides_->bound(rows, k);
            most_[k] = sides_->most(rows, k);
            lambda_[k] = std::max(sign * point.lambda[row], 0.0);
            if (lambda_[k] >= most_[k] && most_[k] < infinity && lambda_[k] > 0) yields_[at(k)] = 1;
        }
    }

    /// The active set of the rows that give way.
    ContactReport find_yielding(const ConstVectorRef& b) {
        const bool bounded = (most_.array() < infinity && bound_.array() > -infinity).any();
        std::vector<std::vector<char>> visited;
        int iterations = 0;
        while (true) {
            load_ = b;
            off_ = bound_;
            for (Index k = 0; k < sides_->count(); ++k) {
                if (!yields_[at(k)]) continue;
                force_.setZero(sides_->count());
                force_[k] = most_[k];
                sides_->B().multiply_transposed(force_, load_, 1, 1);
                off_[k] = -infinity;
                lambda_[k] = 0;
            }
            ContactReport report = inner_->solve(load_, off_, {u_, lambda_});
            report.iterations = iterations += report.iterations;
            if (!bounded) return report;
            if (report.outcome == Outcome::infeasible) {
                if (!give_way_where_excluded(report.infeasibility)) return report;
            } else if (report.outcome != Outcome::converged || !change_yielding()) {
                return report;
            }
            if (std::find(visited.begin(), visited.end(), yields_) != visited.end()) {
                report.set_repeated = true;
                report.outcome = Outcome::cycling;
                return report;
            }
            visited.push_back(yields_);
        }
    }

    /// A row gives way where its force exceeds what it may be, and holds again where it has come back to its bound.
    bool change_yielding() {
        Vector place(sides_->count()), size = place;
        sides_->B().multiply(u_, place);
        bool changed = false;
        for (Index k = 0; k < sides_->count(); ++k) {
            if (most_[k] == infinity || bound_[k] == -infinity) continue;
            // At the bound to rounding, either answer is right: what is stays.
            const double rounding = 1e-13 * std::max(std::abs(bound_[k]), std::abs(place[k]));
            const bool yields = yields_[at(k)] ? place[k] <= bound_[k] + rounding : lambda_[k] > most_[k];
            changed |= yields != static_cast<bool>(yields_[at(k)]);
            yields_[at(k)] = yields;
        }
        return changed;
    }

    /// Rows that exclude each other only while those that may give way hold; whether there are such.
    bool give_way_where_excluded(const Vector& y) {
        bool changed = false;
        for (Index k = 0; k < y.size(); ++k) {
            if (!(y[k] > 0) || most_[k] == infinity || yields_[at(k)]) continue;
            yields_[at(k)] = 1;
            changed = true;
        }
        return changed;
    }

    /// One programme with an unknown for each row that may give way.
    ContactReport solve_with_slack(const ConstVectorRef& b, ContactReport before) {
        const Index n = A_.rows(), count = sides_->count();
        std::vector<Index> slack;
        for (Index k = 0; k < count; ++k)
            if (most_[k] < infinity && bound_[k] > -infinity) slack.push_back(k);
        const Index extra = static_cast<Index>(slack.size());
        std::vector<Eigen::Triplet<double, long>> entries;
        const auto add = [&](const SparseMatrix& M) {
            for (Index j = 0; j < M.outerSize(); ++j)
                for (SparseMatrix::InnerIterator it(M, j); it; ++it) entries.emplace_back(it.row(), j, it.value());
        };
        add(A_.to_sparse());
        SparseMatrix A(n + extra, n + extra);
        A.setFromTriplets(entries.begin(), entries.end());
        entries.clear();
        add(sides_->B().to_sparse());
        Vector load = Vector::Zero(n + extra), bound = Vector::Zero(count + extra);
        load.head(n) = b;
        bound.head(count) = bound_;
        for (Index e = 0; e < extra; ++e) {
            entries.emplace_back(slack[at(e)], n + e, 1.0);
            entries.emplace_back(count + e, n + e, 1.0);
            load[n + e] = -most_[slack[at(e)]];
        }
        SparseMatrix B(count + extra, n + extra);
        B.setFromTriplets(entries.begin(), entries.end());
        Vector u = Vector::Zero(n + extra), lambda = Vector::Zero(count + extra);
        try {
            ContactReport report =
                recipe_->prepare(Matrix(std::move(A)), Matrix(std::move(B)))->solve(load, bound, {u, lambda});
            report.iterations += before.iterations;
            report.set_repeated = true;
            if (report.infeasibility.size() > 0) report.infeasibility.conservativeResize(count);
            if (report.ray.size() > 0) report.ray.conservativeResize(n);
            if (report.outcome != Outcome::converged) return report;
            u_ = u.head(n);
            lambda_ = lambda.head(count);
            std::fill(yields_.begin(), yields_.end(), 0);
            // The multiplier of s >= 0 is what is left of the force: none where the row gives way.
            for (Index e = 0; e < extra; ++e)
                if (const Index k = slack[at(e)]; u[n + e] > 0 && lambda_[k] >= 0.5 * most_[k]) yields_[at(k)] = 1;
            for (Index k = 0; k < count; ++k) lambda_[k] = std::min(lambda_[k], most_[k]);
            return report;
        } catch (const InputError&) {
        } catch (const NumericalError&) {}
        return before;
    }

    /// y of the sides as y of the rows.
    void fold_certificate(ContactReport& report) const {
        if (report.infeasibility.size() != sides_->count()) return;
        Vector y = Vector::Zero(B_.rows());
        for (Index k = 0; k < sides_->count(); ++k)
            y[(*sides_)[k].row] += (*sides_)[k].sign * report.infeasibility[k];
        const double largest = y.lpNorm<Eigen::Infinity>();
        report.infeasibility = largest > 0 ? Vector(y / largest) : Vector();
    }

    Matrix A_, B_;
    std::shared_ptr<const ContactSolver> recipe_;
    std::unique_ptr<PreparedContact> inner_;
    std::optional<Sides> sides_;
    KktCertificate certificate_;
    Vector u_, lambda_, bound_, most_, load_, off_, force_;
    std::vector<char> yields_;
};

}  // namespace

void check_row_bounds(const RowBounds& rows) {
    const auto reject = [](Index i, const std::string& what) {
        throw InputError("RowBounds: row " + std::to_string(i) + " " + what);
    };
    for (Index i = 0; i < rows.size(); ++i) {
        const double lower = rows.lower[i], upper = rows.upper_of(i);
        if (!(lower < infinity))
            reject(i, "has a lower bound that is NaN or infinity, expected a number or -infinity");
        if (!(upper > -infinity))
            reject(i, "has an upper bound that is NaN or -infinity, expected a number or infinity");
        if (lower > upper) reject(i, "has a lower bound above its upper one");
        if (rows.force_lower && !((*rows.force_lower)[i] <= 0)) reject(i, "has a force_lower that is not <= 0");
        if (rows.force_upper && !((*rows.force_upper)[i] >= 0)) reject(i, "has a force_upper that is not >= 0");
    }
}

IntervalContact::IntervalContact(std::shared_ptr<const ContactSolver> inner) : inner_(std::move(inner)) {
    if (!inner_) throw InputError("IntervalContact: the contact solver is null");
}

std::unique_ptr<PreparedContact> IntervalContact::prepare(const Matrix& A, const Matrix& B) const {
    check_contact_matrices("IntervalContact", A, B);
    return std::make_unique<PreparedIntervals>(A, B, inner_);
}

}  // namespace tact
