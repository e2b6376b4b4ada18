#include "construction.hpp"

#include <algorithm>
#include <string>
#include <utility>

namespace tact {
namespace {

void check(Index p_final, int samples_final) {
    if (p_final < 1 || samples_final < 1)
        throw InputError("Construction: p_final is " + std::to_string(p_final) + " and samples_final is " +
                         std::to_string(samples_final) + ", expected at least 1 of each");
}

Construction at_selected_rows(Index p_final, int samples_final, double rows_a_mode, double compliance) {
    check(p_final, samples_final);
    Construction construction;
    construction.dual_basis = selected_rows();
    construction.compliance = compliance;
    construction.sizes = [=](int samples) {
        const Index p = std::max<Index>(1, p_final * std::min(samples, samples_final) / samples_final);
        return BasisSizes{p, std::max<Index>(1, static_cast<Index>(rows_a_mode * static_cast<double>(p)))};
    };
    return construction;
}

}  // namespace

TrainingOptions Construction::applied_to(TrainingOptions options) const {
    options.compression = compression;
    if (sizes) options.sizes = sizes;
    if (dual_basis) options.dual_basis = dual_basis;
    return options;
}

Construction march_construction(Index p_final, int samples_final) {
    constexpr double rows_a_mode = 0.5, compliance = 0.3;
    return at_selected_rows(p_final, samples_final, rows_a_mode, compliance);
}

Construction static_construction(Index p_final, int samples_final) {
    constexpr double rows_a_mode = 2;
    return at_selected_rows(p_final, samples_final, rows_a_mode, 0);
}

Construction paper_march_construction(Index p_final, int samples_final) {
    check(p_final, samples_final);
    Construction construction;
    construction.dual_basis = nnmf_basis();
    construction.sizes = [=](int samples) {
        const Index p = samples_final == 1
                            ? p_final
                            : std::max<Index>(1, paper_sizes(samples).p * p_final / paper_sizes(samples_final).p);
        return BasisSizes{p, p};
    };
    return construction;
}

Construction paper_static_construction() {
    Construction construction;
    construction.compression = Compression::none;
    return construction;
}

}  // namespace tact
