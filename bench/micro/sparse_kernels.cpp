// The kernels a full step is made of: products, sweeps and certificates of the dynamic membrane and the plates.
#include <benchmark/benchmark.h>

#include "../../contact/strategies/colour_sweeps.hpp"
#include "../../lib/kkt.hpp"
#include "../../lib/scenes/membrane.hpp"
#include "../../lib/scenes/plates.hpp"

namespace {

using namespace tact;

struct StageProblem {
    Matrix A, B;
    Vector c;
};

StageProblem membrane() {
    const double a = 1.5 / 0.005;
    const ContactProblem p = MembraneFamily(200, Motion::dynamic).at(Eigen::Vector2d(0.6, 0.6));
    return {combine(a * a, *p.M, 1, p.K), p.B, p.c.at(0)};
}

StageProblem plates() {
    const double a = 1.5 / 2e-4;
    const ContactProblem p = two_plates(100).problem;
    return {combine(a * a, *p.M, 1, p.K), p.B, p.c.at(0)};
}

void product_by_eigen(benchmark::State& state) {
    using Rows = Eigen::SparseMatrix<double, Eigen::RowMajor, int>;
    const Rows A = membrane().A.to_sparse();
    const Vector x = Vector::Ones(A.cols());
    Vector y(A.rows());
    for (auto _ : state) {
        y.noalias() = A * x;
        benchmark::DoNotOptimize(y.data());
    }
}

template <class T> SlicedRows<T> sliced(const CompressedRows& A) {
    return SlicedRows<T>((A.rows + 15) / 16 * 16, A.longest_row(), [&](int i, const auto& add) {
        if (i >= A.rows) return;
        for (int k = A.begin(i); k < A.end(i); ++k) add(A.column_at(k), A.value_at(k));
    });
}

template <class T> void product_in_slices(benchmark::State& state) {
    const SlicedRows<T> A = sliced<T>(compressed_columns(membrane().A.to_sparse()));
    Padded<T> x, y;
    x.resize(A.slices() * SlicedRows<T>::lanes, 1);
    y.resize(A.slices() * SlicedRows<T>::lanes);
    for (auto _ : state) {
        const auto rows = A.reader();
        for (int s = 0; s < A.slices(); ++s) {
            typename SlicedRows<T>::Lanes sum;
            rows.multiply_slice(s, x.data(), sum);
            SlicedRows<T>::store(y.data() + s * SlicedRows<T>::lanes, sum);
        }
        benchmark::DoNotOptimize(y.data());
        benchmark::ClobberMemory();
    }
}

void sweep(benchmark::State& state) {
    ColourSweeps sweeps(compressed_columns(membrane().A.to_sparse()));
    for (Index i = 0; i < 40000; ++i) {
        sweeps.r[i] = 1;
        sweeps.lower[i] = -1;
    }
    for (auto _ : state) benchmark::DoNotOptimize(sweeps.sweep<false>(1.1F));
}

void certificate(benchmark::State& state, StageProblem (*stage)()) {
    const StageProblem p = stage();
    const KktCertificate certificate(p.A, p.B);
    const Vector u = Vector::Ones(p.A.rows());
    Vector lambda = Vector::Zero(p.B.rows());
    lambda.head(lambda.size() / 30).setOnes();
    for (auto _ : state) benchmark::DoNotOptimize(certificate(u, p.c, u, lambda).largest());
}

BENCHMARK(product_by_eigen)->Unit(benchmark::kMicrosecond);
BENCHMARK(product_in_slices<double>)->Unit(benchmark::kMicrosecond);
BENCHMARK(product_in_slices<float>)->Unit(benchmark::kMicrosecond);
BENCHMARK(sweep)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(certificate, membrane, membrane)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(certificate, plates, plates)->Unit(benchmark::kMicrosecond);

}  // namespace
