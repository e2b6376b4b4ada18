#include "automatic.hpp"

#include <algorithm>
#include <optional>
#include <string>
#include <utility>

#include "../lib/algebra/empty_rows.hpp"
#include "choice.hpp"
#include "prepare/interval_contact.hpp"
#include "prepare/merged_rows.hpp"
#include "prepare/renumbered.hpp"
#include "strategies/schur_contact.hpp"
#include "strategy_table.hpp"

namespace tact {
namespace {

using Strategy = ContactStrategy;
using Prepared = std::unique_ptr<PreparedContact>;

Prepared prepare_as(Strategy strategy, const Matrix& A, const Matrix& B) { return facts_of(strategy).prepare(A, B); }

Prepared prepare_choice(const StrategyChoice& choice, const Matrix& A, const Matrix& B) {
    if (choice.pool_rows == 0) return prepare_as(choice.strategy, A, B);
    return SchurContact({.least_stiffness = nearly_singular, .pool_rows = choice.pool_rows}).prepare(A, B);
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

/// Counts what a strategy does, and says when another one would do better.
class Record {
public:
    Record(Index rows, int solves_before_factor) : often_(solves_before_factor) {
        known_.assign(static_cast<std::size_t>(rows), 0);
    }

    /// After a solve by this strategy, settled or not: why to change to the factor, or nothing.
    std::string_view change(Strategy strategy, bool settled, const ContactReport& report, const VectorRef& lambda) {
        tired_ = settled && report.iterations <= facts_of(strategy).patience ? 0 : tired_ + 1;
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
    struct Follower {
        Strategy strategy;
        Prepared prepared = nullptr;
    };

    PreparedAutomatic(const Matrix& A, const Matrix& B, StrategyChoice choice, Prepared first,
                      const std::vector<Strategy>& rest, std::optional<Record> record)
        : A_(A), B_(B), choice_(choice), current_(std::move(first)), record_(std::move(record)) {
        for (const Strategy strategy : rest) rest_.push_back({strategy});
    }

    bool reads_guess() const override { return current_->reads_guess(); }

    /// The choice stays, and the strategy in use is prepared anew where it cannot be updated.
    bool update(const Matrix& A) override {
        if (!can_stay(A)) return false;
        try {
            if (!current_->update(A)) current_ = prepare_choice(choice_, A, B_);
        } catch (const InputError&) {
            return false;
        } catch (const NumericalError&) {
            return false;
        }
        A_ = A;
        for (Follower& follower : rest_) follower.prepared.reset();
        return true;
    }

    ContactReport solve(const ConstVectorRef& b, const ConstVectorRef& c, ContactPoint point) override {
        if (!change_.empty()) change_to_factor();
        ContactReport report = solve_first(b, c, point);
        const bool settled_at_once = settled(report);
        for (std::size_t next = 0; !settled(report) && !certified(report) && next < rest_.size() && b.allFinite();
             ++next) {
            Vector u = point.u, lambda = point.lambda;
            ContactReport end;
            if (!try_follower(rest_[next], b, c, {u, lambda}, end)) continue;
            const bool last_word = certified(end);
            if (standing(end) >= standing(report)) {
                if (!report.strategy.empty()) {
                    end.fallback = end.fallback.empty() ? end.strategy : end.fallback;
                    end.strategy = report.strategy;
                }
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
        if (!broken_.empty() && report.strategy.empty()) throw NumericalError(broken_);
        if (record_) change_ = record_->change(choice_.strategy, settled_at_once, report, point.lambda);
        return report;
    }

private:
    static constexpr double sharp = 1e-12;
    /// Where it breaks down on A, and others may follow, its text is kept and the report names no strategy.
    ContactReport solve_first(const ConstVectorRef& b, const ConstVectorRef& c, ContactPoint point) {
        ContactReport report;
        broken_.clear();
        try {
            report = current_->solve(b, c, point);
        } catch (const NumericalError& error) {
            if (rest_.empty()) throw;
            broken_ = error.what();
            report.outcome = Outcome::inaccurate;
        }
        report.reason = choice_.reason;
        return report;
    }
    /// false where A is too near singular for this one.
    bool try_follower(Follower& follower, const ConstVectorRef& b, const ConstVectorRef& c, ContactPoint point,
                      ContactReport& report) const {
        try {
            if (!follower.prepared) follower.prepared = prepare_as(follower.strategy, A_, B_);
            report = follower.prepared->solve(b, c, point);
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

    /// The first that follows and has a factor of A becomes the strategy in use.
    void change_to_factor() {
        const std::string_view reason = std::exchange(change_, {});
        record_.reset();
        while (!rest_.empty()) {
            Follower next = std::move(rest_.front());
            rest_.erase(rest_.begin());
            try {
                current_ = next.prepared ? std::move(next.prepared) : prepare_as(next.strategy, A_, B_);
                choice_ = {next.strategy, reason};
                return;
            } catch (const NumericalError&) {}
        }
    }

    /// Whether what was chosen and what follows it take A too.
    bool can_stay(const Matrix& A) const {
        const bool same_kind = !A_.sparse() == !A.sparse() && !A_.dense() == !A.dense();
        return same_kind && A.rows() == A_.rows() && A.cols() == A_.cols() && A.all_finite() &&
               A.is_symmetric() == A_.is_symmetric();
    }

    Matrix A_, B_;
    StrategyChoice choice_;
    std::string broken_;
    Prepared current_;
    std::vector<Follower> rest_;
    std::string_view change_;       // why the next solve is the factor's, or nothing
    std::optional<Record> record_;  // nothing once the choice is final
};

/// The strategy chosen for A and B, and those that follow it.
Prepared prepare_chosen(const Matrix& A, const Matrix& B, const AutomaticOptions& options) {
    StrategyChoice choice = first_choice(A, B, options);
    Prepared first;
    try {
        first = prepare_choice(choice, A, B);
    } catch (const NumericalError&) {
        if (options.always || !A.is_symmetric() || choice.strategy == Strategy::floating ||
            !allowed(options, Strategy::floating))
            throw;
        choice = {Strategy::floating, "A is singular or nearly so"};
        return std::make_unique<PreparedAutomatic>(A, B, choice, prepare_as(choice.strategy, A, B),
                                                   std::vector<Strategy>{}, std::nullopt);
    }
    const std::vector<Strategy> rest = followers(choice, A, B, options);
    std::optional<Record> record;
    if (facts_of(choice.strategy).patience > 0 && !rest.empty() && rest.front() == Strategy::schur)
        record.emplace(B.rows(), options.solves_before_factor);
    return std::make_unique<PreparedAutomatic>(A, B, choice, std::move(first), rest, std::move(record));
}

}  // namespace

std::unique_ptr<PreparedContact> AutomaticContact::prepare(const Matrix& A_as_stored, const Matrix& B) const {
    check_contact_matrices("AutomaticContact", A_as_stored, B);
    if (has_empty_rows(B)) return prepare_without_empty_rows(*this, A_as_stored, B);
    const Matrix A = options_.always ? A_as_stored : diagonal_if_it_is_one(A_as_stored);
    return prepare_merged(A, B, [&](const Matrix&, const Matrix& rows) {
        return prepare_renumbered(A, rows, [&](const Matrix& A_renumbered, const Matrix& B_renumbered) {
            return prepare_chosen(A_renumbered, B_renumbered, options_);
        });
    });
}

std::unique_ptr<PreparedContact> AutomaticContact::prepare_rows(const Matrix& A, const Matrix& B) const {
    return IntervalContact(std::make_shared<AutomaticContact>(options_)).prepare(A, B);
}

}  // namespace tact
