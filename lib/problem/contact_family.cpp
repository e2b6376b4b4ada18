#include "contact_family.hpp"

#include <algorithm>

namespace tact {

std::vector<std::string> ContactFamily::varying() const { return {"c"}; }

Vector ContactFamily::coefficients(const Parameter&) const { return {}; }

bool only_gap_varies(const ContactFamily& family) {
    const std::vector<std::string> parts = family.varying();
    return std::all_of(parts.begin(), parts.end(), [](const std::string& part) { return part == "c"; });
}

void SingleProblem::gap(const Parameter&, std::span<const Index> rows, VectorRef out) const {
    const Vector c = problem_.c.at(0);
    for (std::size_t k = 0; k < rows.size(); ++k) out[static_cast<Index>(k)] = c[rows[k]];
}

}  // namespace tact
