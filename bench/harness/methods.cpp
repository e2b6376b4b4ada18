#include "methods.hpp"

#include <charconv>
#include <functional>
#include <map>

#include "../../integrators/bdf2_without_jump.hpp"
#include "../../integrators/central_difference.hpp"
#include "../../integrators/moreau_jean.hpp"
#include "../../integrators/quasi_static.hpp"
#include "../../integrators/sundials/arkode.hpp"
#include "../../integrators/sundials/bdf2.hpp"
#include "../../integrators/sundials/ida.hpp"
#include "../../integrators/trapezoid.hpp"
#include "../../lib/errors.hpp"

namespace tact::bench {
namespace {

/// The options given, taken out one by one; what is left in the end has no meaning.
class Given {
public:
    Given(std::string_view name, std::string_view text) : name_(name) {
        while (!text.empty()) {
            const std::string_view item = text.substr(0, text.find(','));
            text.remove_prefix(std::min(text.size(), item.size() + 1));
            const std::size_t equals = item.find('=');
            double value = 0;
            const std::string_view number = equals < item.size() ? item.substr(equals + 1) : std::string_view();
            const auto [end, error] = std::from_chars(number.data(), number.data() + number.size(), value);
            if (error != std::errc() || end != number.data() + number.size())
                throw InputError("integrator " + name_ + ": option is \"" + std::string(item) +
                                 "\", expected NAME=NUMBER");
            values_[std::string(item.substr(0, equals))] = value;
        }
    }
    bool has(const std::string& option) const { return values_.contains(option); }
    double take(const std::string& option, double otherwise) {
        known_ += (known_.empty() ? "" : ", ") + option;
        const auto found = values_.find(option);
        if (found == values_.end()) return otherwise;
        const double value = found->second;
        values_.erase(found);
        return value;
    }
    void nothing_left() const {
        if (values_.empty()) return;
        throw InputError("integrator " + name_ + ": option is " + values_.begin()->first + ", expected " +
                         (known_.empty() ? "none" : known_));
    }

private:
    std::string name_, known_;
    std::map<std::string, double> values_;
};

std::unique_ptr<Integrator> runge_kutta(ButcherTable table, Given& given) {
    std::optional<double> restitution;
    if (given.has("e")) restitution = given.take("e", 0);
    if (!given.has("rtol") && !given.has("atol")) return std::make_unique<Arkode>(std::move(table), restitution);
    Arkode::Options options;
    options.restitution = restitution;
    options.rtol = given.take("rtol", options.rtol);
    options.atol = given.take("atol", 1e-3 * options.rtol);
    return std::make_unique<Arkode>(std::move(table), options);
}

using Make = std::function<std::unique_ptr<Integrator>(Given&)>;

const std::map<std::string, Make, std::less<>>& makers() {
    static const std::map<std::string, Make, std::less<>> all{
        {"bdf2", [](Given&) { return std::make_unique<Bdf2>(); }},
        {"bdf2-without-jump", [](Given& given) { return std::make_unique<Bdf2WithoutJump>(given.take("e", 0)); }},
        {"central-difference", [](Given& given) { return std::make_unique<CentralDifference>(given.take("e", 0)); }},
        {"trapezoid",
         [](Given& given) {
             const double rho = given.take("rho", 1);
             return std::make_unique<Trapezoid>(Trapezoid::Options{rho, given.take("e", 0)});
         }},
        {"moreau-jean",
         [](Given& given) {
             const double theta = given.take("theta", 0.5);
             return std::make_unique<MoreauJean>(MoreauJean::Options{theta, given.take("e", 0)});
         }},
        {"quasi-static", [](Given&) { return std::make_unique<QuasiStatic>(); }},
        {"ida",
         [](Given& given) {
             Ida::Options options;
             options.rtol = given.take("rtol", options.rtol);
             options.atol = given.take("atol", 1e-3 * options.rtol);
             if (given.has("e")) options.restitution = given.take("e", 0);
             options.max_order = static_cast<int>(given.take("order", options.max_order));
             return std::make_unique<Ida>(options);
         }},
        {"ida-fixed", [](Given&) { return std::make_unique<Ida>(Ida::fixed_step()); }},
        {"sdirk2", [](Given& given) { return runge_kutta(sdirk2(), given); }},
        {"tr-bdf2", [](Given& given) { return runge_kutta(tr_bdf2(), given); }},
        {"esdirk32", [](Given& given) { return runge_kutta(esdirk32(), given); }},
        {"sdirk54", [](Given& given) { return runge_kutta(sdirk54(), given); }}};
    return all;
}

}  // namespace

std::vector<std::string> integrator_names() {
    std::vector<std::string> names;
    for (const auto& [name, make] : makers()) names.push_back(name);
    return names;
}

std::unique_ptr<Integrator> integrator(std::string_view text) {
    const std::string_view name = text.substr(0, text.find(':'));
    const auto found = makers().find(name);
    if (found == makers().end()) {
        std::string names;
        for (const std::string& each : integrator_names()) names += (names.empty() ? "" : ", ") + each;
        throw InputError("integrator: name is " + std::string(name) + ", expected one of " + names);
    }
    Given given(name, text.substr(std::min(text.size(), name.size() + 1)));
    auto made = found->second(given);
    given.nothing_left();
    return made;
}

}  // namespace tact::bench
