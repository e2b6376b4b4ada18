#include "tact/contact/automatic.hpp"

#include <functional>
#include <vector>

#include "tact/contact/colour_sor.hpp"
#include "tact/contact/dense/dense_contact.hpp"
#include "tact/contact/dense/orthogonal_contact.hpp"
#include "tact/contact/interior_point.hpp"
#include "tact/contact/klu_active_set.hpp"
#include "tact/contact/principal_pivoting.hpp"
#include "tact/contact/projected_cg.hpp"
#include "tact/contact/proximal_contact.hpp"
#include "tact/contact/rows.hpp"
#include "tact/contact/schur_contact.hpp"
#include "tact/lib/sparse/lanczos.hpp"

namespace tact {
namespace {

constexpr Index small_size = 300;
/// Up to here some 20 sweeps or CG iterations reach rounding: less than a factor's back-substitutions cost.
constexpr double well_conditioned = 20;

constexpr Index largest_orthogonal = 4000;

/// The first strategy, then the sturdier ones in turn until one reaches a residual of 1e-12, each prepared when it is
/// first needed.
class Chain final : public PreparedContact {
public:
    using Link = std::function<std::unique_ptr<PreparedContact>()>;
    Chain(std::unique_ptr<PreparedContact> first, std::vector<Link> rest) : rest_(std::move(rest)) {
        links_.push_back(std::move(first));
    }

    bool reads_guess() const override { return links_.front()->reads_guess(); }

    ContactReport solve(const ConstVectorRef& b, const ConstVectorRef& c, ContactPoint point) override {
        ContactReport report = links_.front()->solve(b, c, point);
        for (std::size_t next = 1; !settled(report) && next <= rest_.size() && b.allFinite(); ++next) {
            if (links_.size() == next) links_.push_back(rest_[next - 1]());
            ContactReport end = links_[next]->solve(b, c, point);
            // An answer that is only not sharp enough stands if the sturdier strategy has none.
            if (report.outcome == Outcome::converged && end.outcome != Outcome::converged) break;
            end.fallback = end.fallback.empty() ? end.strategy : end.fallback;
            end.strategy = report.strategy;
            end.iterations += report.iterations;
            end.set_repeated |= report.set_repeated;
            report = std::move(end);
        }
        return report;
    }

private:
    static bool settled(const ContactReport& report) {
        return report.outcome == Outcome::converged && report.kkt.largest() <= 1e-12;
    }
    std::vector<std::unique_ptr<PreparedContact>> links_;
    std::vector<Link> rest_;
};

std::unique_ptr<PreparedContact> first_choice(const Matrix& A, const Matrix& B, bool& schur) {
    if ((!A.sparse() || A.rows() <= small_size) && B.rows() <= 4 * small_size) return DenseContact().prepare(A, B);
    const ConstraintRows rows(B);
    if ((A.main_diagonal().array() > 0).all() && B.rows() > 0 && (rows.bounds() || rows.disjoint()) &&
        scaled_spectrum(A).condition() <= well_conditioned) {
        const ColourSor sor;
        const ProjectedCg cg;
        const ContactSolver& solver = rows.bounds() ? static_cast<const ContactSolver&>(sor) : cg;
        return solver.prepare(A, B);
    }
    if (!rows.bounds() && !rows.disjoint() && 4 * B.rows() >= A.rows() && (A.main_diagonal().array() > 0).all())
        return InteriorPoint().prepare(A, B);
    schur = true;
    return SchurContact().prepare(A, B);
}

}  // namespace

std::unique_ptr<PreparedContact> AutomaticContact::prepare(const Matrix& A, const Matrix& B) const {
    check_contact_matrices("AutomaticContact", A, B);
    const bool medium = A.rows() <= largest_orthogonal;
    std::vector<Chain::Link> rest;
    if (!A.is_symmetric()) {
        if (B.rows() > 0 && B.rows() <= largest_orthogonal)
            rest.push_back([A, B] { return PrincipalPivoting().prepare(A, B); });
        return std::make_unique<Chain>(KluActiveSet().prepare(A, B), std::move(rest));
    }
    std::unique_ptr<PreparedContact> first;
    bool schur = false;
    try {
        first = first_choice(A, B, schur);
    } catch (const NumericalError&) {
        if (B.rows() == 0) throw;  // nothing there that could hold it
        // Singular, or nearly: what contact does not hold is found out by the proximal iteration.
        const std::shared_ptr<const ContactSolver> inner =
            medium ? std::shared_ptr<const ContactSolver>(std::make_shared<OrthogonalContact>())
                   : std::make_shared<SchurContact>();
        return ProximalContact(inner).prepare(A, B);
    }
    if (!schur && !medium) rest.push_back([A, B] { return SchurContact().prepare(A, B); });
    if (medium) rest.push_back([A, B] { return OrthogonalContact().prepare(A, B); });
    if (rest.empty()) return first;
    return std::make_unique<Chain>(std::move(first), std::move(rest));
}

}  // namespace tact
