#include "renumbered.hpp"

#include <algorithm>
#include <utility>
#include <vector>

#include "../../lib/sparse/numbering.hpp"

namespace tact {
namespace {

std::size_t at(Index i) { return static_cast<std::size_t>(i); }

/// B in the new numbering of unknowns, its rows in the order in which they first meet an unknown.
struct OrderedRows {
    OrderedRows(const Matrix& given, const std::vector<int>& unknowns) {
        if (const Vector* diagonal = given.diagonal_entries()) {
            order = unknowns;
            B = Matrix::diagonal((*diagonal)(order));
            return;
        }
        const SparseMatrix copy = given.sparse() ? SparseMatrix() : given.to_sparse();
        const SparseMatrix& S = given.sparse() ? *given.sparse() : copy;
        if (is_one_row_an_unknown(S))
            take_diagonal(S, unknowns);
        else
            take(S, unknowns);
    }
    Matrix B;
    std::vector<int> order;  // old number of each new row

private:
    static bool is_one_row_an_unknown(const SparseMatrix& S) {
        if (S.rows() != S.cols() || S.nonZeros() != S.cols()) return false;
        std::vector<char> taken(at(S.rows()), 0);
        bool once = true;
        for (Index j = 0; j < S.cols(); ++j)
            once &= S.outerIndexPtr()[j] == j && !std::exchange(taken[at(S.innerIndexPtr()[j])], 1);
        return once;
    }

    void take_diagonal(const SparseMatrix& S, const std::vector<int>& unknowns) {
        Vector weight(S.cols());
        order.resize(unknowns.size());
        for (Index j = 0; j < S.cols(); ++j) {
            order[at(j)] = static_cast<int>(S.innerIndexPtr()[unknowns[at(j)]]);
            weight[j] = S.valuePtr()[unknowns[at(j)]];
        }
        B = Matrix::diagonal(std::move(weight));
    }

    void take(const SparseMatrix& S, const std::vector<int>& unknowns) {
        std::vector<int> place(at(S.rows()), -1);
        const auto number = [&](Index row) {
            if (place[at(row)] >= 0) return;
            place[at(row)] = static_cast<int>(order.size());
            order.push_back(static_cast<int>(row));
        };
        for (const int j : unknowns)
            for (SparseMatrix::InnerIterator it(S, j); it; ++it) number(it.row());
        for (Index row = 0; row < S.rows(); ++row) number(row);

        SparseMatrix ordered(S.rows(), S.cols());
        ordered.reserve(S.nonZeros());
        std::vector<std::pair<int, double>> column;
        for (Index j = 0; j < S.cols(); ++j) {
            column.clear();
            for (SparseMatrix::InnerIterator it(S, unknowns[at(j)]); it; ++it)
                column.emplace_back(place[at(it.row())], it.value());
            std::sort(column.begin(), column.end());
            ordered.startVec(j);
            for (const auto& [row, value] : column) ordered.insertBack(row, j) = value;
        }
        ordered.finalize();
        B = Matrix(std::move(ordered));
    }
};

/// Rows that join each unknown of one body with one of an equal body (node-to-node contact) tell which are the same: the
/// later body then takes the order of the earlier one, so that one factor serves both.
void number_equal_bodies_alike(Waves& waves, const Matrix& B) {
    if (waves.parts.size() < 3 || !B.sparse()) return;
    const auto place = inverse_of(waves.order);
    std::vector<int> first(at(B.rows()), -1), partner(place.size(), -1);
    for (Index j = 0; j < B.cols(); ++j)
        for (SparseMatrix::InnerIterator it(*B.sparse(), waves.order[at(j)]); it; ++it) {
            int& earlier = first[at(it.row())];
            if (earlier >= 0 && partner[at(j)] < 0) partner[at(j)] = earlier;
            if (earlier < 0) earlier = static_cast<int>(j);
        }
    for (std::size_t part = 1; part + 1 < waves.parts.size(); ++part) {
        const int begin = waves.parts[part], size = waves.parts[part + 1] - begin;
        const auto other =
            std::upper_bound(waves.parts.begin(), waves.parts.end(), partner[at(begin)]) - waves.parts.begin() - 1;
        if (other < 0 || waves.parts[at(other) + 1] - waves.parts[at(other)] != size) continue;
        std::vector<int> alike(at(size), -1);
        for (int j = begin; j < begin + size; ++j) {
            const int to = partner[at(j)] - waves.parts[at(other)];
            if (to >= 0 && to < size) alike[at(to)] = waves.order[at(j)];
        }
        if (std::find(alike.begin(), alike.end(), -1) == alike.end())
            std::copy(alike.begin(), alike.end(), waves.order.begin() + begin);
    }
}

/// An order, and two vectors in it.
struct Ordered {
    explicit Ordered(std::vector<int> order_)
        : order(std::move(order_)), place(inverse_of(order)), first(Vector::Zero(size())), second(first) {}
    Index size() const { return static_cast<Index>(order.size()); }

    /// x as the caller numbers it.
    void give(const Vector& x, VectorRef to) const {
        for (Index i = 0; i < size(); ++i) to[i] = x[place[at(i)]];
    }

    std::vector<int> order, place;
    Vector first, second;
};

class PreparedRenumbered final : public PreparedContact {
public:
    PreparedRenumbered(std::unique_ptr<PreparedContact> inner, std::vector<int> unknowns, std::vector<int> rows)
        : inner_(std::move(inner)), unknowns_(std::move(unknowns)), rows_(std::move(rows)) {}

    bool reads_guess() const override { return inner_->reads_guess(); }
    bool update(const Matrix& A) override {
        return A.sparse() && A.rows() == unknowns_.size() && A.cols() == unknowns_.size() &&
               inner_->update(renumbered(*A.sparse(), unknowns_.order));
    }

    ContactReport solve(const ConstVectorRef& b, const ConstVectorRef& c, ContactPoint point) override {
        for (Index i = 0; i < b.size(); ++i) {
            unknowns_.first[i] = b[unknowns_.order[at(i)]];
            unknowns_.second[i] = point.u[unknowns_.order[at(i)]];
        }
        // Multipliers are mostly zero: only the others are worth a jump.
        rows_.second.setZero();
        for (Index i = 0; i < c.size(); ++i) {
            if (point.lambda[i] != 0) rows_.second[rows_.place[at(i)]] = point.lambda[i];
        }
        for (Index i = 0; i < c.size(); ++i) rows_.first[i] = c[rows_.order[at(i)]];
        ContactReport report = inner_->solve(unknowns_.first, rows_.first, {unknowns_.second, rows_.second});
        if (report.outcome == Outcome::converged) {
            unknowns_.give(unknowns_.second, point.u);
            point.lambda.setZero();
            for (Index i = 0; i < c.size(); ++i)
                if (rows_.second[i] != 0) point.lambda[rows_.order[at(i)]] = rows_.second[i];
        }
        give_back(unknowns_, report.ray);
        give_back(rows_, report.infeasibility);
        return report;
    }

private:
    static void give_back(const Ordered& ordered, Vector& certificate) {
        if (certificate.size() == 0) return;
        const Vector in_order = std::exchange(certificate, Vector(certificate.size()));
        ordered.give(in_order, certificate);
    }

    std::unique_ptr<PreparedContact> inner_;
    Ordered unknowns_, rows_;
};

}  // namespace

std::unique_ptr<PreparedContact> prepare_renumbered(
    const Matrix& A, const Matrix& B,
    const std::function<std::unique_ptr<PreparedContact>(const Matrix& A, const Matrix& B)>& prepare) {
    Waves waves = A.sparse() ? wave_order(*A.sparse()) : Waves{};
    if (waves.order.empty()) return prepare(A, B);
    number_equal_bodies_alike(waves, B);
    OrderedRows rows(B, waves.order);
    auto inner = prepare(renumbered(*A.sparse(), waves.order), rows.B);
    return std::make_unique<PreparedRenumbered>(std::move(inner), std::move(waves.order), std::move(rows.order));
}

}  // namespace tact
