// A contact solver that fails once: the step that meets it is reported and changes nothing, and the next one repeats it.
#include <gtest/gtest.h>

#include "../../contact/dense/dense_contact.hpp"
#include "../../lib/scenes/mass_on_stop.hpp"
#include "every_integrator.hpp"

namespace tact {
namespace {

/// Solve number `fails` of all that are prepared here has no answer; none if that is 0.
class FailsOnce final : public ContactSolver {
public:
    explicit FailsOnce(long fails) : fails_(fails) {}
    std::unique_ptr<PreparedContact> prepare(const Matrix& A, const Matrix& B) const override {
        struct Prepared final : PreparedContact {
            Prepared(std::unique_ptr<PreparedContact> inner_, long fails_, std::shared_ptr<long> count_)
                : inner(std::move(inner_)), fails(fails_), count(std::move(count_)) {}
            ContactReport solve(const ConstVectorRef& b, const ConstVectorRef& c, ContactPoint point) override {
                if (++*count != fails) return inner->solve(b, c, point);
                ContactReport report;
                report.outcome = Outcome::cycling;
                return report;
            }
            std::unique_ptr<PreparedContact> inner;
            long fails;
            std::shared_ptr<long> count;
        };
        return std::make_unique<Prepared>(DenseContact().prepare(A, B), fails_, count_);
    }
    long solves() const { return *count_; }

private:
    long fails_;
    std::shared_ptr<long> count_ = std::make_shared<long>(0);
};

testing::NamedIntegrators all_with_impact_laws() {
    testing::NamedIntegrators all = testing::every_integrator();
    Ida::Options ida;
    ida.restitution = 0;
    all.emplace_back("ida:e=0", std::make_shared<Ida>(ida));
    for (const ButcherTable& table : {sdirk2(), tr_bdf2(), esdirk32(), sdirk54()}) {
        all.emplace_back(table.name + ":e=0", std::make_shared<Arkode>(table, 0.0));
        Arkode::Options options;
        options.restitution = 0;
        all.emplace_back(table.name + ":e=0, adaptive", std::make_shared<Arkode>(table, options));
    }
    return all;
}

struct March {
    Outcome outcome = Outcome::converged;
    State last;
    int failures = 0;
    long solves = 0;
};

/// Goes on after a failure, which must have left the state as it was.
March march(const Integrator& method, const ContactProblem& problem, const TimeGrid& grid, long fails) {
    const auto solver = std::make_shared<FailsOnce>(fails);
    ContactWorkspace workspace(solver);
    std::unique_ptr<Run> run;
    try {
        run = method.start(problem, grid, workspace);
    } catch (const NumericalError&) {  // the first slope
        run = method.start(problem, grid, workspace);
    }
    const double end = grid.t(grid.steps) * (1 - 1e-12);
    March result{Outcome::converged, run->state()};
    while (run->state().t < end) {
        const State before = run->state();
        StepReport report;
        try {
            report = run->advance();
        } catch (const NumericalError&) {  // the slope after an impact, which is no step's
            ++result.failures;
            continue;
        }
        if (report.outcome == Outcome::converged) {
            EXPECT_GT(run->state().t, before.t);
            continue;
        }
        EXPECT_EQ(run->state().t, before.t);
        EXPECT_EQ(run->state().step, before.step);
        EXPECT_EQ(run->state().y, before.y);
        EXPECT_EQ(run->state().lambda, before.lambda);
        if (++result.failures == 3) {
            result.outcome = report.outcome;
            break;
        }
    }
    result.last = run->state();
    result.solves = solver->solves();
    return result;
}

TEST(FailedStep, LeavesTheStateAndIsRepeated) {
    const ContactProblem problem = mass_on_stop({.height = 0.11}).problem;  // lands within the tenth step
    const TimeGrid grid{0.05, 20};
    for (const auto& [name, method] : all_with_impact_laws()) {
        const March smooth = march(*method, problem, grid, 0);
        ASSERT_EQ(smooth.outcome, Outcome::converged) << name;
        ASSERT_EQ(smooth.failures, 0) << name;
        int failures = 0;
        for (long fails = 1; fails <= smooth.solves; fails += 1 + smooth.solves / 60) {
            const March found = march(*method, problem, grid, fails);
            ASSERT_EQ(found.outcome, Outcome::converged) << name << ", solve " << fails;
            failures += found.failures;
            if (!method->adaptive()) {
                ASSERT_LE((found.last.y - smooth.last.y).norm(), 1e-10) << name << ", solve " << fails;
            } else if (name.find("e=0") != std::string::npos) {
                ASSERT_NEAR(found.last.y[0], 0, 1e-9) << name << ", solve " << fails;
            }
        }
        if (!method->adaptive()) {
            EXPECT_GT(failures, 0) << name;
        }
    }
}

TEST(FailedStep, AnImpactThatIsNotResolvedIsMetAgainNoLater) {
    const ContactProblem problem = mass_on_stop({.height = 0.11}).problem;
    Ida::Options options;
    options.restitution = 0;
    const Ida method(options);
    const TimeGrid grid{1, 1};
    const long solves = march(method, problem, grid, 0).solves;
    int met = 0;
    for (long fails = 1; fails <= solves; ++fails) {
        ContactWorkspace workspace(std::make_shared<FailsOnce>(fails));
        std::unique_ptr<tact::Run> run;
        try {
            run = method.start(problem, grid, workspace);
        } catch (const NumericalError&) {
            continue;
        }
        while (run->state().t < 1) {
            StepReport report;
            try {
                report = run->advance();
            } catch (const NumericalError&) {
                continue;
            }
            if (report.outcome == Outcome::converged || !report.impact) continue;
            ++met;
            ASSERT_EQ(run->advance().outcome, Outcome::converged);
            EXPECT_LE(run->state().t, report.t * (1 + 1e-12));
        }
    }
    EXPECT_GT(met, 0);
}

}  // namespace
}  // namespace tact
