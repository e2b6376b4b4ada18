// Whether a contact solver reads its guess may differ from one matrix to the next, and so from one step to the next.
#include <gtest/gtest.h>

#include "../../contact/dense/dense_contact.hpp"
#include "../../lib/scenes/mass_on_stop.hpp"
#include "every_integrator.hpp"

namespace tact {
namespace {

/// DenseContact, whose answers depend on no guess; from its prepared solver `from` on they say they do.
class SaysItReads final : public ContactSolver {
public:
    explicit SaysItReads(int from) : from_(from) {}
    std::unique_ptr<PreparedContact> prepare(const Matrix& A, const Matrix& B) const override {
        struct Prepared final : PreparedContact {
            Prepared(std::unique_ptr<PreparedContact> inner_, bool reads_)
                : inner(std::move(inner_)), reads(reads_) {}
            ContactReport solve(const ConstVectorRef& b, const ConstVectorRef& c, ContactPoint point) override {
                EXPECT_EQ(point.u.size(), b.size());
                return inner->solve(b, c, point);
            }
            bool reads_guess() const override { return reads; }
            std::unique_ptr<PreparedContact> inner;
            bool reads;
        };
        return std::make_unique<Prepared>(DenseContact().prepare(A, B), ++*count_ >= from_);
    }

private:
    int from_;
    std::shared_ptr<int> count_ = std::make_shared<int>(0);
};

State last_of(const Integrator& method, int from) {
    ContactWorkspace workspace(std::make_shared<SaysItReads>(from));
    const MarchReport march =
        integrate(method, mass_on_stop().problem, {0.01, 60, 0}, workspace, std::vector<Observer>{});
    EXPECT_EQ(march.outcome, Outcome::converged);
    return march.final_state;
}

TEST(Guess, WhoReadsItMayChangeBetweenSteps) {
    constexpr int never = 1'000'000;
    for (const auto& [name, method] : testing::every_integrator()) {
        const State expected = last_of(*method, never);
        for (const int from : {1, 2, 3}) {
            const State found = last_of(*method, from);
            EXPECT_LT((found.y - expected.y).lpNorm<Eigen::Infinity>(), 1e-9) << name << ", from " << from;
        }
    }
}

}  // namespace
}  // namespace tact
