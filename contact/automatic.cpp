#include "automatic.hpp"

#include <algorithm>
#include <functional>
#include <limits>
#include <utility>

#include "dense/dense_contact.hpp"
#include "dense/orthogonal_contact.hpp"
#include "prepare/matrix_facts.hpp"
#include "prepare/merged_rows.hpp"
#include "prepare/renumbered.hpp"
#include "prepare/rows.hpp"
#include "strategies/colour_sor.hpp"
#include "strategies/diagonal_contact.hpp"
#include "strategies/interior_point.hpp"
#include "strategies/klu_active_set.hpp"
#include "strategies/multigrid_active_set.hpp"
#include "strategies/principal_pivoting.hpp"
#include "strategies/projected_cg.hpp"
#include "strategies/proximal_contact.hpp"
#include "strategies/schur_contact.hpp"

namespace tact {
namespace {

using Strategy = ContactStrategy;
using Prepared = std::unique_ptr<PreparedContact>;

constexpr Index largest_orthogonal = 4000;
/// Rows up to which pivots on a whole tableau are cheap.
constexpr Index largest_tableau = 500;
/// Rows of a pool behind a narrow band.
constexpr Index narrow_pool = 500;
/// Numbers in a dense B that few unknowns may have: five copies of them are 160 MB.
constexpr Index largest_dense_rows = 4000000;
/// Unknowns up to which CG has no chance: two plates of 1,600 each take 84 us a step with a factor, 650 with CG.
constexpr Index cheap_to_factor = 20000;

struct Choice {
    Strategy strategy;
    std::string_view reason;
};

bool allowed(const AutomaticOptions& options, Strategy strategy) {
    return std::find(options.never.begin(), options.never.end(), strategy) == options.never.end();
}

Prepared prepare_as(Strategy strategy, const Matrix& A, const Matrix& B) {
    switch (strategy) {
        case Strategy::diagonal: return DiagonalContact().prepare(A, B);
        case Strategy::dense: return DenseContact().prepare(A, B);
        case Strategy::klu_active_set: return KluActiveSet().prepare(A, B);
        case Strategy::colour_sor: return ColourSor().prepare(A, B);
        case Strategy::projected_cg: return ProjectedCg().prepare(A, B);
        case Strategy::multigrid_active_set: return MultigridActiveSet().prepare(A, B);
        case Strategy::interior_point: return InteriorPoint().prepare(A, B);
        case Strategy::schur: break;
    }
    return SchurContact().prepare(A, B);
}

/// Where A has no factor: what contact does not hold is found out by the proximal iteration.
Prepared prepare_proximal(const Matrix& A, const Matrix& B) {
    if (A.rows() <= largest_orthogonal) return ProximalContact(std::make_shared<OrthogonalContact>()).prepare(A, B);
    return ProximalContact(std::make_shared<SchurContact>()).prepare(A, B);
}

/// Iterations of a solve, in the strategy's own count, that are some ten times the usual ones.
int patience(Strategy strategy) {
    switch (strategy) {
        case Strategy::colour_sor: return 300;
        case Strategy::projected_cg: return 40;
        case Strategy::multigrid_active_set: return 60;
        default: return std::numeric_limits<int>::max();
    }
}

struct RowShape {
    bool bounds, disjoint;
};

RowShape shape_of(const Matrix& B) {
    if (const Vector* diagonal = B.diagonal_entries(); diagonal && (diagonal->array() != 0).all())
        return {true, true};
    const ConstraintRows rows(B);
    return {rows.bounds(), rows.disjoint()};
}

/// A as a diagonal matrix where it is one, however it is stored: the answer does not hang on that.
Matrix diagonal_if_it_is_one(const Matrix& A) {
    if (const SparseMatrix* sparse = A.sparse()) {
        for (Index j = 0; j < sparse->cols(); ++j)
            for (SparseMatrix::InnerIterator it(*sparse, j); it; ++it)
                if (it.row() != j && it.value() != 0) return A;
    } else if (const DenseMatrix* dense = A.dense()) {
        for (Index j = 0; j < dense->cols(); ++j)
            for (Index i = 0; i < dense->rows(); ++i)
                if (i != j && (*dense)(i, j) != 0) return A;
    } else {
        return A;
    }
    return Matrix::diagonal(A.main_diagonal());
}

Choice first_choice(const Matrix& A, const Matrix& B, const AutomaticOptions& options) {
    const auto may = [&](Strategy strategy) { return allowed(options, strategy); };
    if (options.always) return {*options.always, "asked for by the options"};
    if (!A.is_symmetric() && may(Strategy::klu_active_set)) return {Strategy::klu_active_set, "A is not symmetric"};
    if (const Vector* diagonal = A.diagonal_entries();
        diagonal && (diagonal->array() >= 0).all() && may(Strategy::diagonal) && shape_of(B).disjoint)
        return {Strategy::diagonal, "diagonal A, rows that do not overlap"};
    const bool small = A.rows() <= options.small;
    if ((!A.sparse() || small) && B.rows() <= 4 * options.small && may(Strategy::dense))
        return {Strategy::dense, "small or dense"};
    if (small && B.rows() <= largest_dense_rows / A.rows() && may(Strategy::dense))
        return {Strategy::dense, "few unknowns, of whose many rows few can be held"};
    const RowShape rows = shape_of(B);
    const MatrixFacts facts = matrix_facts(A);
    const bool sor = rows.bounds && may(Strategy::colour_sor);
    const bool cg = rows.disjoint && A.rows() > cheap_to_factor && may(Strategy::projected_cg);
    if (sor && facts.well_conditioned(A, facts.narrow ? options.sweepable_if_narrow : options.sweepable))
        return {Strategy::colour_sor, "well-conditioned A, bounds"};
    if (cg && facts.well_conditioned(A, options.well_conditioned))
        return {Strategy::projected_cg, "well-conditioned A, rows that do not overlap"};
    if (B.rows() > 0 && rows.bounds && facts.m_matrix && facts.positive_diagonal && !facts.narrow &&
        may(Strategy::multigrid_active_set))
        return {Strategy::multigrid_active_set, "ill-conditioned M-matrix, bounds, few solves with it so far"};
    if (!small && !rows.bounds && !rows.disjoint && 4 * B.rows() >= A.rows() && facts.positive_diagonal &&
        may(Strategy::interior_point))
        return {Strategy::interior_point, "many rows that overlap"};
    if (may(Strategy::schur)) return {Strategy::schur, "one factor of A for all solves"};
    if (may(Strategy::klu_active_set)) return {Strategy::klu_active_set, "what the options leave"};
    throw InputError("AutomaticContact: options.never leaves no strategy for A " + A.shape() + " and B " + B.shape());
}

/// Counts what a strategy does, and says when another one would do better.
class Record {
public:
    Record(Index rows, int solves_before_factor) : often_(solves_before_factor) {
        known_.assign(static_cast<std::size_t>(rows), 0);
    }

    /// After a solve by this strategy, settled or not: why to change to the factor, or nothing.
    std::string_view change(Strategy strategy, bool settled, const ContactReport& report, const VectorRef& lambda) {
        tired_ = settled && report.iterations <= patience(strategy) ? 0 : tired_ + 1;
        if (tired_ == 3) return "the iteration before it was slow or failed three times in a row";
        if (strategy != Strategy::multigrid_active_set) return {};
        int fresh = 0;
        for (Index i = 0; i < lambda.size(); ++i) {
            char& known = known_[static_cast<std::size_t>(i)];
            fresh += lambda[i] > 0 && !known;
            known |= lambda[i] > 0;
        }
        touched_ += fresh;
        fresh_ = solves_ == 0 ? fresh : 0.8 * fresh_ + 0.2 * fresh;
        ++solves_;
        if (columns_for_a_solve * (solves_ - often_) >= touched_ && fresh_ <= few_columns)
            return "the same A many times, few rows new to contact";
        return {};
    }

private:
    /// Columns of A^-1 B', one for each row in contact, that cost as much as a solve by multigrid does; and how many a
    /// solve behind the factor may need to be the cheaper one still.
    static constexpr int columns_for_a_solve = 16;
    static constexpr double few_columns = 8;
    int often_, solves_ = 0, tired_ = 0, touched_ = 0;
    double fresh_ = 0;         // rows new to contact: a running mean
    std::vector<char> known_;  // rows that were in contact once
};

/// The strategy in use, then the sturdier ones in turn until one reaches a residual of 1e-12, each prepared when it is
/// first needed.
class PreparedAutomatic final : public PreparedContact {
public:
    using Link = std::function<Prepared()>;
    struct Fallback {
        Link prepare;
        Prepared prepared;
    };

    PreparedAutomatic(Choice choice, Prepared first, std::vector<Link> rest, std::optional<Record> record)
        : choice_(choice), current_(std::move(first)), record_(std::move(record)) {
        for (Link& link : rest) rest_.push_back({std::move(link), nullptr});
    }

    bool reads_guess() const override { return current_->reads_guess(); }

    ContactReport solve(const ConstVectorRef& b, const ConstVectorRef& c, ContactPoint point) override {
        if (!change_.empty()) change_to_factor();
        ContactReport report = current_->solve(b, c, point);
        report.reason = choice_.reason;
        const bool settled_at_once = settled(report);
        for (std::size_t next = 0; !settled(report) && !certified(report) && next < rest_.size() && b.allFinite();
             ++next) {
            Vector u = point.u, lambda = point.lambda;
            ContactReport end;
            if (!try_link(rest_[next], b, c, {u, lambda}, end)) continue;
            const bool last_word = certified(end);
            if (standing(end) >= standing(report)) {
                end.fallback = end.fallback.empty() ? end.strategy : end.fallback;
                end.strategy = report.strategy;
                end.reason = report.reason;
                end.iterations += report.iterations;
                end.set_repeated |= report.set_repeated;
                report = std::move(end);
                if (report.outcome == Outcome::converged) {
                    point.u = u;
                    point.lambda = lambda;
                }
            }
            if (last_word) break;
        }
        if (record_) change_ = record_->change(choice_.strategy, settled_at_once, report, point.lambda);
        return report;
    }

private:
    static constexpr double sharp = 1e-12;
    /// false where A is too near singular for this one.
    static bool try_link(Fallback& link, const ConstVectorRef& b, const ConstVectorRef& c, ContactPoint point,
                         ContactReport& report) {
        try {
            if (!link.prepared) link.prepared = link.prepare();
            report = link.prepared->solve(b, c, point);
        } catch (const NumericalError&) {
            return false;
        }
        return true;
    }
    static bool settled(const ContactReport& report) {
        return report.outcome == Outcome::converged && report.kkt.largest() <= sharp;
    }
    static bool certified(const ContactReport& report) {
        return report.infeasibility.size() > 0 || report.ray.size() > 0;
    }
    /// An answer that is only not sharp stands against none; a proof that there is none against giving up.
    static double standing(const ContactReport& report) {
        if (report.outcome == Outcome::converged) return 3 - std::min(report.kkt.largest(), 0.5);
        if (certified(report)) return 2;
        return report.outcome == Outcome::infeasible ? 1 : 0;
    }

    /// The first fall-back is the factor: it becomes the strategy in use.
    void change_to_factor() {
        Fallback& factor = rest_.front();
        current_ = factor.prepared ? std::move(factor.prepared) : factor.prepare();
        rest_.erase(rest_.begin());
        choice_ = {Strategy::schur, std::exchange(change_, {})};
        record_.reset();
    }

    Choice choice_;
    Prepared current_;
    std::vector<Fallback> rest_;
    std::string_view change_;       // why the next solve is the factor's, or nothing
    std::optional<Record> record_;  // nothing once the choice is final
};

/// The strategy chosen for A and B, and those that follow it.
Prepared prepare_chosen(const Matrix& A, const Matrix& B, const AutomaticOptions& options) {
    Choice choice = first_choice(A, B, options);
    // A narrow band is refactored for less than many rows of a pool cost.
    const bool front = choice.strategy == Strategy::schur && !options.always && B.rows() > 4 * narrow_pool &&
                       allowed(options, Strategy::klu_active_set) && shape_of(B).bounds && matrix_facts(A).narrow;
    Prepared first;
    try {
        first = front ? SchurContact({.pool_rows = narrow_pool}).prepare(A, B) : prepare_as(choice.strategy, A, B);
    } catch (const NumericalError&) {
        if (B.rows() == 0 || !A.is_symmetric()) throw;  // nothing there that could hold it
        return std::make_unique<PreparedAutomatic>(Choice{Strategy::schur, "A is singular or indefinite to rounding"},
                                                   prepare_proximal(A, B), std::vector<PreparedAutomatic::Link>{},
                                                   std::nullopt);
    }
    std::vector<PreparedAutomatic::Link> rest;
    std::optional<Record> record;
    if (!A.is_symmetric()) {
        if (B.rows() > 0 && B.rows() <= largest_orthogonal)
            rest.push_back([A, B] { return PrincipalPivoting().prepare(A, B); });
    } else {
        if (front) rest.push_back([A, B] { return KluActiveSet().prepare(A, B); });
        const bool medium = A.rows() <= largest_orthogonal;
        const bool iteration = patience(choice.strategy) < std::numeric_limits<int>::max();
        if (choice.strategy != Strategy::schur && (iteration || !medium) && allowed(options, Strategy::schur))
            rest.push_back([A, B]() -> Prepared {
                try {
                    return SchurContact().prepare(A, B);
                } catch (const NumericalError&) {
                    return prepare_proximal(A, B);
                }
            });
        if (iteration && !options.always && !rest.empty()) record.emplace(B.rows(), options.solves_before_factor);
        if (medium) rest.push_back([A, B] { return OrthogonalContact().prepare(A, B); });
        if (choice.strategy != Strategy::interior_point && allowed(options, Strategy::interior_point) &&
            (A.main_diagonal().array() > 0).all())
            rest.push_back([A, B] { return InteriorPoint().prepare(A, B); });
        if (medium && B.rows() > 0 && B.rows() <= largest_tableau)
            rest.push_back([A, B] { return PrincipalPivoting().prepare(A, B); });
    }
    return std::make_unique<PreparedAutomatic>(choice, std::move(first), std::move(rest), std::move(record));
}

}  // namespace

std::unique_ptr<PreparedContact> AutomaticContact::prepare(const Matrix& A_as_stored, const Matrix& B) const {
    check_contact_matrices("AutomaticContact", A_as_stored, B);
    const Matrix A = options_.always ? A_as_stored : diagonal_if_it_is_one(A_as_stored);
    return prepare_merged(A, B, [&](const Matrix&, const Matrix& rows) {
        return prepare_renumbered(A, rows, [&](const Matrix& A_renumbered, const Matrix& B_renumbered) {
            return prepare_chosen(A_renumbered, B_renumbered, options_);
        });
    });
}

}  // namespace tact
