// Diagonally implicit Runge-Kutta methods as data.
#pragma once

#include <string>

#include "../../lib/types.hpp"

namespace tact {

/// s stages: z_i = y_n + h sum_j A_ij f(z_j), y_n+1 = y_n + h sum_i b_i f(z_i), and for the error estimate the same with
/// b_embedded (empty: fixed steps only).
struct ButcherTable {
    std::string name;
    int order = 0;
    int embedded_order = 0;
    DenseMatrix A;  ///< s x s, lower triangular
    Vector b, c;    ///< s
    Vector b_embedded;

    Index stages() const { return b.size(); }
    /// b is the last row of A: y_n+1 is itself a stage, and so admissible under contact.
    bool stiffly_accurate() const;
};

/// InputError that says which unless: A is lower triangular with a positive diagonal (zero in the first stage at most), A,
/// b, c and b_embedded fit, c_i = sum_j A_ij, sum b = sum b_embedded = 1.
void validate(const ButcherTable& table);

/// Alexander's method of two stages, gamma = 1 - 1/sqrt(2), order 2 with an embedded backward Euler step; L-stable,
/// stiffly accurate, no explicit stage.
ButcherTable sdirk2();
/// Trapezoid to gamma, BDF2 to the end; order 2 embedded in 3; L-stable, first stage explicit. (Bank et al. 1985;
/// SUNDIALS' TRBDF2_3_3_2.)
ButcherTable tr_bdf2();
/// Order 3 with 2, L-stable, first stage explicit (Kennedy, Carpenter 2003; SUNDIALS' ARK324L2SA_DIRK_4_2_3).
ButcherTable esdirk32();
/// Order 4 with 3, L-stable, five equal diagonal entries, no explicit stage (Hairer, Wanner; SUNDIALS' SDIRK_5_3_4).
ButcherTable sdirk54();

}  // namespace tact
