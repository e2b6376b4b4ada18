#include "stability.hpp"

#include <algorithm>

#include "../../../lib/errors.hpp"
#include "../../harness/methods.hpp"
#include "../../harness/progress.hpp"
#include "stability_models.hpp"
#include "stability_row.hpp"

namespace tact::bench {
namespace {

void check_groups(const std::vector<std::string>& wanted, const std::vector<StabilityCase>& cases) {
    std::string known;
    for (const StabilityCase& each : cases)
        if (known.empty() || !known.ends_with(each.group)) known += (known.empty() ? "" : ", ") + each.group;
    for (const std::string& group : wanted)
        if (std::ranges::none_of(cases, [&](const StabilityCase& each) { return each.group == group; }))
            throw InputError("stability: group is " + group + ", expected one of " + known);
}

}  // namespace

Json run_stability(const StabilityOptions& options) {
    std::vector<StabilityCase> cases = stability_cases(options.small);
    check_groups(options.groups, cases);
    if (!options.groups.empty())
        std::erase_if(cases, [&](const StabilityCase& each) {
            return std::ranges::find(options.groups, each.group) == options.groups.end();
        });
    for (const std::string& name : options.integrators) (void)integrator(name);
    const std::vector<std::string> integrators =
        options.integrators.empty() ? stability_integrators() : options.integrators;
    Json json;
    json["study"] = "stability";
    json["size"] = options.small ? "small" : "full";
    json["machine"] = machine();
    json["rows"] = Json::array();
    const double limit = options.small ? 5 : 120;
    {
        Progress progress("hard cases", static_cast<double>(cases.size() * integrators.size()));
        for (const StabilityCase& each : cases)
            for (const std::string& name : integrators) {
                if (applies(each, name)) json["rows"].push_back(stability_row(each, name, limit));
                progress.add(1);
            }
    }
    const bool everything = options.groups.empty() && options.integrators.empty();
    json["restitution"] = everything ? restitution_rows(options.small) : Json::array();
    json["membrane"] = everything ? membrane_rows(options.small) : Json::array();
    const Json reduced = everything ? reduced_plates(options.small) : Json::object();
    for (const char* field : {"gap_sensitivity", "reduced_error"})
        json[field] = everything ? reduced[field] : Json::array();
    return json;
}

}  // namespace tact::bench
