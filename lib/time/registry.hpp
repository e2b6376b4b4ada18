// Integrators and contact solvers by name.
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "integrator.hpp"

namespace tact {

/// The options behind a name: "rho=0.5,e=0". They are taken out one by one; what is left in the end has no meaning.
class NamedOptions {
public:
    /// `text`: NAME=NUMBER with commas between, or empty. `what` ("integrator trapezoid") begins every message. InputError
    /// unless each number is one from its first to its last character, and no name comes twice.
    NamedOptions(std::string what, std::string_view text);

    bool has(const std::string& option) const { return values_.contains(option); }
    double number(const std::string& option, double otherwise);
    std::optional<double> number(const std::string& option);
    /// InputError unless it is a whole number that a long holds.
    long whole(const std::string& option, long otherwise);
    /// InputError unless it is 0 or 1.
    bool flag(const std::string& option, bool otherwise);
    /// InputError that names an option which nobody has asked for, the nearest of those asked for, and all of them.
    void nothing_left() const;

private:
    std::string what_;
    std::map<std::string, double> values_;
    std::vector<std::string> known_;
};

/// What makes integrators and contact solvers of texts NAME or NAME:OPTION=NUMBER,...  A value: who adds to a copy changes no
/// other. Integrator::name() of what it makes is a text that makes the same again.
class Registry {
public:
    using MakeIntegrator = std::function<Shared<Integrator>(NamedOptions& options)>;
    using MakeContact = std::function<Shared<ContactSolver>(NamedOptions& options)>;

    /// InputError if the name is empty, taken, or holds a character of ":,=".
    void add_integrator(const std::string& name, MakeIntegrator make);
    void add_contact(const std::string& name, MakeContact make);

    /// InputError for an unknown name, with the nearest one and all of them, for options likewise, and as the object's own
    /// constructor throws.
    Shared<Integrator> integrator(std::string_view text) const;
    Shared<ContactSolver> contact(std::string_view text) const;

    /// In alphabetical order.
    std::vector<std::string> integrators() const;
    std::vector<std::string> contacts() const;

private:
    std::map<std::string, MakeIntegrator, std::less<>> integrators_;
    std::map<std::string, MakeContact, std::less<>> contacts_;
};

/// The one of `names` with the fewest letters to change, add, leave out or swap with a neighbour, capitals being small ones,
/// the first of equals; empty if that takes more than half of the letters of `name`.
std::string nearest_name(std::string_view name, const std::vector<std::string>& names);

}  // namespace tact
