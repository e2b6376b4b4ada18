#include "matrix_facts.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "../../lib/errors.hpp"
#include "../../lib/sparse/lanczos.hpp"

namespace tact {

bool MatrixFacts::well_conditioned(const Matrix& A, double limit) const {
    if (!positive_diagonal || condition_above > limit) return false;
    if (condition_below <= limit) return true;
    // Lanczos sees the small end of a spectrum after some multiple of the root of its condition.
    const int steps = static_cast<int>(std::ceil(5 * std::sqrt(std::min(limit, 1e4))));
    return scaled_spectrum(A, steps).condition() <= limit;
}

MatrixFacts matrix_facts(const Matrix& A) {
    const SparseMatrix copy = A.sparse() ? SparseMatrix() : A.to_sparse();
    const SparseMatrix& S = A.sparse() ? *A.sparse() : copy;
    const auto* outer = S.outerIndexPtr();
    const auto* inner = S.innerIndexPtr();
    const double* value = S.valuePtr();
    MatrixFacts facts;
    double diagonals = 0, sum = 0, positive = 0, couplings = 0, dominance = infinity;
    facts.positive_diagonal = S.cols() > 0;
    Index profile = 0;
    for (Index j = 0; j < S.cols(); ++j) {
        double diagonal = 0, coupled = 0, above_zero = 0;
        if (outer[j] < outer[j + 1]) profile += std::max<Index>(0, j - inner[outer[j]]);
        for (auto k = outer[j]; k < outer[j + 1]; ++k) {
            const bool off = inner[k] != j;
            diagonal += off ? 0 : value[k];
            coupled += off ? std::abs(value[k]) : 0;
            above_zero += off ? std::max(value[k], 0.0) : 0;
        }
        facts.positive_diagonal &= diagonal > 0;
        diagonals += diagonal;
        couplings += coupled;
        positive += above_zero;
        sum += diagonal - coupled + 2 * above_zero;
        dominance = std::min(dominance, (diagonal - coupled) / diagonal);
    }
    facts.narrow = profile <= S.nonZeros();
    facts.m_matrix = positive <= 1e-3 * couplings;
    facts.condition_above = sum > 0 ? std::max(1.0, diagonals / sum) : infinity;
    facts.condition_below = dominance > 0 ? (2 - dominance) / dominance : infinity;
    return facts;
}

void check_no_negative_diagonal(std::string_view solver, const Matrix& A) {
    constexpr double rounding = 1e-12;
    const Vector diagonal = A.main_diagonal();
    Index i = 0;
    if (diagonal.minCoeff(&i) < -rounding * diagonal.lpNorm<Eigen::Infinity>())
        throw InputError(std::string(solver) + ": A(" + std::to_string(i) + ", " + std::to_string(i) + ") is " +
                         shown(diagonal[i]) + ", expected a positive definite symmetric part of A");
}

}  // namespace tact
