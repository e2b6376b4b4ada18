// Rows of B without entries: 0 >= c_i asks nothing of u, or what no u can give.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "../contact_solver.hpp"

namespace tact {

/// The rows of B that have no entry but zeros, ascending.
std::vector<Index> empty_rows(const Matrix& B);
inline bool has_empty_rows(const Matrix& B) { return !empty_rows(B).empty(); }

/// What `solver` makes of A and of B without its empty rows. Every strategy hands such a B on to it.
///
/// Where the unknown of a row was eliminated, its c_i is a difference of given positions and carries their rounding. So an
/// empty row is open, and carries no force, if c_i <= 1e-12 s, where s is the largest |c_j| + |B_j||u| among the other rows
/// that are not off (the largest |u_k| where there is none), at the solution u. Above that the outcome is `infeasible`, with
/// the row's unit vector as its certificate.
std::unique_ptr<PreparedContact> prepare_without_empty_rows(const ContactSolver& solver, const Matrix& A,
                                                            const Matrix& B);

/// "row 3 of B has no entries and c_3 is 0.1, expected ...", if that is why this solve was infeasible; else empty.
std::string contradiction_of_empty_row(const ContactReport& report, const Matrix& B, const ConstVectorRef& c);

}  // namespace tact
