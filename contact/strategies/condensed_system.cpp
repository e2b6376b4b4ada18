#include "condensed_system.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace tact {
namespace {

std::size_t at_index(Index i) { return static_cast<std::size_t>(i); }

using Triplet = Eigen::Triplet<double, long>;

}  // namespace

CondensedSystem::CondensedSystem(const SparseMatrix& A, const ConstraintRows& rows)
    : rows_(rows), n_(A.rows()), by_row_(SparseMatrix(A.transpose())), own_(find_own_unknowns()) {
    klu_.emplace(pattern());
    home_.resize(at_index(by_row_.nonZeros()));
    const double* first = klu_->matrix().valuePtr();
    for (Index r = 0; r < n_; ++r)
        for (auto k = by_row_.outerIndexPtr()[r]; k < by_row_.outerIndexPtr()[r + 1]; ++k)
            home_[at_index(k)] = &at(r, by_row_.innerIndexPtr()[k]) - first;
}

bool CondensedSystem::factor(const Set& active) {
    if (factored_ == active) return true;
    factored_.reset();
    SparseMatrix& S = klu_->matrix();
    Eigen::Map<Vector>(S.valuePtr(), S.nonZeros()).setZero();
    for (Index r = 0; r < n_; ++r) {
        const long i = owner_[at_index(r)];
        if (i >= 0 && active[at_index(i)]) {
            const auto columns = rows_.columns(i);
            for (std::size_t k = 0; k < columns.size(); ++k) at(r, columns[k]) += rows_.weights(i)[k];
            continue;
        }
        for (auto k = by_row_.outerIndexPtr()[r]; k < by_row_.outerIndexPtr()[r + 1]; ++k)
            S.valuePtr()[home_[at_index(k)]] += by_row_.valuePtr()[k];
    }
    for (Index i = 0; i < rows_.rows(); ++i) {
        const bool on = active[at_index(i)];
        const auto columns = rows_.columns(i);
        const auto weights = rows_.weights(i);
        const Index own = own_[at_index(i)];
        if (own >= 0) {
            if (!on) continue;
            for (std::size_t k = 0; k < columns.size(); ++k)
                if (columns[k] != own) add_row(columns[k], own, -weights[k] / weight_of(i, own));
        } else {
            const Index extra = extra_[at_index(i)];
            for (std::size_t k = 0; k < columns.size(); ++k) {
                at(columns[k], extra) = -weights[k];
                if (on) at(extra, columns[k]) = weights[k];
            }
            if (!on) at(extra, extra) = 1;
        }
    }
    if (!klu_->refactor()) return false;
    factored_ = active;
    return true;
}

void CondensedSystem::solve(const ConstVectorRef& b, const ConstVectorRef& c, const Set& active, Vector& u,
                            Vector& lambda, Vector& size) {
    x_.setZero(n_ + extras_);
    x_.head(n_) = b;
    for (Index i = 0; i < rows_.rows(); ++i) {
        if (!active[at_index(i)]) continue;
        const Index own = own_[at_index(i)];
        if (own < 0) {
            x_[extra_[at_index(i)]] = c[i];
            continue;
        }
        const auto columns = rows_.columns(i);
        for (std::size_t k = 0; k < columns.size(); ++k)
            if (columns[k] != own) x_[columns[k]] -= rows_.weights(i)[k] / weight_of(i, own) * b[own];
        x_[own] = c[i];
    }
    klu_->solve(x_);
    u = x_.head(n_);
    lambda.setZero(rows_.rows());
    size.setZero(rows_.rows());
    for (Index i = 0; i < rows_.rows(); ++i) {
        if (!active[at_index(i)]) continue;
        const Index own = own_[at_index(i)];
        if (own >= 0) {
            const double weight = weight_of(i, own);
            lambda[i] = force(own, b, u, size[i]) / weight;
            size[i] /= std::abs(weight);
            continue;
        }
        // Each equilibrium that the row touches knows the multiplier: the smallest of their sizes counts.
        lambda[i] = x_[extra_[at_index(i)]];
        size[i] = infinity;
        for (std::size_t k = 0; k < rows_.columns(i).size(); ++k) {
            double terms = 0;
            (void)force(rows_.columns(i)[k], b, u, terms);
            size[i] = std::min(size[i], terms / std::abs(rows_.weights(i)[k]));
        }
        if (size[i] == infinity) size[i] = 0;
    }
}

/// (A u - b)_row, and the sum of the absolute values of its terms.
double CondensedSystem::force(Index row, const ConstVectorRef& b, const Vector& u, double& size) const {
    double sum = -b[row];
    size = std::abs(b[row]);
    for (SparseMatrix::InnerIterator it(by_row_, row); it; ++it) {
        const double term = it.value() * u[it.index()];
        sum += term;
        size += std::abs(term);
    }
    return sum;
}

double CondensedSystem::weight_of(Index row, Index column) const {
    const auto columns = rows_.columns(row);
    for (std::size_t k = 0; k < columns.size(); ++k)
        if (columns[k] == column) return rows_.weights(row)[k];
    return 0;
}

/// An unknown is a row's own if no other row touches it: then its equilibrium gives the row's multiplier alone.
std::vector<Index> CondensedSystem::find_own_unknowns() {
    std::vector<int> uses(at_index(n_), 0);
    for (Index i = 0; i < rows_.rows(); ++i)
        for (const int j : rows_.columns(i)) ++uses[at_index(j)];
    std::vector<Index> own(at_index(rows_.rows()), -1);
    owner_.assign(at_index(n_), -1);
    extra_.assign(own.size(), -1);
    Index extras = 0;
    for (Index i = 0; i < rows_.rows(); ++i) {
        double largest = 0;
        const auto columns = rows_.columns(i);
        for (std::size_t k = 0; k < columns.size(); ++k) {
            const double weight = std::abs(rows_.weights(i)[k]);
            if (uses[at_index(columns[k])] == 1 && weight > largest) {
                largest = weight;
                own[at_index(i)] = columns[k];
            }
        }
        if (largest > 0)
            owner_[at_index(own[at_index(i)])] = i;
        else
            extra_[at_index(i)] = n_ + extras++;
    }
    extras_ = extras;
    return own;
}

SparseMatrix CondensedSystem::pattern() {
    std::vector<Triplet> entries;
    entries.reserve(at_index(by_row_.nonZeros() + 2 * rows_.rows()));
    const auto copy_row = [&](Index target, Index source) {
        for (SparseMatrix::InnerIterator it(by_row_, source); it; ++it) entries.emplace_back(target, it.index(), 1.0);
    };
    for (Index r = 0; r < n_; ++r) copy_row(r, r);
    for (Index i = 0; i < rows_.rows(); ++i) {
        const auto columns = rows_.columns(i);
        const Index own = own_[at_index(i)];
        const Index extra = extra_[at_index(i)];
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

double& CondensedSystem::at(Index row, Index column) {
    SparseMatrix& S = klu_->matrix();
    const long* first = S.innerIndexPtr() + S.outerIndexPtr()[column];
    const long* last = S.innerIndexPtr() + S.outerIndexPtr()[column + 1];
    return S.valuePtr()[std::lower_bound(first, last, row) - S.innerIndexPtr()];
}

void CondensedSystem::add_row(Index target, Index source, double factor) {
    for (SparseMatrix::InnerIterator it(by_row_, source); it; ++it) at(target, it.index()) += factor * it.value();
}

}  // namespace tact
