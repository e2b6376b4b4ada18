#include "empty_rows.hpp"

#include <algorithm>
#include <cmath>

namespace tact {
namespace {

/// Far above the rounding of a few subtractions, far below any gap that is meant.
constexpr double rounding = 1e-12;

SparseMatrix rows_of(const Matrix& B, const std::vector<Index>& rows) {
    std::vector<long> place(static_cast<std::size_t>(B.rows()), -1);
    for (std::size_t k = 0; k < rows.size(); ++k) place[static_cast<std::size_t>(rows[k])] = static_cast<long>(k);
    const SparseMatrix S = B.to_sparse();
    std::vector<Eigen::Triplet<double, long>> entries;
    for (Index j = 0; j < S.outerSize(); ++j)
        for (SparseMatrix::InnerIterator it(S, j); it; ++it)
            if (const long row = place[static_cast<std::size_t>(it.row())]; row >= 0)
                entries.emplace_back(row, j, it.value());
    SparseMatrix result(static_cast<Index>(rows.size()), B.cols());
    result.setFromTriplets(entries.begin(), entries.end());
    return result;
}

Matrix absolute(const Matrix& B) {
    if (const DenseMatrix* dense = B.dense()) return Matrix(DenseMatrix(dense->cwiseAbs()));
    return Matrix(SparseMatrix(B.to_sparse().cwiseAbs()));
}

class PreparedWithoutEmpty final : public PreparedContact {
public:
    PreparedWithoutEmpty(std::unique_ptr<PreparedContact> inner, const Matrix& B, std::vector<Index> kept,
                         std::vector<Index> empty)
        : inner_(std::move(inner)),
          absolute_(absolute(B)),
          kept_(std::move(kept)),
          empty_(std::move(empty)),
          u_(B.cols()),
          size_(B.rows()),
          c_(B.rows()),
          lambda_(B.rows()) {}

    bool reads_guess() const override { return inner_->reads_guess(); }

    ContactReport solve(const ConstVectorRef& b, const ConstVectorRef& c, ContactPoint point) override {
        c_ = c(kept_);
        lambda_ = point.lambda(kept_);
        u_ = point.u;
        ContactReport report = inner_->solve(b, c_, {u_, lambda_});
        const bool solved = report.outcome == Outcome::converged;
        const auto worst =
            std::max_element(empty_.begin(), empty_.end(), [&](Index i, Index j) { return c[i] < c[j]; });
        // Where there is no u, the gaps alone say what is rounding.
        if (c[*worst] > 0 && c[*worst] > rounding * size_of_rows(solved) && report.infeasibility.size() == 0)
            return contradiction(*worst, report, c.size());
        if (report.infeasibility.size() > 0) {
            Vector certificate = Vector::Zero(c.size());
            certificate(kept_) = report.infeasibility;
            report.infeasibility.swap(certificate);
        }
        if (!solved) return report;
        point.u = u_;
        point.lambda(kept_) = lambda_;
        for (const Index row : empty_) point.lambda[row] = 0;
        return report;
    }

private:
    double size_of_rows(bool solved) {
        double largest = -1;
        if (solved) absolute_.multiply(u_.cwiseAbs(), size_);
        for (Index i = 0; i < c_.size(); ++i)
            if (c_[i] != -infinity) largest = std::max(largest, std::abs(c_[i]) + (solved ? size_[i] : 0));
        if (largest >= 0) return largest;
        return solved ? u_.lpNorm<Eigen::Infinity>() : 0;
    }

    static ContactReport contradiction(Index row, const ContactReport& solve, Index rows) {
        ContactReport report;
        report.outcome = Outcome::infeasible;
        report.iterations = solve.iterations;
        report.strategy = solve.strategy;
        report.reason = solve.reason;
        report.infeasibility.setZero(rows);
        report.infeasibility[row] = 1;
        return report;
    }

    std::unique_ptr<PreparedContact> inner_;
    Matrix absolute_;  // |B| without its empty rows
    std::vector<Index> kept_, empty_;
    Vector u_, size_, c_, lambda_;
};

}  // namespace

std::vector<Index> empty_rows(const Matrix& B) {
    std::vector<char> used(static_cast<std::size_t>(B.rows()), 0);
    if (const SparseMatrix* S = B.sparse()) {
        const auto* inner = S->innerIndexPtr();
        const double* value = S->valuePtr();
        for (Index k = 0; k < S->nonZeros(); ++k)
            if (value[k] != 0) used[static_cast<std::size_t>(inner[k])] = 1;
    } else if (const DenseMatrix* D = B.dense()) {
        for (Index j = 0; j < D->cols(); ++j)
            for (Index i = 0; i < D->rows(); ++i)
                if ((*D)(i, j) != 0) used[static_cast<std::size_t>(i)] = 1;
    } else {
        const Vector& d = *B.diagonal_entries();
        for (Index i = 0; i < d.size(); ++i) used[static_cast<std::size_t>(i)] = d[i] != 0;
    }
    std::vector<Index> rows;
    for (std::size_t i = 0; i < used.size(); ++i)
        if (!used[i]) rows.push_back(static_cast<Index>(i));
    return rows;
}

std::unique_ptr<PreparedContact> prepare_without_empty_rows(const ContactSolver& solver, const Matrix& A,
                                                            const Matrix& B) {
    std::vector<Index> empty = empty_rows(B);
    if (empty.empty()) return solver.prepare(A, B);
    std::vector<Index> kept;
    for (Index i = 0, next = 0; i < B.rows(); ++i)
        if (next < static_cast<Index>(empty.size()) && empty[static_cast<std::size_t>(next)] == i)
            ++next;
        else
            kept.push_back(i);
    const Matrix rest = B.dense() ? Matrix(DenseMatrix((*B.dense())(kept, Eigen::all))) : Matrix(rows_of(B, kept));
    return std::make_unique<PreparedWithoutEmpty>(solver.prepare(A, rest), rest, std::move(kept), std::move(empty));
}

std::string contradiction_of_empty_row(const ContactReport& report, const Matrix& B, const ConstVectorRef& c) {
    const Vector& y = report.infeasibility;
    if (report.outcome != Outcome::infeasible || y.size() != B.rows() || (y.array() != 0).count() != 1) return {};
    Index row = 0;
    y.cwiseAbs().maxCoeff(&row);
    const std::vector<Index> empty = empty_rows(B);
    if (!std::binary_search(empty.begin(), empty.end(), row)) return {};
    const std::string number = std::to_string(row);
    return "row " + number + " of B has no entries and c_" + number + " is " + shown(c[row]) +
           ", expected at most 1e-12 of the other rows' size: no u satisfies 0 >= c_" + number;
}

}  // namespace tact
