// A contact solve that works on, and certifies, only the rows that are not proven open.
#pragma once

#include <utility>
#include <vector>

#include "../../lib/contact_solver.hpp"
#include "condensed_rows.hpp"
#include "rows_in_play.hpp"
#include "screened_gaps.hpp"

namespace tact {

/// Goldfarb-Idnani on a set C of rows: those with a guessed multiplier, then every row that the solution on C leaves in
/// doubt (where S is not formed because rows are very many: the worst of them). C only grows within a solve, so it ends; the
/// rows outside are open at the solution it ends with. A step costs what C costs, besides the proof. Allocates nothing in a
/// solve where S is formed.
class FewRows {
public:
    /// The rows of B are those of `condensed` without their scale; `condensed` must outlive this object.
    FewRows(const Matrix& A, const DenseMatrix& B, const CondensedRows& condensed);

    /// On entry u = A^-1 b. True: the point has taken a solution whose residuals, in the report, are within `tolerance`.
    /// False says nothing: the point is as it was, u is changed, and the solve on all rows is to decide.
    bool solve(ContactReport& report, const ConstVectorRef& b, const ConstVectorRef& c, Vector& u, ContactPoint point,
               double tolerance);

private:
    void start(const ConstVectorRef& c, const ConstVectorRef& guess);
    void enter(Index row, const ConstVectorRef& c);
    void measure(Index place, const ConstVectorRef& c);
    void measure(Index place, const ConstVectorRef& c, double moved);
    void measure_all(const ConstVectorRef& c);
    void move(const ConstVectorRef& c, Vector& u);
    bool take_in_doubt(const ConstVectorRef& c, const Vector& u, std::size_t most);

    static constexpr std::size_t few = 8;  ///< rows that join at first where they are very many

    const CondensedRows& condensed_;
    DenseMatrix rows_;  // column i: row i of condensed_.B
    ScreenedGaps screen_;
    KktCertificate certificate_;
    RowsInPlay play_;
    std::vector<Index> bound_of_;                  // of each row: its place in condensed_.bounds, or -1
    std::vector<Index> fresh_;                     // in doubt and not in C
    std::vector<std::pair<double, Index>> depth_;  // their gaps
    std::vector<Index> listed_;                    // what is certified: the rows in doubt and those with a multiplier
    std::vector<Index> pressed_;                   // places in C with a multiplier
    Vector free_;                                  // A^-1 b, once C has a row
    Vector lambda_, soft_c_;
    double gap_size_ = 0;
};

}  // namespace tact
