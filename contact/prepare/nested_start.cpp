#include "nested_start.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "../../lib/errors.hpp"
#include "../../lib/sparse/klu_solver.hpp"

namespace tact {
namespace {

std::size_t at(Index i) { return static_cast<std::size_t>(i); }

using Triplet = Eigen::Triplet<double, long>;

/// Couplings of a row below this share of its strongest one carry no interpolation (Ruge and Stueben's value).
constexpr double strong = 0.25;
/// Unknowns from which a set is found from nothing.
constexpr Index coarsest = 60;
/// Entries of a row beyond which coarser graphs cost more than they save.
constexpr Index crowded = 60;
constexpr int deepest = 40;
/// Both ways: the set's edge moves by as many layers and more, for a part of a factor's price.
constexpr int sweeps = 4;
/// On the way to the finest graph: what is then unsettled is left to the next.
constexpr int sets_on_a_level = 8;

/// The unknowns that are kept, by their new number, and -1 for the others. `rows`: column i is row i of A.
std::vector<Index> kept_unknowns(const SparseMatrix& rows, const SparseMatrix& columns, Index& count) {
    const Index n = rows.cols();
    std::vector<double> least(at(n));
    for (Index i = 0; i < n; ++i) {
        double largest = 0;
        for (SparseMatrix::InnerIterator it(rows, i); it; ++it)
            if (it.index() != i) largest = std::max(largest, -it.value());
        least[at(i)] = largest > 0 ? strong * largest : infinity;
    }
    constexpr Index undecided = -2, left = -1;
    std::vector<Index> number(at(n), undecided);
    count = 0;
    for (Index i = 0; i < n; ++i) {
        if (number[at(i)] != undecided) continue;
        if (least[at(i)] == infinity) {  // couples to nothing: its own equation gives it
            number[at(i)] = left;
            continue;
        }
        number[at(i)] = count++;
        for (SparseMatrix::InnerIterator it(rows, i); it; ++it)
            if (-it.value() >= least[at(i)] && number[at(it.index())] == undecided) number[at(it.index())] = left;
        for (SparseMatrix::InnerIterator it(columns, i); it; ++it)
            if (-it.value() >= least[at(it.index())] && number[at(it.index())] == undecided)
                number[at(it.index())] = left;
    }
    return number;
}

/// Column i: the weights with which unknown i follows the kept ones, from its row of A (`rows`: column i is row i), or
/// 1 for itself. All negative couplings count with the weight of those to kept unknowns, positive ones with the diagonal.
SparseMatrix interpolation(const SparseMatrix& rows, const std::vector<Index>& number, Index count) {
    std::vector<Triplet> entries;
    entries.reserve(at(rows.nonZeros()));
    for (Index i = 0; i < rows.cols(); ++i) {
        if (number[at(i)] >= 0) {
            entries.emplace_back(number[at(i)], i, 1.0);
            continue;
        }
        double diagonal = 0, all = 0, to_kept = 0;
        for (SparseMatrix::InnerIterator it(rows, i); it; ++it) {
            if (it.index() == i || it.value() > 0) {
                diagonal += it.value();
                continue;
            }
            all += it.value();
            if (number[at(it.index())] >= 0) to_kept += it.value();
        }
        if (!(to_kept < 0) || !(diagonal > 0)) continue;
        for (SparseMatrix::InnerIterator it(rows, i); it; ++it)
            if (it.index() != i && it.value() < 0 && number[at(it.index())] >= 0)
                entries.emplace_back(number[at(it.index())], i, -it.value() * (all / to_kept) / diagonal);
    }
    SparseMatrix weights(count, rows.cols());
    weights.setFromTriplets(entries.begin(), entries.end());
    return weights;
}

/// A's pattern with all of its diagonal.
SparseMatrix with_diagonal(const SparseMatrix& A) {
    SparseMatrix none(A.rows(), A.cols());
    none.setIdentity();
    return SparseMatrix(A + 0.0 * none);
}

/// The primal-dual active set of one graph.
class BoxProblem {
public:
    explicit BoxProblem(const SparseMatrix& A) : A_(with_diagonal(A)), rows_(A_.transpose()) {}
    const SparseMatrix& rows() const { return rows_; }

    /// From the set given; false where its equations are singular.
    bool solve(const Vector& b, const Vector& lower, const Vector& upper, int sets, Vector& u,
               std::vector<signed char>& side) {
        for (int k = 0; k < sets; ++k) {
            if (!factor(side)) return false;
            u = b;
            for (Index i = 0; i < u.size(); ++i)
                if (side[at(i)] != 0) u[i] = side[at(i)] < 0 ? lower[i] : upper[i];
            klu_->solve(u);
            if (!u.allFinite()) return false;
            bool changed = false;
            for (Index i = 0; i < u.size(); ++i) {
                signed char now = u[i] < lower[i] ? -1 : u[i] > upper[i] ? 1 : 0;
                if (side[at(i)] != 0) now = side[at(i)] * force(i, b, u) < 0 ? side[at(i)] : 0;
                changed |= now != side[at(i)];
                side[at(i)] = now;
            }
            if (!changed) break;
        }
        return true;
    }

    /// Projected Gauss-Seidel, forth and back, then the set that u rests on.
    void relax(const Vector& b, const Vector& lower, const Vector& upper, Vector& u,
               std::vector<signed char>& side) const {
        u = u.cwiseMax(lower).cwiseMin(upper);
        const auto update = [&](Index i) {
            double diagonal = 0;
            const double residual = -force(i, b, u, &diagonal);
            if (diagonal > 0) u[i] = std::min(std::max(u[i] + residual / diagonal, lower[i]), upper[i]);
        };
        for (int k = 0; k < sweeps; ++k) {
            for (Index i = 0; i < u.size(); ++i) update(i);
            for (Index i = u.size(); i-- > 0;) update(i);
        }
        side.assign(at(u.size()), 0);
        for (Index i = 0; i < u.size(); ++i) {
            const double pushed = force(i, b, u);
            side[at(i)] = u[i] == lower[i] && pushed > 0 ? -1 : u[i] == upper[i] && pushed < 0 ? 1 : 0;
        }
    }

private:
    /// (A u - b)_i
    double force(Index i, const Vector& b, const Vector& u, double* diagonal = nullptr) const {
        double sum = -b[i];
        for (SparseMatrix::InnerIterator it(rows_, i); it; ++it) {
            sum += it.value() * u[it.index()];
            if (diagonal && it.index() == i) *diagonal = it.value();
        }
        return sum;
    }

    bool factor(const std::vector<signed char>& side) {
        if (!klu_) klu_.emplace(A_);
        SparseMatrix& S = klu_->matrix();
        for (Index j = 0; j < S.cols(); ++j)
            for (auto k = S.outerIndexPtr()[j]; k < S.outerIndexPtr()[j + 1]; ++k) {
                const long i = S.innerIndexPtr()[k];
                S.valuePtr()[k] = side[at(i)] == 0 ? A_.valuePtr()[k] : i == j ? 1 : 0;
            }
        return klu_->refactor();
    }

    SparseMatrix A_, rows_;
    std::optional<KluRefactorable> klu_;  // once it is needed: on the finest graph it never is
};

}  // namespace

/// A graph that is not the coarsest keeps the way to the coarser one; all but the finest solve.
struct NestedStart::Level {
    explicit Level(const SparseMatrix& A) : problem(A) {}
    BoxProblem problem;
    std::vector<Index> number;
    SparseMatrix from_rows, from_columns;  // P' and R: of the interpolation from A's rows and from its columns
    Vector eliminated;                     // 1 / A_ii of the unknowns that are not kept, else 0
    Vector b, lower, upper, u;
    std::vector<signed char> side;
};

NestedStart::NestedStart(const SparseMatrix& A) : A_(A) {}
NestedStart::~NestedStart() = default;

bool NestedStart::coarsen(const SparseMatrix& A) {
    SparseMatrix current = A;
    while (static_cast<int>(levels_.size()) < deepest) {
        levels_.push_back(std::make_unique<Level>(current));
        if (current.rows() <= coarsest) break;
        Level& level = *levels_.back();
        const SparseMatrix& rows = level.problem.rows();
        Index count = 0;
        level.number = kept_unknowns(rows, current, count);
        if (count == 0 || 10 * count > 9 * current.rows()) break;
        level.from_rows = interpolation(rows, level.number, count);
        level.from_columns = interpolation(current, level.number, count);
        level.eliminated = current.diagonal();
        for (Index i = 0; i < current.rows(); ++i) {
            double& d = level.eliminated[i];
            d = level.number[at(i)] < 0 && d > 0 ? 1 / d : 0;
        }
        SparseMatrix coarser = level.from_columns * SparseMatrix(current * SparseMatrix(level.from_rows.transpose()));
        coarser.prune([](long, long, double value) { return value != 0; });
        if (coarser.nonZeros() > crowded * coarser.rows() || !(coarser.diagonal().array() > 0).all()) break;
        current = std::move(coarser);
    }
    return levels_.size() > 1;
}

bool NestedStart::find(const ConstVectorRef& b, const ConstVectorRef& lower, const ConstVectorRef& upper, Vector& u,
                       std::vector<signed char>& side) {
    try {
        if (!std::exchange(made_, true) && A_.rows() > coarsest && (A_.diagonal().array() > 0).all())
            (void)coarsen(A_);
    } catch (const NumericalError&) {
        levels_.clear();
    }
    if (levels_.size() < 2) return false;
    levels_[0]->b = b;
    levels_[0]->lower = lower;
    levels_[0]->upper = upper;
    for (std::size_t l = 0; l + 1 < levels_.size(); ++l) {
        const Level& fine = *levels_[l];
        Level& coarse = *levels_[l + 1];
        coarse.b.noalias() = fine.from_columns * fine.b;
        coarse.lower.resize(coarse.b.size());
        coarse.upper.resize(coarse.b.size());
        for (std::size_t i = 0; i < fine.number.size(); ++i)
            if (const Index k = fine.number[i]; k >= 0) {
                coarse.lower[k] = fine.lower[static_cast<Index>(i)];
                coarse.upper[k] = fine.upper[static_cast<Index>(i)];
            }
    }
    Level& last = *levels_.back();
    last.side.assign(at(last.b.size()), 0);
    const int many = 20 + 2 * static_cast<int>(std::min(last.b.size(), coarsest));
    if (!last.problem.solve(last.b, last.lower, last.upper, many, last.u, last.side)) return false;
    for (std::size_t l = levels_.size() - 1; l-- > 0;) {
        Level& fine = *levels_[l];
        Level& coarse = *levels_[l + 1];
        coarse.u = coarse.u.cwiseMax(coarse.lower).cwiseMin(coarse.upper);
        fine.u = fine.eliminated.cwiseProduct(fine.b);
        fine.u.noalias() += fine.from_rows.transpose() * coarse.u;
        fine.problem.relax(fine.b, fine.lower, fine.upper, fine.u, fine.side);
        if (l > 0 && !fine.problem.solve(fine.b, fine.lower, fine.upper, sets_on_a_level, fine.u, fine.side))
            return false;
    }
    u = levels_[0]->u;
    side = levels_[0]->side;
    return true;
}

}  // namespace tact
