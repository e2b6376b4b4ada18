// One solve with a sparse Cholesky factor: CholmodSolver's own triangular solves against Eigen's, on one plate, on two and on
// the static membrane. And S = B A^-1 B' of a disc of rows: on the paths they reach against whole columns.
#include <benchmark/benchmark.h>

#include <Eigen/SparseCholesky>
#include <algorithm>

#include "../../lib/scenes/membrane.hpp"
#include "../../lib/scenes/plates.hpp"
#include "../../lib/sparse/cholmod_solver.hpp"

namespace {

using namespace tact;

/// The stage matrix of two identical plates: one factor of 10,000 unknowns, two columns a right-hand side.
Matrix plates() {
    const double a = 1.5 / 2e-4;
    const ContactProblem problem = two_plates(100).problem;
    return combine(a * a, *problem.M, 1, problem.K);
}

Matrix one_plate() {
    const Matrix A = plates();
    return Matrix(SparseMatrix(A.sparse()->topLeftCorner(A.rows() / 2, A.rows() / 2)));
}

Matrix static_membrane() {
    const MembraneFamily family(200);
    return family.at((family.lower() + family.upper()) / 2).K;
}

void ours(benchmark::State& state, Matrix (*matrix)()) {
    const Matrix A = matrix();
    const auto factor = CholmodSolver().factorize(A);
    const DenseMatrix B = DenseMatrix::Random(A.rows(), state.range(0));
    DenseMatrix X = B;
    for (auto _ : state) {
        factor->solve(X);
        benchmark::DoNotOptimize(X.data());
        state.PauseTiming();
        X = B;
        state.ResumeTiming();
    }
}

void eigen(benchmark::State& state, Matrix (*matrix)()) {
    const SparseMatrix A = matrix().to_sparse();
    const Eigen::SimplicialLLT<SparseMatrix> factor(A);
    const DenseMatrix B = DenseMatrix::Ones(A.rows(), state.range(0));
    DenseMatrix X = B;
    for (auto _ : state) {
        X = factor.solve(B);
        benchmark::DoNotOptimize(X.data());
    }
}

/// The rows of the plates' B that are nearest to the load.
SparseMatrix touched_rows(Index count) {
    const ContactProblem problem = two_plates(100).problem;
    std::vector<std::pair<double, Index>> by_distance;
    for (Index i = 0; i < 10000; ++i) {
        const double x = static_cast<double>(i % 100 + 1) / 101 - 0.3,
                     y = static_cast<double>(i / 100 + 1) / 101 - 0.4;
        by_distance.emplace_back(x * x + y * y, i);
    }
    std::sort(by_distance.begin(), by_distance.end());
    const SparseMatrix Bt = problem.B.to_sparse().transpose();
    SparseMatrix R(Bt.rows(), count);
    for (Index j = 0; j < count; ++j) R.col(j) = Bt.col(by_distance[static_cast<std::size_t>(j)].second);
    return R;
}

void compliance_on_paths(benchmark::State& state) {
    const SparseMatrix R = touched_rows(state.range(0));
    const auto factor = CholmodSolver().factorize(plates());
    DenseMatrix S(R.cols(), R.cols());
    for (auto _ : state) {
        factor->compliance(R, 0, S);
        benchmark::DoNotOptimize(S.data());
    }
}

void compliance_by_columns(benchmark::State& state) {
    const SparseMatrix R = touched_rows(state.range(0));
    const auto factor = CholmodSolver().factorize(plates());
    DenseMatrix S(R.cols(), R.cols());
    for (auto _ : state) {
        factor->Factor::compliance(R, 0, S);
        benchmark::DoNotOptimize(S.data());
    }
}

void factorize(benchmark::State& state, Matrix (*matrix)()) {
    const Matrix A = matrix();
    for (auto _ : state) benchmark::DoNotOptimize(CholmodSolver().factorize(A));
}

BENCHMARK_CAPTURE(ours, one_plate, one_plate)->Arg(1)->Arg(2)->Arg(4)->Arg(16)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(eigen, one_plate, one_plate)->Arg(1)->Arg(2)->Arg(4)->Arg(16)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(ours, plates, plates)->Arg(1)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(ours, membrane, static_membrane)->Arg(1)->Arg(2)->Arg(4)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(eigen, membrane, static_membrane)->Arg(1)->Arg(2)->Arg(4)->Unit(benchmark::kMicrosecond);
BENCHMARK(compliance_on_paths)->Arg(16)->Arg(370)->Unit(benchmark::kMicrosecond);
BENCHMARK(compliance_by_columns)->Arg(16)->Arg(370)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(factorize, plates, plates)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(factorize, membrane, static_membrane)->Unit(benchmark::kMillisecond);

}  // namespace
