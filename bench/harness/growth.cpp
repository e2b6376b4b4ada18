#include "growth.hpp"

#include <algorithm>
#include <cmath>

#include "../../contact/automatic.hpp"
#include "interrupt.hpp"
#include "isolated.hpp"
#include "measure.hpp"
#include "timing.hpp"

namespace tact::bench {
namespace {

/// What a march's solves took, free and in contact.
struct StepTimes {
    double prepare = 0;
    std::vector<double> free, contact;
    Index most_active = 0;
    std::string strategy;
};

class WatchedContact final : public ContactSolver {
public:
    explicit WatchedContact(StepTimes& times) : times_(times) {}
    std::unique_ptr<PreparedContact> prepare(const Matrix& A, const Matrix& B) const override {
        struct Prepared final : PreparedContact {
            Prepared(std::unique_ptr<PreparedContact> inner_, StepTimes& times_)
                : inner(std::move(inner_)), times(times_) {}
            ContactReport solve(const ConstVectorRef& b, const ConstVectorRef& c, ContactPoint point) override {
                const double start = cpu_seconds();
                ContactReport report = inner->solve(b, c, point);
                (report.active > 0 ? times.contact : times.free).push_back(cpu_seconds() - start);
                times.most_active = std::max(times.most_active, report.active);
                times.strategy = report.strategy;
                return report;
            }
            bool reads_guess() const override { return inner->reads_guess(); }
            std::unique_ptr<PreparedContact> inner;
            StepTimes& times;
        };
        std::unique_ptr<PreparedContact> inner;
        times_.prepare += seconds_of([&] { inner = AutomaticContact().prepare(A, B); });
        return std::make_unique<Prepared>(std::move(inner), times_);
    }

private:
    StepTimes& times_;
};

Json null_if_empty(const std::vector<double>& values) { return values.empty() ? Json() : Json(median(values)); }

Json march(const GrowthOptions& options, Index n) {
    StudyScene scene = study_scene(options.scene, n);
    if (options.t_end > 0) scene.t_end = options.t_end;
    const ContactFamily& family = *scene.family;
    const ContactProblem problem = family.at(0.5 * (family.lower() + family.upper()));
    const Scheme scheme = paper_scheme(scene);
    StepTimes times;
    ContactWorkspace workspace(std::make_shared<WatchedContact>(times));
    const double start = cpu_seconds();
    // Ends before the limit of the process, so that what was measured until then is kept.
    const std::vector<Observer> watch{[&](const State&, const StepReport&) {
                                          return cpu_seconds() - start > 0.8 * options.limit ? Flow::stop
                                                                                             : Flow::proceed;
                                      },
                                      stop_on_interrupt()};
    const MarchReport report = integrate(*scheme.integrator, problem, scheme.grid, workspace, watch);
    Json point;
    point["n"] = n;
    point["unknowns"] = problem.size();
    point["outcome"] = to_string(report.outcome);
    point["steps"] = times.free.size() + times.contact.size();
    point["steps_asked"] = scheme.steps();
    point["contact_steps"] = times.contact.size();
    point["most_active"] = times.most_active;
    point["prepare_seconds"] = times.prepare;
    point["free_seconds"] = null_if_empty(times.free);
    point["contact_seconds"] = null_if_empty(times.contact);
    point["strategy"] = times.strategy;
    return point;
}

Json exponent_of(const Json& points, const char* field) {
    std::vector<double> x, y;
    for (const Json& point : points)
        if (point.contains(field) && point[field].is_number()) {
            x.push_back(point["unknowns"].get<double>());
            y.push_back(point[field].get<double>());
        }
    return fitted_exponent(x, y);
}

}  // namespace

Json fitted_exponent(const std::vector<double>& x, const std::vector<double>& y) {
    double n = 0, sx = 0, sy = 0, sxx = 0, sxy = 0;
    for (std::size_t k = 0; k < x.size(); ++k) {
        if (!(x[k] > 0 && y[k] > 0)) continue;
        const double a = std::log(x[k]), b = std::log(y[k]);
        n += 1, sx += a, sy += b, sxx += a * a, sxy += a * b;
    }
    const double spread_of_x = n * sxx - sx * sx;
    if (n < 2 || !(spread_of_x > 0)) return nullptr;
    return (n * sxy - sx * sy) / spread_of_x;
}

Json run_growth(const GrowthOptions& options) {
    Json growth;
    growth["scene"] = options.scene;
    growth["points"] = Json::array();
    Progress progress(options.scene + ": growth", static_cast<double>(options.sides.size()));
    for (const Index n : options.sides) {
        Json point = isolated([&] { return march(options, n); }, options.limit);
        if (point.contains("error")) point["n"] = n;
        if (point.contains("unknowns"))
            point["bytes_per_unknown"] = point["peak_bytes"].get<double>() / point["unknowns"].get<double>();
        growth["points"].push_back(std::move(point));
        progress.add(1);
    }
    growth["free_exponent"] = exponent_of(growth["points"], "free_seconds");
    growth["contact_exponent"] = exponent_of(growth["points"], "contact_seconds");
    growth["memory_exponent"] = exponent_of(growth["points"], "peak_bytes");
    return growth;
}

}  // namespace tact::bench
