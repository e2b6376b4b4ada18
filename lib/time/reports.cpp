// How reports print themselves.
#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <numeric>
#include <ostream>
#include <string>
#include <vector>

#include "integrator.hpp"
#include "naming.hpp"

namespace tact {
namespace {

/// Two digits are enough for what is compared with a tolerance.
std::string rough(double x) {
    std::array<char, 32> digits{};
    return {digits.data(),
            std::to_chars(digits.data(), digits.data() + digits.size(), x, std::chars_format::general, 2).ptr};
}

std::string counted(long count, const char* thing) {
    return std::to_string(count) + " " + thing + (count == 1 ? "" : "s");
}

/// The largest residual and which of the four it is.
void print_residual(std::ostream& out, const KktResiduals& kkt) {
    const std::pair<double, const char*> all[] = {{kkt.stationarity, "stationarity"},
                                                  {kkt.penetration, "penetration"},
                                                  {kkt.negativity, "negativity"},
                                                  {kkt.complementarity, "complementarity"}};
    const double largest = kkt.largest();
    out << "largest KKT residual " << rough(largest);
    if (largest == 0) return;
    for (const auto& [value, name] : all)
        if (value == largest || std::isnan(value)) {
            out << " (" << name << ")";
            return;
        }
}

void print_residuals(std::ostream& out, const KktResiduals& kkt) {
    out << "\n  KKT residuals: stationarity " << rough(kkt.stationarity) << ", penetration " << rough(kkt.penetration)
        << ", negativity " << rough(kkt.negativity) << ", complementarity " << rough(kkt.complementarity);
}

/// The five entries of largest size, largest first: " 7 (1), 3 (-0.5)".
void print_largest(std::ostream& out, const Vector& x) {
    constexpr std::size_t most = 5;
    std::vector<Index> order(static_cast<std::size_t>(x.size()));
    std::iota(order.begin(), order.end(), Index{0});
    std::erase_if(order, [&](Index i) { return x[i] == 0; });
    const auto larger = [&](Index i, Index j) { return std::abs(x[i]) > std::abs(x[j]); };
    const std::size_t printed = std::min(most, order.size());
    std::partial_sort(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(printed), order.end(), larger);
    for (std::size_t k = 0; k < printed; ++k)
        out << (k == 0 ? " " : ", ") << order[k] << " (" << rough(x[order[k]]) << ")";
    if (order.size() > printed) out << ", and " << order.size() - printed << " more";
}

/// What the user can do; empty where there is nothing to do.
const char* advice(Outcome outcome) {
    switch (outcome) {
        case Outcome::iteration_limit:
        case Outcome::cycling: return "AutomaticContact, which goes on with other strategies; a smaller dt";
        case Outcome::infeasible: return "moving the gaps c of these rows, or switching rows off (c = -infinity)";
        case Outcome::unbounded: return "supporting the body along this motion, an M or D, or a row that stops it";
        case Outcome::inaccurate:
            return "RefinedContact around the contact solver; units that bring the entries of A closer together";
        case Outcome::step_limit: return "a larger rtol or atol, or a larger most_steps";
        case Outcome::step_too_small: return "a larger rtol or atol, or an integrator with fixed steps";
        case Outcome::tolerance_too_small: return "a larger rtol or atol";
        case Outcome::not_finite: return "a load, a gap and internal forces that are finite at this time and state";
        default: return "";
    }
}

/// The lines below the first of a solve that failed.
void print_failure(std::ostream& out, const ContactReport& report) {
    if (!report.detail.empty()) out << "\n  " << report.detail;
    if (!report.strategy.empty()) {
        out << "\n  tried: " << report.strategy;
        if (!report.reason.empty()) out << " (" << report.reason << ")";
        if (!report.fallback.empty()) out << ", then " << report.fallback;
        print_residuals(out, report.kkt);
    }
    if (report.infeasibility.size() > 0) {
        out << "\n  rows that exclude each other, with their weights:";
        print_largest(out, report.infeasibility);
    }
    if (report.ray.size() > 0) {
        out << "\n  unknowns that move without limit, with their shares:";
        print_largest(out, report.ray);
    }
}

void print_advice(std::ostream& out, Outcome outcome) {
    if (const char* what = advice(outcome); *what) out << "\n  try: " << what;
}

/// "Schur complement, 3 iterations, 2 rows in contact, largest KKT residual 1e-16 (penetration)"
void print_solve(std::ostream& out, const ContactReport& report) {
    if (!report.strategy.empty()) out << report.strategy << ", ";
    if (!report.fallback.empty()) out << "then " << report.fallback << ", ";
    out << counted(report.iterations, "iteration") << ", " << counted(report.active, "row") << " in contact, ";
    print_residual(out, report.kkt);
}

}  // namespace

std::ostream& operator<<(std::ostream& out, const ContactReport& report) {
    out << to_string(report.outcome) << ": ";
    print_solve(out, report);
    if (report.outcome == Outcome::converged) return out;
    print_failure(out, report);
    print_advice(out, report.outcome);
    return out;
}

std::ostream& operator<<(std::ostream& out, const StaticSolution& solution) {
    out << "equilibrium of " << counted(solution.u.size(), "unknown") << " and "
        << counted(solution.lambda.size(), "row") << ", ";
    return out << solution.report;
}

std::ostream& operator<<(std::ostream& out, const StepReport& report) {
    out << "step " << report.step << " to t = " << shown(report.t) << ", " << to_string(report.outcome);
    if (report.contact.outcome == Outcome::converged || !report.contact.strategy.empty()) {
        out << ": ";
        print_solve(out, report.contact);
    }
    if (report.impact) {
        out << "; impact " << to_string(report.impact->outcome) << ", ";
        print_residual(out, report.impact->kkt);
    }
    if (report.outcome == Outcome::converged) return out;
    if (!report.detail.empty()) out << "\n  " << report.detail;
    if (report.contact.outcome != Outcome::converged) print_failure(out, report.contact);
    if (report.impact && report.impact->outcome != Outcome::converged) print_failure(out, *report.impact);
    print_advice(out, report.outcome);
    return out;
}

std::ostream& operator<<(std::ostream& out, const MarchReport& report) {
    out << to_string(report.outcome) << ": " << counted(report.accepted_steps, "step")
        << " to t = " << shown(report.final_state.t) << ", ";
    if (report.first_contact_step > 0)
        out << "contact from step " << report.first_contact_step << " in at most "
            << counted(report.most_active, "row") << ", ";
    else if (report.most_active > 0)
        out << counted(report.most_active, "row") << " in contact, ";
    else
        out << "no contact, ";
    print_residual(out, report.worst_kkt);
    if (report.counters.error_failures + report.counters.stage_failures > 0)
        out << ", rejected steps: " << report.counters.error_failures << " by the error test, "
            << report.counters.stage_failures << " by their stage";
    if (!report.warning.empty()) out << "\n  warning: " << report.warning;
    if (report.outcome != Outcome::converged && report.outcome != Outcome::stopped) out << "\n  " << report.last;
    return out;
}

}  // namespace tact
