#include "mass_redistribution.hpp"

#include <Eigen/SparseLU>
#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "../errors.hpp"

namespace tact {
namespace {

[[noreturn]] void reject(const std::string& what) { throw InputError("redistribute_mass: " + what); }

constexpr Index unreached = -1;

/// Steps through K to the nearest unknown that B does not touch: 0 for those themselves.
std::vector<Index> steps_to_free(const SparseMatrix& K, const SparseMatrix& B, std::vector<Index>& order) {
    const Index n = K.cols();
    std::vector<Index> steps(static_cast<std::size_t>(n), unreached);
    order.clear();
    for (Index j = 0; j < n; ++j) {
        bool touched = false;
        for (SparseMatrix::InnerIterator it(B, j); it; ++it) touched |= it.value() != 0;
        if (touched) continue;
        steps[static_cast<std::size_t>(j)] = 0;
        order.push_back(j);
    }
    if (order.empty() && n > 0) reject("every unknown is in contact, expected some that B does not touch");
    for (std::size_t next = 0; next < order.size(); ++next)
        for (SparseMatrix::InnerIterator it(K, order[next]); it; ++it) {
            Index& level = steps[static_cast<std::size_t>(it.row())];
            if (level != unreached || it.value() == 0) continue;
            level = steps[static_cast<std::size_t>(order[next])] + 1;
            order.push_back(it.row());
        }
    return steps;
}

/// Contact unknowns that are in equilibrium with the others, as far as their rows let them: what would penetrate lies on
/// its bound, or stays where it was if its row has several entries.
class Equilibrium {
public:
    /// `steps` > 0: unknowns without mass.
    Equilibrium(const SparseMatrix& K, const SparseMatrix& B, const std::vector<Index>& steps) : K_(K), B_(B) {
        loose_.assign(steps.size(), 0);
        std::transform(steps.begin(), steps.end(), loose_.begin(), [](Index level) { return level > 0; });
    }

    /// K_LL x_L = f_L - K_LF x_F for the loose unknowns L; x stays where that is singular.
    void settle(const Vector& f, Vector& x) const {
        std::vector<Index> loose;
        std::vector<long> place(loose_.size(), -1);
        for (Index i = 0; i < x.size(); ++i)
            if (loose_[static_cast<std::size_t>(i)]) {
                place[static_cast<std::size_t>(i)] = static_cast<long>(loose.size());
                loose.push_back(i);
            }
        if (loose.empty()) return;
        Vector others = x;
        for (const Index i : loose) others[i] = 0;
        const Vector force = f - K_ * others;
        std::vector<Eigen::Triplet<double, long>> entries;
        for (const Index j : loose)
            for (SparseMatrix::InnerIterator it(K_, j); it; ++it)
                if (const long i = place[static_cast<std::size_t>(it.row())]; i >= 0)
                    entries.emplace_back(i, place[static_cast<std::size_t>(j)], it.value());
        Eigen::SparseMatrix<double> own(static_cast<Index>(loose.size()), static_cast<Index>(loose.size()));
        own.setFromTriplets(entries.begin(), entries.end());
        const Eigen::SparseLU<Eigen::SparseMatrix<double>> factor(own);
        if (factor.info() != Eigen::Success) return;
        const Vector settled = factor.solve(Vector(force(loose)));
        if (settled.allFinite()) x(loose) = settled;
    }

    /// The unknowns of the rows that x violates are no longer loose; `before` did not violate them. Whether there are any.
    bool hold(const Vector& c, const Vector& before, Vector& x) {
        const Vector gap = B_ * x - c, size = B_.cwiseAbs() * x.cwiseAbs() + c.cwiseAbs();
        const Eigen::SparseMatrix<double, Eigen::RowMajor, long> rows = B_;
        bool any = false;
        for (Index i = 0; i < rows.rows(); ++i) {
            if (c[i] == -infinity || gap[i] >= -1e-14 * size[i]) continue;
            const bool bound = rows.row(i).nonZeros() == 1;
            for (decltype(rows)::InnerIterator it(rows, i); it; ++it) {
                char& loose = loose_[static_cast<std::size_t>(it.col())];
                any |= loose != 0;
                loose = 0;
                x[it.col()] = bound ? c[i] / it.value() : before[it.col()];
            }
        }
        return any;
    }

private:
    const SparseMatrix &K_, &B_;
    std::vector<char> loose_;
};

void start_in_equilibrium(ContactProblem& problem, const SparseMatrix& K, const SparseMatrix& B,
                          const std::vector<Index>& steps) {
    Equilibrium equilibrium(K, B, steps);
    const Vector before = problem.u0, load = problem.f.at(0), gap = problem.c.at(0);
    do equilibrium.settle(load, problem.u0);
    while (equilibrium.hold(gap, before, problem.u0));
    equilibrium.settle(Vector::Zero(problem.v0.size()), problem.v0);
}

}  // namespace

ContactProblem redistribute_mass(const ContactProblem& problem, double keep) {
    if (!problem.M) reject("the problem has no M, expected one that is diagonal");
    if (!problem.M->diagonal_entries()) reject("M is " + problem.M->shape() + ", expected a diagonal one: lump it");
    if (!(keep >= 0 && keep <= 1)) reject("keep is " + shown(keep) + ", expected from 0 to 1");

    validate(problem);
    require_contact_rows("redistribute_mass", problem);
    // Its symmetric part, so that every step towards a free unknown is one that the mass can take.
    SparseMatrix K = problem.K.to_sparse();
    K = SparseMatrix(0.5 * (K + SparseMatrix(K.transpose())));
    const SparseMatrix B = problem.B.to_sparse();
    std::vector<Index> order;  // those nearest to the free ones first
    const std::vector<Index> steps = steps_to_free(K, B, order);
    const auto alone = std::find(steps.begin(), steps.end(), unreached);
    if (alone != steps.end())
        reject("unknown " + std::to_string(alone - steps.begin()) +
               " is in contact and K leads from it to no unknown that is not, expected that it does");

    // From the farthest unknown on, so that all that passes through one has arrived before it is shared out.
    Vector mass = *problem.M->diagonal_entries(), moving = Vector::Zero(mass.size());
    for (const Index i : order) {
        if (steps[static_cast<std::size_t>(i)] == 0) continue;
        moving[i] = (1 - keep) * mass[i];
        mass[i] *= keep;
    }
    for (auto at = order.rbegin(); at != order.rend() && steps[static_cast<std::size_t>(*at)] > 0; ++at) {
        const Index nearer = steps[static_cast<std::size_t>(*at)] - 1;
        std::vector<std::pair<Index, double>> neighbours;
        bool attracted = false;
        for (SparseMatrix::InnerIterator it(K, *at); it; ++it) {
            if (steps[static_cast<std::size_t>(it.row())] != nearer || it.value() == 0) continue;
            neighbours.emplace_back(it.row(), -it.value());
            attracted |= it.value() < 0;
        }
        double total = 0;
        for (auto& [j, weight] : neighbours) total += weight = attracted ? std::max(weight, 0.0) : std::abs(weight);
        for (const auto& [j, weight] : neighbours) (nearer == 0 ? mass : moving)[j] += moving[*at] * (weight / total);
    }
    ContactProblem result = problem;
    result.M = Matrix::diagonal(std::move(mass));
    constexpr double hardly_any = 1e-6;
    if (keep < hardly_any) start_in_equilibrium(result, problem.K.to_sparse(), B, steps);
    return result;
}

}  // namespace tact
