// Moreau-Jean time stepping: the yardstick of nonsmooth dynamics.
#pragma once

#include "../lib/time/integrator.hpp"

namespace tact {

/// theta-method on the free motion, contact at velocity level on the rows that u0 + h/2 v0 closes:
///   (M + h theta D + h^2 theta^2 K) v1 = M v0 + h (f_theta - K (u0 + h theta (1 - theta) v0)) + ... + B_C' P,
///   0 <= B_C v1 + e B_C v0  _|_  P >= 0,   u1 = u0 + h (1 - theta) v0 + h theta v1,   lambda = P / h.
/// Order 1 across impacts. The position may penetrate, by up to h |v| at an impact, and drifts by what the velocity level
/// leaves; the KKT residuals are those of the velocity problem. Dissipative for theta > 1/2; for e = 0 energy does not
/// grow. (Jean 1999; Acary, Brogliato 2008.)
class MoreauJean final : public Integrator {
public:
    struct Options {
        double theta = 0.5;      ///< from 1/2 to 1
        double restitution = 0;  ///< from 0 to 1
    };
    MoreauJean() : MoreauJean(Options{}) {}
    /// InputError if an option is out of its range.
    explicit MoreauJean(const Options& options);
    std::string name() const override;
    /// InputError for problems without M or with an r.
    std::unique_ptr<Run> start(const Shared<ContactProblem>& problem, const TimeGrid& grid,
                               const ContactWorkspace& workspace) const override;

private:
    Options options_;
};

}  // namespace tact
