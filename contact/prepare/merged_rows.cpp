#include "merged_rows.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

namespace tact {
namespace {

std::size_t at(Index i) { return static_cast<std::size_t>(i); }

/// For each row the one kept in its place, by its number among the kept ones, and B_i = factor_i B_kept.
struct Merging {
    std::vector<Index> kept;
    Vector factor;
    Matrix B;  // the kept rows
};

/// Whether two rows begin in the same column, as rows that repeat do.
bool may_repeat(const SparseMatrix& B) {
    std::vector<char> begun(at(B.rows()), 0);
    for (Index j = 0; j < B.cols(); ++j) {
        int fresh = 0;
        for (SparseMatrix::InnerIterator it(B, j); it; ++it)
            fresh += it.value() != 0 && !std::exchange(begun[at(it.row())], 1);
        if (fresh > 1) return true;
    }
    return false;
}

/// The rows of B, by columns, each over the size of its first entry.
class UnitRows {
public:
    explicit UnitRows(const SparseMatrix& B) : rows_(B.transpose()), size_(Vector::Zero(B.rows())) {
        rows_.prune([](long, long, double value) { return value != 0; });
        for (Index i = 0; i < rows_.outerSize(); ++i) {
            if (length(i) == 0) continue;
            size_[i] = std::abs(value(i, 0));
            for (Index k = 0; k < length(i); ++k) value(i, k) /= size_[i];
        }
    }
    double size(Index i) const { return size_[i]; }

    bool before(Index i, Index j) const {
        if (length(i) != length(j)) return length(i) < length(j);
        for (Index k = 0; k < length(i); ++k)
            if (column(i, k) != column(j, k)) return column(i, k) < column(j, k);
        for (Index k = 0; k < length(i); ++k)
            if (value(i, k) != value(j, k)) return value(i, k) < value(j, k);
        return i < j;
    }
    bool same(Index i, Index j) const {
        if (length(i) != length(j) || length(i) == 0) return false;
        // Bounds and multipliers are multiplied by the factor between the rows: it must neither overflow nor vanish.
        const double factor = size_[i] / size_[j];
        if (!(factor < farthest && factor > 1 / farthest)) return false;
        for (Index k = 0; k < length(i); ++k)
            if (column(i, k) != column(j, k) || !std::isfinite(value(i, k)) ||
                !(std::abs(value(i, k) - value(j, k)) <= rounding * std::abs(value(i, k))))
                return false;
        return true;
    }

private:
    static constexpr double farthest = 1e100;
    static constexpr double rounding = 4 * std::numeric_limits<double>::epsilon();
    Index length(Index i) const { return rows_.outerIndexPtr()[i + 1] - rows_.outerIndexPtr()[i]; }
    long column(Index i, Index k) const { return rows_.innerIndexPtr()[rows_.outerIndexPtr()[i] + k]; }
    double value(Index i, Index k) const { return rows_.valuePtr()[rows_.outerIndexPtr()[i] + k]; }
    double& value(Index i, Index k) { return rows_.valuePtr()[rows_.outerIndexPtr()[i] + k]; }
    SparseMatrix rows_;
    Vector size_;
};

Merging merge(const SparseMatrix& B) {
    const UnitRows rows(B);
    std::vector<Index> sorted(at(B.rows())), first(at(B.rows()));
    for (Index i = 0; i < B.rows(); ++i) sorted[at(i)] = first[at(i)] = i;
    std::sort(sorted.begin(), sorted.end(), [&](Index i, Index j) { return rows.before(i, j); });
    for (std::size_t k = 1; k < sorted.size(); ++k)
        if (const Index leader = first[at(sorted[k - 1])]; rows.same(leader, sorted[k]))
            first[at(sorted[k])] = leader;

    Merging merging{std::vector<Index>(at(B.rows()), -1), Vector::Ones(B.rows()), {}};
    Index count = 0;
    for (Index i = 0; i < B.rows(); ++i)
        if (first[at(i)] == i) merging.kept[at(i)] = count++;
    for (Index i = 0; i < B.rows(); ++i) {
        const Index leader = first[at(i)];
        if (leader == i) continue;
        merging.kept[at(i)] = merging.kept[at(leader)];
        merging.factor[i] = rows.size(i) / rows.size(leader);
    }
    std::vector<Eigen::Triplet<double, long>> entries;
    for (Index j = 0; j < B.cols(); ++j)
        for (SparseMatrix::InnerIterator it(B, j); it; ++it)
            if (first[at(it.row())] == it.row()) entries.emplace_back(merging.kept[at(it.row())], j, it.value());
    SparseMatrix kept(count, B.cols());
    kept.setFromTriplets(entries.begin(), entries.end());
    merging.B = Matrix(std::move(kept));
    return merging;
}

class PreparedMerged final : public PreparedContact {
public:
    PreparedMerged(std::unique_ptr<PreparedContact> inner, Merging merging)
        : inner_(std::move(inner)),
          kept_(std::move(merging.kept)),
          factor_(std::move(merging.factor)),
          c_(merging.B.rows()),
          lambda_(merging.B.rows()),
          tightest_(at(merging.B.rows())) {}

    bool reads_guess() const override { return inner_->reads_guess(); }
    bool update(const Matrix& A) override { return inner_->update(A); }

    ContactReport solve(const ConstVectorRef& b, const ConstVectorRef& c, ContactPoint point) override {
        std::fill(tightest_.begin(), tightest_.end(), -1);
        lambda_.setZero();
        for (Index i = 0; i < c.size(); ++i) {
            const Index k = kept_[at(i)];
            const double bound = c[i] / factor_[i];
            // A NaN stays, for the solver to find.
            if (tightest_[at(k)] < 0 || std::isnan(bound) || bound > c_[k]) {
                c_[k] = bound;
                tightest_[at(k)] = i;
            }
            lambda_[k] += factor_[i] * point.lambda[i];
        }
        ContactReport report = inner_->solve(b, c_, {point.u, lambda_});
        if (report.outcome == Outcome::converged) spread(lambda_, point.lambda);
        if (report.infeasibility.size() > 0) {
            const Vector merged = std::exchange(report.infeasibility, Vector(c.size()));
            spread(merged, report.infeasibility);
        }
        return report;
    }

private:
    void spread(const Vector& merged, VectorRef all) const {
        all.setZero();
        for (Index k = 0; k < merged.size(); ++k) all[tightest_[at(k)]] = merged[k] / factor_[tightest_[at(k)]];
    }

    std::unique_ptr<PreparedContact> inner_;
    std::vector<Index> kept_;
    Vector factor_, c_, lambda_;
    std::vector<Index> tightest_;  // of the rows that are one
};

}  // namespace

std::unique_ptr<PreparedContact> prepare_merged(
    const Matrix& A, const Matrix& B,
    const std::function<std::unique_ptr<PreparedContact>(const Matrix& A, const Matrix& B)>& prepare) {
    if (!B.sparse() || !may_repeat(*B.sparse())) return prepare(A, B);
    Merging merging = merge(*B.sparse());
    if (merging.B.rows() == B.rows()) return prepare(A, B);
    auto inner = prepare(A, merging.B);
    return std::make_unique<PreparedMerged>(std::move(inner), std::move(merging));
}

}  // namespace tact
