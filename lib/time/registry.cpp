#include "registry.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>

namespace tact {
namespace {

std::string lower_case(std::string_view text) {
    std::string lower(text);
    for (char& letter : lower)
        if (letter >= 'A' && letter <= 'Z') letter = static_cast<char>(letter - 'A' + 'a');
    return lower;
}

/// Changes, insertions, deletions and swaps of neighbours that turn a into b.
std::size_t edits(std::string_view a, std::string_view b) {
    std::vector<std::size_t> before, last(b.size() + 1), now(b.size() + 1);
    for (std::size_t j = 0; j <= b.size(); ++j) last[j] = j;
    for (std::size_t i = 1; i <= a.size(); ++i) {
        now[0] = i;
        for (std::size_t j = 1; j <= b.size(); ++j) {
            const std::size_t change = a[i - 1] == b[j - 1] ? 0 : 1;
            now[j] = std::min({last[j] + 1, now[j - 1] + 1, last[j - 1] + change});
            if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
                now[j] = std::min(now[j], before[j - 2] + 1);
        }
        before = last;
        last.swap(now);
    }
    return last.back();
}

std::string listed(const std::vector<std::string>& names) {
    std::string list;
    for (const std::string& name : names) list.append(list.empty() ? "" : ", ").append(name);
    return list;
}

/// "; did you mean trapezoid?", or nothing.
std::string hint(std::string_view name, const std::vector<std::string>& names) {
    const std::string nearest = nearest_name(name, names);
    return nearest.empty() ? "" : "; did you mean " + nearest + "?";
}

template <class Makers> std::vector<std::string> keys(const Makers& makers) {
    std::vector<std::string> names;
    for (const auto& [name, make] : makers) names.push_back(name);
    return names;
}

template <class Makers> auto made(const std::string& kind, std::string_view text, const Makers& makers) {
    const std::size_t colon = text.find(':');
    const std::string_view name = text.substr(0, colon);
    const auto found = makers.find(name);
    if (found == makers.end()) {
        const std::vector<std::string> names = keys(makers);
        throw InputError(kind + ": name is \"" + std::string(name) + "\", expected one of " + listed(names) +
                         hint(name, names));
    }
    const std::string what = kind + " " + std::string(name);
    if (colon + 1 == text.size())
        throw InputError(what + ": nothing follows the colon, expected NAME=NUMBER, or no colon");
    NamedOptions options(what, colon == text.npos ? std::string_view() : text.substr(colon + 1));
    auto object = found->second(options);
    options.nothing_left();
    return object;
}

template <class Makers, class Make>
void add(const std::string& kind, Makers& makers, const std::string& name, Make make) {
    if (name.empty() || name.find_first_of(":,=") != name.npos)
        throw InputError("Registry: " + kind + " is \"" + name + "\", expected a name without any of \":,=\"");
    if (!make) throw InputError("Registry: " + kind + " " + name + " has no function that makes it, expected one");
    if (!makers.emplace(name, std::move(make)).second)
        throw InputError("Registry: " + kind + " " + name + " is there already, expected a new name");
}

}  // namespace

NamedOptions::NamedOptions(std::string what, std::string_view text) : what_(std::move(what)) {
    for (bool more = !text.empty(); more;) {
        const std::string_view item = text.substr(0, text.find(','));
        more = item.size() < text.size();
        text.remove_prefix(item.size() + (more ? 1 : 0));
        const std::size_t equals = item.find('=');
        double value = 0;
        const std::string_view number = equals < item.size() ? item.substr(equals + 1) : std::string_view();
        const auto [end, error] = std::from_chars(number.data(), number.data() + number.size(), value);
        if (equals == 0 || error != std::errc() || end != number.data() + number.size() || std::isnan(value))
            throw InputError(what_ + ": option is \"" + std::string(item) + "\", expected NAME=NUMBER");
        if (!values_.emplace(item.substr(0, equals), value).second)
            throw InputError(what_ + ": option " + std::string(item.substr(0, equals)) +
                             " comes twice, expected once");
    }
}

std::optional<double> NamedOptions::number(const std::string& option) {
    if (std::ranges::find(known_, option) == known_.end()) known_.push_back(option);
    const auto found = values_.find(option);
    if (found == values_.end()) return std::nullopt;
    const double value = found->second;
    values_.erase(found);
    return value;
}

double NamedOptions::number(const std::string& option, double otherwise) {
    return number(option).value_or(otherwise);
}

long NamedOptions::whole(const std::string& option, long otherwise) {
    const std::optional<double> value = number(option);
    if (!value) return otherwise;
    constexpr double most = 9007199254740992;  // 2^53: all whole numbers up to it are doubles
    if (!(std::abs(*value) <= most) || *value != std::round(*value))
        throw InputError(what_ + ": " + option + " is no whole number, expected one");
    return static_cast<long>(*value);
}

bool NamedOptions::flag(const std::string& option, bool otherwise) {
    const long value = whole(option, otherwise ? 1 : 0);
    if (value != 0 && value != 1)
        throw InputError(what_ + ": " + option + " is " + std::to_string(value) + ", expected 0 or 1");
    return value == 1;
}

void NamedOptions::nothing_left() const {
    if (values_.empty()) return;
    const std::string& unknown = values_.begin()->first;
    throw InputError(what_ + ": option is \"" + unknown + "\", expected " +
                     (known_.empty() ? "none" : "one of " + listed(known_)) + hint(unknown, known_));
}

void Registry::add_integrator(const std::string& name, MakeIntegrator make) {
    add("integrator", integrators_, name, std::move(make));
}
void Registry::add_contact(const std::string& name, MakeContact make) {
    add("contact solver", contacts_, name, std::move(make));
}

Shared<Integrator> Registry::integrator(std::string_view text) const {
    return made("integrator", text, integrators_);
}
Shared<ContactSolver> Registry::contact(std::string_view text) const {
    return made("contact solver", text, contacts_);
}

std::vector<std::string> Registry::integrators() const { return keys(integrators_); }
std::vector<std::string> Registry::contacts() const { return keys(contacts_); }

std::string nearest_name(std::string_view name, const std::vector<std::string>& names) {
    std::string nearest;
    std::size_t least = std::max<std::size_t>(name.size() / 2, 1) + 1;
    for (const std::string& each : names)
        if (const std::size_t distance = edits(lower_case(name), lower_case(each)); distance < least) {
            least = distance;
            nearest = each;
        }
    return nearest;
}

}  // namespace tact
