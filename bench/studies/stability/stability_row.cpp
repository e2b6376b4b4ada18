#include "stability_row.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "../../../contact/automatic.hpp"
#include "../../harness/interrupt.hpp"
#include "../../harness/isolated.hpp"
#include "../../harness/methods.hpp"

namespace tact::bench {
namespace {

constexpr long most_steps = 200'000;  // of an adaptive run; the fixed ones need what their grid says
constexpr double certified = 1e-9, admissible = 1e-9;

Matrix magnitudes(const Matrix& A) {
    SparseMatrix entries = A.to_sparse();
    entries.coeffs() = entries.coeffs().cwiseAbs().eval();
    return Matrix(std::move(entries));
}

/// Energies, gaps and finiteness of every state, kept as running extremes: a million steps leave no history. Shares no
/// code with the energy ledger.
class Watch {
public:
    explicit Watch(const ContactProblem& problem)
        : problem_(problem), K_size_(magnitudes(problem.K)), B_size_(magnitudes(problem.B)) {}

    void look(const State& state) {
        finite_ = finite_ && state.y.allFinite() && state.lambda.allFinite();
        if (!finite_) return;
        const Vector u = state.u(), v = state.v(), size = u.cwiseAbs();
        double mechanical = 0.5 * u.dot(problem_.K * u);
        if (problem_.M) mechanical += 0.5 * v.dot(*problem_.M * v);
        constexpr double epsilon = std::numeric_limits<double>::epsilon();
        rounding_ = std::max(rounding_, epsilon * size.dot(K_size_ * size));
        if (before_.size() > 0) {
            work_ += 0.5 * (load_ + problem_.f.at(state.t, Side::left)).dot(u - before_);
            most_work_ = std::max(most_work_, std::abs(work_));
            most_gain_ = std::max(most_gain_, mechanical - start_ - work_ - 64 * rounding_);
        } else {
            start_ = mechanical;
        }
        load_ = problem_.f.at(state.t, Side::right);
        before_ = u;
        if (problem_.constraints() == 0) return;
        const Vector c = problem_.c.at(state.t);
        if (state.step > 0) penetration_ = std::max(penetration_, (c - problem_.B * u).maxCoeff());  // u0 is given
        gap_size_ = std::max(gap_size_, (B_size_ * size + c.cwiseAbs()).maxCoeff());
    }

    bool finite() const { return finite_; }
    double energy_scale(double least) const { return start_ + most_work_ + least; }
    /// Beyond what u'Ku/2 is uncertain by: the strain of a far or stiff body is a small difference of large numbers.
    double most_gain() const { return most_gain_; }
    double penetration() const { return gap_size_ > 0 ? penetration_ / gap_size_ : 0; }

private:
    const ContactProblem& problem_;
    Matrix K_size_, B_size_;
    Vector before_, load_;
    bool finite_ = true;
    double start_ = 0, work_ = 0, most_work_ = 0, most_gain_ = 0, rounding_ = 0, penetration_ = 0, gap_size_ = 0;
};

MarchReport march(const Integrator& method, const ContactProblem& problem, const StabilityCase& c,
                  std::span<const Observer> observers) {
    ContactWorkspace workspace(std::make_shared<AutomaticContact>());
    return integrate(method, problem, c.grid, workspace, observers, {c.initial});
}

/// |u - reference| over max(|reference|, length), largest entries; null without a reference.
Json error_of(const StabilityCase& c, const Integrator& method, double restitution, const Vector& u) {
    Vector reference;
    if (c.twin)
        reference = march(method, *c.twin, c, {}).final_state.u();
    else if (c.exact)
        reference = c.exact(c.grid.t(c.grid.steps), restitution);
    if (reference.size() == 0) return nullptr;
    const double size = std::max(c.length, reference.lpNorm<Eigen::Infinity>());
    if (!std::isfinite(size)) return infinity;
    return (u - reference).lpNorm<Eigen::Infinity>() / size;
}

std::string judged(const StabilityCase& c, const Watch& watch, const MarchReport& report, const Json& error,
                   bool adaptive) {
    // Two adaptive runs that differ in a rounding choose other steps, and end within their tolerance of each other.
    const double error_limit = c.twin && adaptive ? 1e-2 : c.error_limit;
    if (!watch.finite()) return "wrong";
    if (c.problem.M && watch.most_gain() > c.energy_tolerance * watch.energy_scale(c.energy)) return "gains energy";
    if (report.outcome != Outcome::converged) return "honest failure";
    if (report.worst_kkt.largest() > certified) return "wrong";
    if (watch.penetration() > admissible) return "penetrates";
    return error.is_number() && !(error.get<double>() <= error_limit) ? "wrong" : "right";
}

Json run_row(const StabilityCase& c, const std::string& name) {
    const auto method = integrator(name);
    Watch watch(c.problem);
    bool out_of_steps = false;
    const std::vector<Observer> observers{[&](const State& state, const StepReport&) {
                                              watch.look(state);
                                              out_of_steps = method->adaptive() && state.step >= most_steps;
                                              return out_of_steps || !watch.finite() ? Flow::stop : Flow::proceed;
                                          },
                                          stop_on_interrupt()};
    Json row;
    try {
        const MarchReport report = march(*method, c.problem, c, observers);
        row["outcome"] = out_of_steps ? "step limit" : to_string(report.outcome);
        row["steps"] = report.accepted_steps;
        const double scale = watch.energy_scale(c.energy);
        if (c.problem.M && scale > 0 && c.energy_tolerance < infinity)
            row["energy_ratio_max"] = 1 + watch.most_gain() / scale;
        row["penetration_max"] = watch.penetration();
        row["kkt_residual_max"] = report.worst_kkt.largest();
        if (report.outcome == Outcome::converged)
            row["error"] = error_of(c, *method, restitution_of(name), report.final_state.u());
        row["judgement"] = c.rejected ? "wrong" : judged(c, watch, report, row["error"], method->adaptive());
        if (!report.last.detail.empty()) row["message"] = report.last.detail;
        // Infinity is no json number.
        if (row["error"].is_number() && !std::isfinite(row["error"].get<double>())) row["error"] = nullptr;
        if (!std::isfinite(report.worst_kkt.largest())) row["kkt_residual_max"] = nullptr;
    } catch (const InputError& error) {
        const std::string text = error.what();
        row["outcome"] = "rejected";
        row["message"] = text;
        row["judgement"] = !c.rejected                               ? "honest failure"
                           : text.find("row 0") != std::string::npos ? "right"
                                                                     : "wrong";
    } catch (const NumericalError& error) {
        row["outcome"] = "numerical error";
        row["message"] = error.what();
        row["judgement"] = "honest failure";
    }
    return row;
}

}  // namespace

std::vector<std::string> stability_integrators() {
    std::vector<std::string> all;
    for (const std::string& name : integrator_names()) {
        all.push_back(name);
        if (!std::isnan(restitution_of(name)))
            for (const char* e : {":e=0.5", ":e=1"}) all.push_back(name + e);
        if (name == "trapezoid") all.push_back("trapezoid:rho=0.3");
        const bool table = name.find("dirk") != std::string::npos || name == "tr-bdf2";
        if (table) all.push_back(name + ":rtol=1e-4");
        if (table || name == "ida") all.push_back(name + ":e=0");
        if (table) all.push_back(name + ":rtol=1e-4,e=0");
    }
    return all;
}

double restitution_of(const std::string& name) {
    const std::string base = name.substr(0, name.find(':'));
    const bool always =
        base == "trapezoid" || base == "bdf2-without-jump" || base == "moreau-jean" || base == "central-difference";
    double e = always ? 0 : std::numeric_limits<double>::quiet_NaN();
    for (const char* start : {":e=", ",e="})
        if (const auto at = name.find(start); at != std::string::npos)
            std::from_chars(name.data() + at + 3, name.data() + name.size(), e);
    return e;
}

bool applies(const StabilityCase& c, const std::string& name) {
    if (c.problem.is_static() != (name == "quasi-static")) return false;
    return !c.fixed_steps || !integrator(name)->adaptive();
}

Json stability_row(const StabilityCase& c, const std::string& name, double cpu_seconds) {
    Json row;
    row["case"] = c.name;
    row["group"] = c.group;
    row["integrator"] = name;
    for (const char* field : {"outcome", "judgement", "steps", "energy_ratio_max", "penetration_max",
                              "kkt_residual_max", "error", "message"})
        row[field] = nullptr;
    const Json found = isolated([&] { return run_row(c, name); }, cpu_seconds);
    for (const auto& [field, value] : found.items())
        if (row.contains(field)) row[field] = value;
    if (row["outcome"].is_null()) {
        // Neither an outcome nor one of our errors: it crashed, or ran out of what it was given.
        row["message"] = found["error"];
        const bool time = row["message"].get<std::string>().starts_with("out of time");
        row["outcome"] = time ? "out of time" : "crashed";
        row["judgement"] = time ? "out of time" : "wrong";
        row["error"] = nullptr;
    }
    return row;
}

}  // namespace tact::bench
