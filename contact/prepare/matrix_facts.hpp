// What one pass over a matrix tells the chooser.
#pragma once

#include <string_view>

#include "../../lib/problem/matrix.hpp"

namespace tact {

/// Of a symmetric matrix A with diagonal D, scaled to unit diagonal where conditions are meant.
struct MatrixFacts {
    bool positive_diagonal = false;
    /// Entries off the diagonal are <= 0 but for a share of 1e-3 of their sum.
    bool m_matrix = false;
    /// The condition is at least this (1'D1 / 1'A1, a Rayleigh quotient; infinite if 1'A1 vanishes)
    double condition_above = 1;
    /// and at most this (Gershgorin; infinite unless A is diagonally dominant in every row).
    double condition_below = infinity;

    /// The profile below the diagonal holds no more numbers than A: a factor in this numbering is no larger than A itself.
    bool narrow = false;

    /// Whether the condition is at most `limit`: the bounds decide, or 20 Lanczos steps between them.
    bool well_conditioned(const Matrix& A, double limit) const;
};

/// A square; one pass over a sparse A, else over its sparse form.
MatrixFacts matrix_facts(const Matrix& A);

/// For solvers that need a positive definite symmetric part: InputError in the name of `solver` where an entry of the
/// diagonal is below zero by more than rounding of the largest.
void check_no_negative_diagonal(std::string_view solver, const Matrix& A);

}  // namespace tact
