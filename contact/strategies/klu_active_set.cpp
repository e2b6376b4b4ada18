#include "klu_active_set.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <unordered_set>
#include <vector>

#include "../../lib/algebra/empty_rows.hpp"
#include "../dense/acceptance.hpp"
#include "../prepare/matrix_facts.hpp"
#include "../prepare/nested_start.hpp"
#include "condensed_system.hpp"

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

/// Which wrong rows change sides. All of them, as long as no set comes back: the primal-dual active set. Then all while
/// they become fewer, and the first one alone after three sets in which they did not: finite wherever each set has one
/// solution and it is told from rounding. J. J. Judice, F. M. Pires, Comput. Oper. Res. 21 (1994); K. G. Murty (1974).
class Exchanges {
public:
    void start() {
        visited_.clear();
        careful_ = false;
    }
    /// Whether a set has come back since start().
    bool careful() const { return careful_; }
    /// Changes `active` by the wrong rows. false if it is then a set that was left before, for the first time or again.
    bool apply(std::vector<char>& active, const std::vector<Index>& wrong) {
        if (visited_.empty()) visited_.insert(fingerprint(active));
        bool all = true;
        if (careful_) {
            if (wrong.size() < fewest_) {
                fewest_ = wrong.size();
                patience_ = patient;
            } else if (patience_ > 0) {
                --patience_;
            }
            all = patience_ > 0;
        }
        for (std::size_t k = 0; k < (all ? wrong.size() : 1); ++k) active[at(wrong[k])] ^= 1;
        if (visited_.insert(fingerprint(active)).second) return true;
        visited_.clear();
        if (!careful_) {
            careful_ = true;
            fewest_ = wrong.size();
            patience_ = patient;
        }
        return false;
    }

private:
    static constexpr int patient = 3;
    static std::uint64_t fingerprint(const std::vector<char>& active) {
        std::uint64_t hash = 1469598103934665603ULL;
        for (const char on : active) hash = (hash ^ static_cast<std::uint64_t>(on)) * 1099511628211ULL;
        return hash;
    }
    std::unordered_set<std::uint64_t> visited_;
    bool careful_ = false;
    std::size_t fewest_ = 0;
    int patience_ = 0;
};

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
          system_(unit_.asDiagonal() * A.to_sparse() * unit_.asDiagonal(), rows_),
          active_(at(B.rows()), 0) {
        if (rows_.bounds()) intervals_.emplace(rows_, A.rows());
        start_from_coarser_graphs();
    }

    /// In the units of the first A, while the new one's are within a factor of 16.
    bool update(const Matrix& A) override {
        if (A.rows() != unit_.size() || A.cols() != unit_.size()) return false;
        check_no_negative_diagonal("KluActiveSet", A);
        const Vector change = A.main_diagonal().unaryExpr(&unit_of).cwiseQuotient(unit_);
        if (!(change.minCoeff() >= 1.0 / 16 && change.maxCoeff() <= 16)) return false;
        if (!system_.take(unit_.asDiagonal() * A.to_sparse() * unit_.asDiagonal())) return false;
        accept_ = Acceptance(A, given_B_);
        start_from_coarser_graphs();
        return true;
    }

    ContactReport solve(const ConstVectorRef& b, const ConstVectorRef& c, ContactPoint point) override {
        ContactReport report;
        report.strategy = "KLU condensed";
        b_ = b.cwiseProduct(unit_);
        c_ = c.cwiseProduct(row_unit_);
        for (Index i = 0; i < c.size(); ++i) active_[at(i)] = point.lambda[i] > 0 && c[i] != -infinity;
        if (!find_set(report)) return report;
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
        if (intervals_) nested_.emplace(SparseMatrix(system_.by_row().transpose()));
    }

    static constexpr double acceptable = 1e-10;
    /// Of the terms that a multiplier is a sum of: what their rounding leaves of a multiplier that is zero. Where a set
    /// comes back it was more, by the condition of the set's equations: up to `most_rounding`, far below what is accepted.
    static constexpr double rounding = 1e-15, most_rounding = 1e-12;
    /// Sets after which a guess is known to be far from the answer: the coarser graphs cost about as much again.
    static constexpr int patient = 4;
    /// Rows that may be wrong at first where nothing was guessed: an active set then needs no better start.
    static constexpr std::size_t few = 8;

    /// The set whose solution violates no row and pulls at none; false, with the reason in the report, if none is found.
    bool find_set(ContactReport& report) {
        exchanges_.start();
        noise_ = rounding;
        bool nested = !nested_;
        const int limit = 1000 + 2 * static_cast<int>(std::min<Index>(c_.size(), 1000000));
        const bool cold = std::find(active_.begin(), active_.end(), char{1}) == active_.end();
        for (report.iterations = 1;; ++report.iterations) {
            if (!system_.factor(active_)) {
                if (std::find(active_.begin(), active_.end(), char{1}) == active_.end())
                    throw NumericalError("KluActiveSet: A is singular (" + std::to_string(b_.size()) + "x" +
                                         std::to_string(b_.size()) + ")");
                report.outcome = Outcome::inaccurate;  // dependent rows in contact
                return false;
            }
            system_.solve(b_, c_, active_, u_, lambda_, size_);
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
    CondensedSystem system_;
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
