#include "primal_basis.hpp"

#include <algorithm>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

#include "../../lib/errors.hpp"
#include "../model/orthonormal.hpp"

namespace tact {
namespace {

void check(const PrimalOptions& options, Index n) {
    if (!options.body_of.empty() && static_cast<Index>(options.body_of.size()) != n)
        throw InputError("PrimalOptions: body_of has " + std::to_string(options.body_of.size()) +
                         " entries, expected one for each of the " + std::to_string(n) + " unknowns");
    for (const Index body : options.body_of)
        if (body < 0 || body >= n)
            throw InputError("PrimalOptions: body_of holds " + std::to_string(body) + ", expected 0 to " +
                             std::to_string(n - 1));
    if (options.held.cols() > 0 && options.held.rows() != n)
        throw InputError("PrimalOptions: held has " + std::to_string(options.held.rows()) + " rows, expected " +
                         std::to_string(n));
    if (!options.held.allFinite())
        throw InputError("PrimalOptions: held has a NaN or infinite entry, expected finite entries");
}

Index bodies(const PrimalOptions& options) {
    return options.body_of.empty() ? 1 : *std::ranges::max_element(options.body_of) + 1;
}

/// X in the rows of this body, zero in the others.
DenseMatrix in_body(DenseMatrix X, Index body, const std::vector<Index>& body_of) {
    for (std::size_t i = 0; i < body_of.size(); ++i)
        if (body_of[i] != body) X.row(static_cast<Index>(i)).setZero();
    return X;
}

DenseMatrix side_by_side(const std::vector<DenseMatrix>& parts) {
    Index columns = 0;
    for (const DenseMatrix& part : parts) columns += part.cols();
    DenseMatrix all(parts.front().rows(), columns);
    columns = 0;
    for (const DenseMatrix& part : parts) {
        all.middleCols(columns, part.cols()) = part;
        columns += part.cols();
    }
    return all;
}

}  // namespace

DenseMatrix primal_basis(const PodAccumulator& snapshots, Index p, double tolerance, const PrimalOptions& options) {
    if (options.body_of.empty() && options.held.cols() == 0) {
        DenseMatrix U = snapshots.modes(p).modes;
        U.conservativeResize(Eigen::NoChange, std::min(U.cols(), snapshots.above(tolerance)));
        return U;
    }
    if (p < 0 || p > snapshots.snapshots())
        throw InputError("primal_basis: p is " + std::to_string(p) + ", expected at most the number of snapshots, " +
                         std::to_string(snapshots.snapshots()));
    DenseMatrix rest = snapshots.scaled_modes();
    check(options, rest.rows());
    const std::optional<Matrix>& W = snapshots.inner_product();
    DenseMatrix held(rest.rows(), 0);
    if (options.held.cols() > 0) {
        std::vector<DenseMatrix> parts;
        for (Index body = 0; body < bodies(options); ++body)
            parts.push_back(in_body(options.held, body, options.body_of));
        held = orthonormal_columns(side_by_side(parts));
        if (W) held = orthonormal_in(*W, std::move(held));
        rest -= held * ((W ? W->times(held) : held).transpose() * rest);
    }
    const double largest = snapshots.vectors() > 0 ? snapshots.singular_values()[0] : 0;
    const double smallest = std::max(tolerance, pod_snapshots_resolution) * largest;
    std::vector<DenseMatrix> found{std::move(held)};
    std::vector<std::pair<double, Index>> order;  // of the columns after those held
    for (Index body = 0; body < bodies(options); ++body) {
        Pod pod_ = pod(in_body(rest, body, options.body_of), {.rank = std::min(p, rest.cols()), .inner_product = W});
        for (const double sigma : pod_.singular_values) order.emplace_back(-sigma, static_cast<Index>(order.size()));
        found.push_back(in_body(std::move(pod_.modes), body, options.body_of));  // rounding must not tie bodies
    }
    std::ranges::sort(order);
    std::vector<Index> columns(static_cast<std::size_t>(found.front().cols()));
    std::iota(columns.begin(), columns.end(), Index{0});
    const Index first = found.front().cols();
    for (std::size_t k = 0; k < std::min(order.size(), static_cast<std::size_t>(p)); ++k)
        if (-order[k].first > smallest) columns.push_back(first + order[k].second);
    return side_by_side(found)(Eigen::all, columns);
}

std::vector<Index> connected_bodies(const Matrix& K) {
    // Each unknown points to an earlier one of its body, the first to itself.
    std::vector<Index> earlier(static_cast<std::size_t>(K.rows()));
    std::iota(earlier.begin(), earlier.end(), Index{0});
    const auto first_of = [&](Index i) {
        while (earlier[static_cast<std::size_t>(i)] != i) {
            Index& up = earlier[static_cast<std::size_t>(i)];
            i = up = earlier[static_cast<std::size_t>(up)];
        }
        return i;
    };
    const SparseMatrix entries = K.to_sparse();
    for (Index j = 0; j < entries.cols(); ++j)
        for (SparseMatrix::InnerIterator it(entries, j); it; ++it) {
            const auto [low, high] = std::minmax({first_of(it.row()), first_of(j)});
            earlier[static_cast<std::size_t>(high)] = low;
        }
    std::vector<Index> body_of(earlier.size());
    Index count = 0;
    for (std::size_t i = 0; i < earlier.size(); ++i) {
        const Index first = first_of(static_cast<Index>(i));
        body_of[i] = first == static_cast<Index>(i) ? count++ : body_of[static_cast<std::size_t>(first)];
    }
    return body_of;
}

DenseMatrix static_modes(const ContactProblem& problem, const std::vector<Index>& rows, const LinearSolver& linear) {
    DenseMatrix forces(problem.constraints(), static_cast<Index>(rows.size()));
    forces.setZero();
    for (std::size_t j = 0; j < rows.size(); ++j) {
        if (rows[j] < 0 || rows[j] >= problem.constraints())
            throw InputError("static_modes: row " + std::to_string(rows[j]) + " does not exist, expected 0 to " +
                             std::to_string(problem.constraints() - 1));
        forces(rows[j], static_cast<Index>(j)) = 1;
    }
    std::vector<Index> loads;
    const DenseMatrix f = problem.f.dense_modes("static_modes: f");
    for (Index j = 0; j < f.cols(); ++j)
        if (!f.col(j).isZero(0)) loads.push_back(j);
    DenseMatrix modes(problem.size(), static_cast<Index>(loads.size() + rows.size()));
    modes << f(Eigen::all, loads), problem.B.transposed_times(forces);
    if (modes.cols() == 0) return modes;
    linear.factorize(problem.K)->solve(modes);
    for (Index j = 0; j < modes.cols(); ++j) modes.col(j).stableNormalize();
    return modes;
}

}  // namespace tact
