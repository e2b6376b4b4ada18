#include "klu_active_set.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "../../lib/algebra/empty_rows.hpp"
#include "../dense/acceptance.hpp"
#include "../dense/exchanges.hpp"
#include "../prepare/matrix_facts.hpp"
#include "../prepare/nested_start.hpp"
#include "condensed_system.hpp"
#include "touched_rows.hpp"

namespace tact {
namespace {

std::size_t at(Index i) { return static_cast<std::size_t>(i); }

/// A power of two, so that scaling rounds nothing, near 1 / sqrt(x); 1 where x is not positive.
double unit_of(double x) { return x > 0 ? std::exp2(std::round(-0.5 * std::log2(x))) : 1; }

Vector unit_rows(const SparseMatrix& B) {
    Vector square = Vector::Zero(B.rows());
    for (Index j = 0; j < B.outerSize(); ++j)
        for (SparseMatrix::InnerIterator it(B, j); it; ++it) square[it.row()] += it.value() * it.value();
    return square.unaryExpr(&unit_of);
}

/// Rows with one entry as an interval for each unknown.
class Intervals {
public:
    Intervals(const ConstraintRows& rows, Index unknowns) : rows_(rows), lower_(unknowns), upper_(unknowns) {
        on_lower_.resize(at(unknowns));
        on_upper_.resize(at(unknowns));
    }
    /// false where an interval is empty.
    bool set(const Vector& c) {
        lower_.setConstant(-infinity);
        upper_.setConstant(infinity);
        for (Index i = 0; i < rows_.rows(); ++i) {
            if (c[i] == -infinity) continue;
            const Index j = rows_.columns(i)[0];
            const double weight = rows_.weights(i)[0], bound = c[i] / weight;
            if (weight > 0 && bound > lower_[j]) {
                lower_[j] = bound;
                on_lower_[at(j)] = i;
            } else if (weight < 0 && bound < upper_[j]) {
                upper_[j] = bound;
                on_upper_[at(j)] = i;
            }
        }
        return (lower_.array() <= upper_.array()).all();
    }
    const Vector& lower() const { return lower_; }
    const Vector& upper() const { return upper_; }
    Index row_on(Index j, int side) const { return side < 0 ? on_lower_[at(j)] : on_upper_[at(j)]; }

private:
    const ConstraintRows& rows_;
    Vector lower_, upper_;
    std::vector<Index> on_lower_, on_upper_;
};

/// In unknowns of unit stiffness and rows of unit length, where pivots say whether the system of a set is singular.
class PreparedKlu final : public PreparedContact {
public:
    PreparedKlu(const Matrix& A, const Matrix& B)
        : given_B_(B),
          accept_(A, B),
          unit_(A.main_diagonal().unaryExpr(&unit_of)),
          B_(B.to_sparse() * unit_.asDiagonal()),
          row_unit_(unit_rows(B_)),
          rows_(Matrix(SparseMatrix(row_unit_.asDiagonal() * B_))),
          symmetric_(A.is_symmetric()),
          A_(unit_.asDiagonal() * A.to_sparse() * unit_.asDiagonal()),
          active_(at(B.rows()), 0) {
        if (rows_.bounds()) intervals_.emplace(rows_, A.rows());
        start_from_coarser_graphs();
    }

    /// In the units of the first A, while the new one's are within a factor of 16.
    bool update(const Matrix& A) override {
        if (A.rows() != unit_.size() || A.cols() != unit_.size() || A.is_symmetric() != symmetric_) return false;
        check_no_negative_diagonal("KluActiveSet", A);
        const Vector change = A.main_diagonal().unaryExpr(&unit_of).cwiseQuotient(unit_);
        if (!(change.minCoeff() >= 1.0 / 16 && change.maxCoeff() <= 16)) return false;
        SparseMatrix scaled = unit_.asDiagonal() * A.to_sparse() * unit_.asDiagonal();
        if (system_ && !system_->take(scaled)) return false;
        A_ = std::move(scaled);
        accept_ = Acceptance(A, given_B_);
        behind_.reset();
        load_.resize(0);
        start_from_coarser_graphs();
        return true;
    }

    ContactReport solve(const ConstVectorRef& b, const ConstVectorRef& c, ContactPoint point) override {
        ContactReport report;
        report.strategy = "KLU condensed";
        b_ = b.cwiseProduct(unit_);
        c_ = c.cwiseProduct(row_unit_);
        if (pays_) {
            if (solve_on_pool(point.lambda, report)) {
                accept_.certify(report, b, c, u_, lambda_, acceptable, 0, point);
                if (report.outcome == Outcome::converged) return report;
            }
            report = {};
            report.strategy = "KLU condensed";
        }
        for (Index i = 0; i < c.size(); ++i) active_[at(i)] = point.lambda[i] > 0 && c[i] != -infinity;
        if (!find_set(report)) return report;
        note_costs(report.iterations);
        // A bound is met exactly: a gap of zero then is zero, not rounding.
        for (Index i = 0; i < c.size(); ++i)
            if (active_[at(i)] && rows_.columns(i).size() == 1) u_[rows_.columns(i)[0]] = c_[i] / rows_.weights(i)[0];
        u_ = u_.cwiseProduct(unit_).eval();
        lambda_ = lambda_.cwiseMax(0).cwiseProduct(row_unit_).eval();
        accept_.certify(report, b, c, u_, lambda_, acceptable, 0, point);
        return report;
    }

private:
    void start_from_coarser_graphs() {
        if (intervals_) nested_.emplace(A_);
    }

    static constexpr double acceptable = 1e-10;
    /// Of the terms that a multiplier is a sum of: what their rounding leaves of a multiplier that is zero. Where a set
    /// comes back it was more, by the condition of the set's equations: up to `most_rounding`, far below what is accepted.
    static constexpr double rounding = 1e-15, most_rounding = 1e-12;
    /// Sets after which a guess is known to be far from the answer: the coarser graphs cost about as much again.
    static constexpr int patient = 4;
    /// Rows that may be wrong at first where nothing was guessed: an active set then needs no better start.
    static constexpr std::size_t few = 8;

    static constexpr std::size_t pool_bytes = std::size_t{1} << 30;
    /// Sets that a solve by refactoring takes at least when contact changes: rows for that price join the pool at any time.
    static constexpr double affordable_sets = 4;

    /// The set whose solution violates no row and pulls at none; false, with the reason in the report, if none is found.
    bool find_set(ContactReport& report) {
        exchanges_.start();
        noise_ = rounding;
        if (!system_) system_.emplace(A_, rows_);
        bool nested = !nested_;
        const int limit = 1000 + 2 * static_cast<int>(std::min<Index>(c_.size(), 1000000));
        const bool cold = std::find(active_.begin(), active_.end(), char{1}) == active_.end();
        for (report.iterations = 1;; ++report.iterations) {
            if (!system_->factor(active_)) {
                if (std::find(active_.begin(), active_.end(), char{1}) == active_.end())
                    throw NumericalError("KluActiveSet: A is singular (" + std::to_string(b_.size()) + "x" +
                                         std::to_string(b_.size()) + ")");
                report.outcome = Outcome::inaccurate;  // dependent rows in contact
                return false;
            }
            system_->solve(b_, c_, active_, u_, lambda_, size_);
            find_wrong();
            if (wrong_.empty()) return true;
            if (report.iterations >= limit) {
                report.outcome = exchanges_.careful() ? Outcome::cycling : Outcome::iteration_limit;
                return false;
            }
            if (!nested && (report.iterations == patient || (cold && wrong_.size() > few))) {
                nested = true;
                if (start_nested()) {
                    exchanges_.start();
                    continue;
                }
            }
            if (!exchanges_.apply(active_, wrong_)) {
                report.set_repeated = true;
                noise_ = std::min(16 * noise_, most_rounding);
            }
        }
    }

    /// One factor of A for all sets, and the rows in contact as columns of a pool.
    struct Behind {
        Behind(const SparseMatrix& A, bool symmetric, const Matrix& B, const ConstraintRows& rows)
            : factor(A, symmetric),
              touched(
                  factor, symmetric ? TransposedSolve() : [this](auto X) { factor.solve_transposed(X); }, B, rows,
                  pool_bytes) {}
        KluFactor factor;
        TouchedRows touched;
    };

    /// What refactoring has cost since the pool took in rows, against what the rows in contact would cost it: whoever changes
    /// when the one has reached the other pays at most twice what the better of the two would have cost from the start.
    void note_costs(int sets) {
        if (!behind_) return;
        spent_ += sets * system_->factor_cost();
        double missing = 0, held = 0;
        for (Index i = 0; i < c_.size(); ++i) {
            if (!active_[at(i)]) continue;
            ++held;
            if (!behind_->touched.pool().holds(i)) ++missing;
        }
        // Dense operations on the rows held run about ten times as fast as sparse ones.
        const bool small = held * held * held <= 30 * system_->factor_cost() &&
                           held * held * sizeof(double) <= 0.25 * static_cast<double>(pool_bytes);
        pays_ = small && spent_ >= missing * row_cost();
    }

    /// Of a row that joins the pool. A solve reads each number of the factor once: three times as slow an operation, two
    /// solves where A is not symmetric. Where the factor is one of Cholesky's, a quarter of it is read, many rows at once.
    double row_cost() const {
        const double share = behind_->factor.symmetric() ? 0.25 : symmetric_ ? 3 : 6;
        return share * behind_->factor.solve_cost();
    }

    /// false if there is no pool, if its dense active set has no answer, or if too many rows are new.
    bool solve_on_pool(const ConstVectorRef& guess, ContactReport& report) {
        pays_ = false;
        if (!behind_) {
            try {
                behind_ = std::make_unique<Behind>(A_, symmetric_, Matrix(SparseMatrix(row_unit_.asDiagonal() * B_)),
                                                   rows_);
            } catch (const NumericalError&) {
                return false;  // the rows in contact may make up for what A lacks
            }
        }
        if (load_.size() != b_.size() || load_ != b_) {
            free_ = b_;
            behind_->factor.solve(free_);
            load_ = b_;
        }
        TouchedRows& touched = behind_->touched;
        const Index before = touched.pool().size();
        const double price = std::max(spent_, affordable_sets * behind_->factor.factor_cost());
        const auto most = static_cast<Index>(std::min(price / row_cost(), 1e9)) + 1;
        report.strategy = "KLU pool";
        const Outcome outcome = touched.solve(free_, c_, guess, report, most);
        spent_ = std::max(0.0, spent_ - static_cast<double>(touched.pool().size() - before) * row_cost());
        if (outcome != Outcome::converged) return false;
        pays_ = true;
        u_ = touched.u().cwiseProduct(unit_);
        lambda_ = touched.lambda().cwiseProduct(row_unit_);
        return true;
    }

    bool start_nested() {
        if (!intervals_->set(c_) || !nested_->find(b_, intervals_->lower(), intervals_->upper(), u_, side_))
            return false;
        std::fill(active_.begin(), active_.end(), char{0});
        for (Index j = 0; j < u_.size(); ++j)
            if (side_[at(j)] != 0) active_[at(intervals_->row_on(j, side_[at(j)]))] = 1;
        return true;
    }

    void find_wrong() {
        wrong_.clear();
        for (Index i = 0; i < c_.size(); ++i) {
            if (active_[at(i)]) {
                if (lambda_[i] < -noise_ * size_[i] || std::isnan(lambda_[i])) wrong_.push_back(i);
            } else if (c_[i] != -infinity) {
                const double gap = rows_.gather(i, u_.data()) - c_[i];
                if (gap < -2e-14 * (std::abs(c_[i]) + rows_.gather_absolute(i, u_.data()))) wrong_.push_back(i);
            }
        }
    }

    Matrix given_B_;
    Acceptance accept_;
    Vector unit_;
    SparseMatrix B_;  // in these units
    Vector row_unit_;
    ConstraintRows rows_;
    bool symmetric_;
    SparseMatrix A_;                         // in these units
    std::optional<CondensedSystem> system_;  // once a set is refactored
    std::unique_ptr<Behind> behind_;
    bool pays_ = true;    // to try the pool
    double spent_ = 0;    // on refactoring: operations that no row of the pool has used up
    Vector load_, free_;  // A^-1 load_, in these units
    Exchanges exchanges_;
    std::optional<Intervals> intervals_;  // where every row has one entry
    std::optional<NestedStart> nested_;
    std::vector<char> active_;
    std::vector<signed char> side_;
    std::vector<Index> wrong_;
    double noise_ = rounding;
    Vector b_, c_, u_, lambda_, size_;
};

}  // namespace

std::unique_ptr<PreparedContact> KluActiveSet::prepare(const Matrix& A, const Matrix& B) const {
    check_contact_matrices("KluActiveSet", A, B);
    if (has_empty_rows(B)) return prepare_without_empty_rows(*this, A, B);
    check_no_negative_diagonal("KluActiveSet", A);
    return std::make_unique<PreparedKlu>(A, B);
}

}  // namespace tact
