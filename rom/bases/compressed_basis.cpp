#include "compressed_basis.hpp"

#include <algorithm>
#include <cmath>

#include "stopwatch.hpp"

namespace tact {

CompressedBasis compressed_basis(const ContactProblem& problem, const PodAccumulator& primal,
                                 const DualSnapshots& dual, const BasisRecipe& recipe,
                                 std::function<bool(double fraction)> progress) {
    const BasisSizes sizes = recipe.sizes;
    if (sizes.p < 1 || sizes.p_lambda < 0)
        throw InputError("BasisRecipe: p is " + std::to_string(sizes.p) + " and p_lambda is " +
                         std::to_string(sizes.p_lambda) + ", expected p >= 1 and p_lambda >= 0");
    CompressedBasis result;
    ReducedBasis& basis = result.basis;
    {
        const Stopwatch watch(result.seconds_pod);
        basis.U = primal_basis(primal, sizes.p, recipe.pod_tolerance, recipe.primal);
    }
    basis.U_lambda.resize(dual.constraints(), 0);
    if (basis.U.cols() < 1) return result;
    const bool contact = sizes.p_lambda > 0 && dual.size() > 0;
    const Index enriched =
        contact ? std::lround(recipe.supremizers.share * static_cast<double>(basis.U.cols())) : Index{0};
    basis.U.conservativeResize(Eigen::NoChange, std::max<Index>(basis.U.cols() - enriched, 1));
    {
        const Stopwatch watch(result.seconds_projection);
        basis = modal_basis(problem, basis);
    }
    if (!contact) return result;
    {
        const Stopwatch watch(result.seconds_dual);
        DualBasisResult made =
            recipe.dual_basis({dual.matrix(), problem.B, basis.U, sizes.p_lambda, std::move(progress)});
        result.residuals = std::move(made.residuals);
        result.warning = std::move(made.warning);
        basis.U_lambda = std::move(made.U_lambda);
        basis.signs = made.signs;
        result.outcome = made.outcome;
    }
    if (enriched < 1 || result.outcome == Outcome::stopped) return result;
    const Stopwatch watch(result.seconds_projection);
    const DenseMatrix answers = supremizers(problem, basis.U_lambda, enriched, recipe.supremizers);
    basis.U.conservativeResize(Eigen::NoChange, basis.U.cols() + answers.cols());
    basis.U.rightCols(answers.cols()) = answers;
    basis = modal_basis(problem, basis);
    return result;
}

}  // namespace tact
