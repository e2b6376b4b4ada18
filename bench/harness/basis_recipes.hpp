// The ways to make a pair of bases that the study of bases compares.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "../../rom/bases/dual_basis.hpp"

namespace tact::bench {

/// One way to make both bases from the same snapshots. An absent p_lambda share asks for all a recipe can give.
struct BasisStudyRecipe {
    std::string name;
    std::vector<DualBasis> members;        ///< seeds
    std::optional<double> dual_share = 1;  ///< p_lambda / p
    double supremizers = 0;
    double compliance = 0;
    bool every_size = false;  ///< else at the paper's size only
    bool bodies = false;      ///< a primal basis for each connected part of K
    int swaps = 0;            ///< tries, of selected rows
    double static_modes = 0;  ///< of p: the share of static modes, under the load and at selected rows

    /// Whether both make the same bases, member by member: only what runs on them differs.
    bool same_bases(const BasisStudyRecipe& other) const;
    /// Variants of the primal basis and of the rows: minutes, and not for the diagram.
    bool only_if_named() const { return bodies || swaps > 0 || static_modes > 0; }
};

const std::vector<BasisStudyRecipe>& basis_recipes();
/// Each name once.
std::vector<std::string> basis_recipe_names();

}  // namespace tact::bench
