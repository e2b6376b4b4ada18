#include "lanczos.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cstdint>

namespace tact {

double SpectrumEstimate::condition() const { return smallest > 0 ? largest / smallest : infinity; }

SpectrumEstimate scaled_spectrum(const Matrix& A, int steps) {
    const Index n = A.rows();
    const Index k = std::min<Index>(steps, n);
    if (k == 0) return {};
    const Vector scale = A.main_diagonal().cwiseSqrt().cwiseInverse();
    // A fixed pseudo-random start: every eigenvector has a share in it, and the answer is always the same.
    Vector q(n);
    std::uint64_t state = 0x9e3779b97f4a7c15ULL;
    for (double& x : q) {
        state = state * 6364136223846793005ULL + 1442695040888963407ULL;
        x = static_cast<double>(state >> 11) * 0x1p-53 - 0.5;
    }
    q.normalize();
    // Three terms without reorthogonalisation: copies of extreme values that have converged change no extreme.
    Vector before = Vector::Zero(n), scaled(n), work(n), alpha(k), beta(k);
    Index made = 0;
    for (Index j = 0; j < k; ++j) {
        scaled = scale.cwiseProduct(q);
        A.multiply(scaled, work);
        work = work.cwiseProduct(scale);
        if (j > 0) work -= beta[j - 1] * before;
        alpha[j] = q.dot(work);
        work -= alpha[j] * q;
        beta[j] = work.norm();
        made = j + 1;
        if (!(beta[j] > 1e-13)) break;
        before.swap(q);
        q = work / beta[j];
    }
    Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> ritz;
    ritz.computeFromTridiagonal(alpha.head(made), beta.head(std::max<Index>(made - 1, 0)), Eigen::EigenvaluesOnly);
    return {ritz.eigenvalues().minCoeff(), ritz.eigenvalues().maxCoeff()};
}

}  // namespace tact
