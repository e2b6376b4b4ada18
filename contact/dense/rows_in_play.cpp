#include "rows_in_play.hpp"

#include <algorithm>

namespace tact {

RowsInPlay::RowsInPlay(const CondensedRows& condensed)
    : condensed_(condensed), place_(static_cast<std::size_t>(condensed.B.rows()), -1) {
    // Without S only few of many rows are ever in play: about as many as there are unknowns can be held.
    make_room(condensed.S.size() > 0 ? condensed.S.rows() : std::min(condensed.B.rows(), condensed.B.cols() + 16));
}

void RowsInPlay::make_room(Index rows) {
    block_.conservativeResize(rows, rows);
    for (Vector* v : {&g_, &allowance_, &lambda_, &w_}) v->conservativeResize(rows);
    rows_.reserve(static_cast<std::size_t>(rows));
    dual_.reserve(rows);
}

void RowsInPlay::clear() {
    for (const Index row : rows_) place_[static_cast<std::size_t>(row)] = -1;
    rows_.clear();
    dual_.reset();
}

void RowsInPlay::add(Index row) {
    const Index place = size();
    if (place == block_.rows()) make_room(2 * place);
    place_[static_cast<std::size_t>(row)] = place;
    rows_.push_back(row);
    for (Index i = 0; i <= place; ++i) {
        const double entry = condensed_.compliance_between(rows_[static_cast<std::size_t>(i)], row);
        block_(i, place) = entry;
        block_(place, i) = entry;
    }
    lambda_[place] = 0;
}

GoldfarbIdnani::Report RowsInPlay::solve() {
    const Index k = size();
    return dual_.solve(block_, g_.head(k), allowance_.head(k), lambda_.head(k), w_.head(k));
}

}  // namespace tact
