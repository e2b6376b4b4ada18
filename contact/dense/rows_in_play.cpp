#include "rows_in_play.hpp"

namespace tact {

RowsInPlay::RowsInPlay(const DenseMatrix& S)
    : S_(S),
      block_(S.rows(), S.rows()),
      place_(static_cast<std::size_t>(S.rows()), -1),
      g_(S.rows()),
      allowance_(S.rows()),
      lambda_(S.rows()),
      w_(S.rows()) {
    rows_.reserve(place_.size());
    dual_.reserve(S.rows());
}

void RowsInPlay::clear() {
    for (const Index row : rows_) place_[static_cast<std::size_t>(row)] = -1;
    rows_.clear();
    dual_.reset();
}

void RowsInPlay::add(Index row) {
    const Index place = size();
    place_[static_cast<std::size_t>(row)] = place;
    rows_.push_back(row);
    for (Index i = 0; i <= place; ++i) {
        const double entry = S_(rows_[static_cast<std::size_t>(i)], row);
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
