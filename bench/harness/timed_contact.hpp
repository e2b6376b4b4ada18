// A contact solver that adds up what its solves take, and nothing else of a march.
#pragma once

#include <algorithm>
#include <memory>
#include <utility>

#include "../../lib/contact_solver.hpp"
#include "timing.hpp"

namespace tact::bench {

class TimedContact final : public ContactSolver {
public:
    struct Totals {
        double seconds = 0, iterations = 0, worst_kkt = 0;
        double prepare_seconds = 0;
    };
    /// `totals` must outlive it and what it prepares.
    TimedContact(std::shared_ptr<const ContactSolver> inner, Totals& totals)
        : inner_(std::move(inner)), totals_(totals) {}
    std::unique_ptr<PreparedContact> prepare(const Matrix& A, const Matrix& B) const override {
        const double start = cpu_seconds();
        auto prepared = std::make_unique<Prepared>(inner_->prepare(A, B), totals_);
        totals_.prepare_seconds += cpu_seconds() - start;
        return prepared;
    }

private:
    struct Prepared final : PreparedContact {
        Prepared(std::unique_ptr<PreparedContact> inner_, Totals& totals_)
            : inner(std::move(inner_)), totals(totals_) {}
        ContactReport solve(const ConstVectorRef& b, const ConstVectorRef& c, ContactPoint point) override {
            const double start = cpu_seconds();
            ContactReport report = inner->solve(b, c, point);
            totals.seconds += cpu_seconds() - start;
            totals.iterations += report.iterations;
            totals.worst_kkt = std::max(totals.worst_kkt, report.kkt.largest());
            return report;
        }
        bool reads_guess() const override { return inner->reads_guess(); }
        std::unique_ptr<PreparedContact> inner;
        Totals& totals;
    };
    std::shared_ptr<const ContactSolver> inner_;
    Totals& totals_;
};

}  // namespace tact::bench
