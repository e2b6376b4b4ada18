#include "basis_recipes.hpp"

#include <string_view>
#include <utility>

namespace tact::bench {
namespace {

BasisStudyRecipe nnmf_recipe(std::string name, NnmfUpdates updates) {
    NnmfOptions options;
    options.updates = updates;
    return {std::move(name), {nnmf_basis(options)}};
}

BasisStudyRecipe random_nnmf_recipe() {
    BasisStudyRecipe recipe{"NNMF, random starts", {}};
    for (std::uint64_t seed = 1; seed <= 3; ++seed) {
        NnmfOptions options;
        options.random = RandomStarts{seed, 1};
        recipe.members.push_back(nnmf_basis(options));
    }
    return recipe;
}

std::string_view without_compliance(std::string_view name) { return name.substr(0, name.find(", compliance")); }

}  // namespace

bool BasisStudyRecipe::same_bases(const BasisStudyRecipe& other) const {
    if (swaps > 0 || other.swaps > 0) return this == &other;  // they are judged with the compliance
    return without_compliance(name) == without_compliance(other.name) && members.size() == other.members.size() &&
           dual_share == other.dual_share && supremizers == other.supremizers && bodies == other.bodies &&
           static_modes == other.static_modes;
}

const std::vector<BasisStudyRecipe>& basis_recipes() {
    static const std::vector<BasisStudyRecipe> all = [] {
        std::vector<BasisStudyRecipe> list;
        list.push_back({"NNMF", {nnmf_basis()}, 1, 0, 0, true});
        list.push_back(random_nnmf_recipe());
        list.push_back(nnmf_recipe("NNMF, multiplicative", NnmfUpdates::multiplicative));
        list.push_back(nnmf_recipe("NNMF, alternating least squares", NnmfUpdates::least_squares));
        for (const double share : {0.1, 0.2, 0.3, 0.5})
            list.push_back({"NNMF, supremizers", {nnmf_basis()}, 1 - share, share});
        list.push_back({"cone-projected greedy", {cone_projected_greedy()}});
        list.push_back({"snapshots", {snapshot_cone()}});
        list.push_back({"all snapshots", {snapshot_cone()}, std::nullopt, 0, 0, true});
        list.push_back({"selected rows", {selected_rows()}, 0.5, 0, 0, true});
        for (const double share : {1.0, 2.0, 4.0}) list.push_back({"selected rows", {selected_rows()}, share});
        list.push_back({"selected rows, supremizers", {selected_rows()}, 0.5, 0.15});
        list.push_back({"selected rows, compliance", {selected_rows()}, 0.5, 0, 0.1});
        list.push_back({"selected rows, compliance", {selected_rows()}, 0.5, 0, 0.3, true});
        list.push_back({"selected rows, compliance", {selected_rows()}, 1, 0, 0.3});
        list.push_back(
            {.name = "NNMF, a basis each body", .members = {nnmf_basis()}, .every_size = true, .bodies = true});
        list.push_back({.name = "selected rows, a basis each body",
                        .members = {selected_rows()},
                        .dual_share = 0.5,
                        .every_size = true,
                        .bodies = true});
        list.push_back(
            {.name = "NNMF, static modes", .members = {nnmf_basis()}, .every_size = true, .static_modes = 0.2});
        list.push_back({.name = "selected rows, static modes",
                        .members = {selected_rows()},
                        .dual_share = 0.5,
                        .every_size = true,
                        .static_modes = 0.2});
        for (const auto& [share, compliance] : {std::pair{0.5, 0.0}, std::pair{2.0, 0.0}, std::pair{0.5, 0.3}})
            list.push_back({.name = "selected rows, swaps",
                            .members = {selected_rows()},
                            .dual_share = share,
                            .compliance = compliance,
                            .swaps = 200});
        list.push_back({"NNMF, compliance", {nnmf_basis()}, 1, 0, 0.3, true});
        list.push_back({"touched rows", {touched_rows()}, std::nullopt});
        list.push_back({"singular vectors", {singular_vectors()}});
        return list;
    }();
    return all;
}

std::vector<std::string> basis_recipe_names() {
    std::vector<std::string> names;
    for (const BasisStudyRecipe& recipe : basis_recipes())
        if (names.empty() || names.back() != recipe.name) names.push_back(recipe.name);
    return names;
}

}  // namespace tact::bench
