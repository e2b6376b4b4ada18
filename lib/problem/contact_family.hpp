// A contact problem that depends on parameters gamma.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "contact_problem.hpp"

namespace tact {

using Parameter = Vector;

/// A parametrised contact problem. `at` returns problems that share the storage of whatever does not depend on
/// gamma, so that a ContactWorkspace keeps their factors from one parameter to the next.
class ContactFamily {
public:
    virtual ~ContactFamily() = default;

    /// One name a parameter, and the box the family is meant for.
    virtual std::vector<std::string> names() const = 0;
    virtual Parameter lower() const = 0;
    virtual Parameter upper() const = 0;

    virtual ContactProblem at(const Parameter& gamma) const = 0;
    /// c_i(gamma) on selected rows, without building the problem. Only for gaps constant in time.
    virtual void gap(const Parameter& gamma, std::span<const Index> rows, VectorRef out) const = 0;

    /// Which of "M", "D", "K", "B", "c", "f", "u0", "v0" depend on gamma.
    virtual std::vector<std::string> varying() const;
    /// Where it is known that every varying part but c is a sum of fixed terms with these coefficients: their values. Else
    /// empty. The terms themselves need not be told.
    virtual Vector coefficients(const Parameter& gamma) const;
};

/// Whether no part but c depends on gamma.
bool only_gap_varies(const ContactFamily& family);

/// One problem as a family without parameters.
class SingleProblem final : public ContactFamily {
public:
    explicit SingleProblem(ContactProblem problem) : problem_(std::move(problem)) {}
    std::vector<std::string> names() const override { return {}; }
    Parameter lower() const override { return {}; }
    Parameter upper() const override { return {}; }
    ContactProblem at(const Parameter&) const override { return problem_; }
    void gap(const Parameter&, std::span<const Index> rows, VectorRef out) const override;
    std::vector<std::string> varying() const override { return {}; }

private:
    ContactProblem problem_;
};

}  // namespace tact
