// A program that solves one static contact problem: what it links is what statics needs.
#include <cstdio>

#include "../../contact/automatic.hpp"
#include "../../lib/time/stage.hpp"

int main() {
    constexpr int n = 1000;
    std::vector<Eigen::Triplet<double, tact::Index>> entries;
    for (int i = 0; i < n; ++i) {
        entries.emplace_back(i, i, 2);
        if (i > 0) entries.emplace_back(i, i - 1, -1), entries.emplace_back(i - 1, i, -1);
    }
    tact::SparseMatrix K(n, n);
    K.setFromTriplets(entries.begin(), entries.end());
    tact::ContactProblem chain;
    chain.K = tact::Matrix(K);
    chain.B = tact::Matrix::identity(n);
    chain.c = tact::AffineVector(tact::Vector(tact::Vector::Constant(n, -1)));
    chain.f = tact::AffineVector(tact::Vector(tact::Vector::Constant(n, -1e-4)));
    tact::ContactWorkspace workspace(std::make_shared<tact::AutomaticContact>());
    const tact::StaticSolution s = tact::solve_static(chain, workspace);
    std::printf("%d rows in contact, KKT residual %.0e\n", static_cast<int>(s.report.active), s.report.kkt.largest());
    return s.report.outcome == tact::Outcome::converged && s.report.active > 0 ? 0 : 1;
}
