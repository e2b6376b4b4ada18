#include "tact/lib/contact_family.hpp"

namespace tact {

void SingleProblem::gap(const Parameter&, std::span<const Index> rows, VectorRef out) const {
    for (std::size_t k = 0; k < rows.size(); ++k) out[static_cast<Index>(k)] = problem_.c.modes.row(rows[k]).sum();
}

}  // namespace tact
