#include "tact/lib/matrix.hpp"

#include <cmath>

#include "tact/lib/errors.hpp"

namespace tact {
namespace {

template <class... F> struct Overload : F... { using F::operator()...; };
template <class... F> Overload(F...) -> Overload<F...>;

void start_result(VectorRef y, double beta) {
    if (beta == 0)
        y.setZero();
    else if (beta != 1)
        y *= beta;
}

void add_product(const SparseMatrix& A, const ConstVectorRef& x, VectorRef y, double alpha) {
    const auto* outer = A.outerIndexPtr();
    const auto* inner = A.innerIndexPtr();
    const double* value = A.valuePtr();
    for (Index j = 0; j < A.outerSize(); ++j) {
        const double xj = alpha * x[j];
        for (auto k = outer[j]; k < outer[j + 1]; ++k) y[inner[k]] += value[k] * xj;
    }
}

void add_transposed_product(const SparseMatrix& A, const ConstVectorRef& x, VectorRef y, double alpha) {
    const auto* outer = A.outerIndexPtr();
    const auto* inner = A.innerIndexPtr();
    const double* value = A.valuePtr();
    for (Index j = 0; j < A.outerSize(); ++j) {
        double sum = 0;
        for (auto k = outer[j]; k < outer[j + 1]; ++k) sum += value[k] * x[inner[k]];
        y[j] += alpha * sum;
    }
}

}  // namespace

Matrix::Matrix() : Matrix(SparseMatrix(0, 0)) {}

Matrix::Matrix(SparseMatrix entries) : rows_(entries.rows()), cols_(entries.cols()) {
    entries.makeCompressed();
    storage_ = std::make_shared<const Storage>(std::move(entries));
}

Matrix::Matrix(DenseMatrix entries) : rows_(entries.rows()), cols_(entries.cols()) {
    storage_ = std::make_shared<const Storage>(std::move(entries));
}

Matrix::Matrix(Diagonal diagonal) : rows_(diagonal.entries.size()), cols_(diagonal.entries.size()) {
    storage_ = std::make_shared<const Storage>(std::move(diagonal));
}

Matrix Matrix::diagonal(Vector entries) { return Matrix(Diagonal{std::move(entries)}); }
Matrix Matrix::identity(Index n) { return diagonal(Vector::Ones(n)); }
Matrix Matrix::without_rows(Index n) { return Matrix(SparseMatrix(0, n)); }

const Vector* Matrix::diagonal_entries() const {
    const auto* d = std::get_if<Diagonal>(storage_.get());
    return d ? &d->entries : nullptr;
}

void Matrix::multiply(const ConstVectorRef& x, VectorRef y, double alpha, double beta) const {
    std::visit(Overload{[&](const SparseMatrix& A) {
                            start_result(y, beta);
                            add_product(A, x, y, alpha);
                        },
                        [&](const DenseMatrix& A) {
                            start_result(y, beta);
                            y.noalias() += alpha * (A * x);
                        },
                        [&](const Diagonal& d) {
                            if (beta == 0)
                                y = alpha * d.entries.cwiseProduct(x);
                            else
                                y = beta * y + alpha * d.entries.cwiseProduct(x);
                        }},
               *storage_);
}

void Matrix::multiply_transposed(const ConstVectorRef& x, VectorRef y, double alpha, double beta) const {
    std::visit(Overload{[&](const SparseMatrix& A) {
                            start_result(y, beta);
                            add_transposed_product(A, x, y, alpha);
                        },
                        [&](const DenseMatrix& A) {
                            start_result(y, beta);
                            y.noalias() += alpha * (A.transpose() * x);
                        },
                        [&](const Diagonal&) { multiply(x, y, alpha, beta); }},
               *storage_);
}

Vector Matrix::operator*(const Vector& x) const {
    Vector y(rows());
    multiply(x, y);
    return y;
}

DenseMatrix Matrix::times(const DenseMatrix& X) const {
    return std::visit(Overload{[&](const Diagonal& d) -> DenseMatrix { return d.entries.asDiagonal() * X; },
                               [&](const auto& A) -> DenseMatrix { return A * X; }},
                      *storage_);
}

DenseMatrix Matrix::transposed_times(const DenseMatrix& X) const {
    return std::visit(Overload{[&](const Diagonal& d) -> DenseMatrix { return d.entries.asDiagonal() * X; },
                               [&](const auto& A) -> DenseMatrix { return A.transpose() * X; }},
                      *storage_);
}

Vector Matrix::main_diagonal() const {
    return std::visit(Overload{[](const SparseMatrix& A) -> Vector { return A.diagonal(); },
                               [](const DenseMatrix& A) -> Vector { return A.diagonal(); },
                               [](const Diagonal& d) -> Vector { return d.entries; }},
                      *storage_);
}

SparseMatrix Matrix::to_sparse() const {
    return std::visit(Overload{[](const SparseMatrix& A) { return A; },
                               [](const DenseMatrix& A) {
                                   SparseMatrix S = A.sparseView(0, 0);
                                   S.makeCompressed();
                                   return S;
                               },
                               [](const Diagonal& d) {
                                   SparseMatrix S(d.entries.size(), d.entries.size());
                                   S.reserve(Eigen::Matrix<long, Eigen::Dynamic, 1>::Ones(d.entries.size()));
                                   for (Index i = 0; i < d.entries.size(); ++i) S.insert(i, i) = d.entries[i];
                                   S.makeCompressed();
                                   return S;
                               }},
                      *storage_);
}

DenseMatrix Matrix::to_dense() const {
    return std::visit(Overload{[](const SparseMatrix& A) -> DenseMatrix { return A; },
                               [](const DenseMatrix& A) -> DenseMatrix { return A; },
                               [](const Diagonal& d) -> DenseMatrix { return d.entries.asDiagonal(); }},
                      *storage_);
}

bool Matrix::all_finite() const {
    return std::visit(Overload{[](const SparseMatrix& A) {
                                   return Eigen::Map<const Vector>(A.valuePtr(), A.nonZeros()).allFinite();
                               },
                               [](const DenseMatrix& A) { return A.allFinite(); },
                               [](const Diagonal& d) { return d.entries.allFinite(); }},
                      *storage_);
}

bool Matrix::is_symmetric(double tolerance) const {
    if (rows_ != cols_) return false;
    return std::visit(
        Overload{[&](const SparseMatrix& A) {
                     if (A.nonZeros() == 0) return true;
                     const SparseMatrix At = A.transpose();
                     const SparseMatrix skew = A - At;
                     const auto largest = [](const SparseMatrix& S) {
                         return S.nonZeros() == 0
                                    ? 0.0
                                    : Eigen::Map<const Vector>(S.valuePtr(), S.nonZeros()).cwiseAbs().maxCoeff();
                     };
                     return largest(skew) <= tolerance * largest(A);
                 },
                 [&](const DenseMatrix& A) {
                     if (A.size() == 0) return true;
                     return (A - A.transpose()).cwiseAbs().maxCoeff() <= tolerance * A.cwiseAbs().maxCoeff();
                 },
                 [](const Diagonal&) { return true; }},
        *storage_);
}

std::string Matrix::shape() const {
    const char* kinds[] = {"sparse", "dense", "diagonal"};
    return std::to_string(rows_) + "x" + std::to_string(cols_) + " " + kinds[storage_->index()];
}

Matrix combine(double alpha, const Matrix& A, double beta, const Matrix& B) {
    if (A.rows() != B.rows() || A.cols() != B.cols())
        throw InputError("combine: second matrix is " + B.shape() + ", expected the first one's " + A.shape());
    if (A.diagonal_entries() && B.diagonal_entries())
        return Matrix::diagonal(alpha * *A.diagonal_entries() + beta * *B.diagonal_entries());
    if (A.dense() || B.dense()) return Matrix(DenseMatrix(alpha * A.to_dense() + beta * B.to_dense()));
    return Matrix(SparseMatrix(alpha * A.to_sparse() + beta * B.to_sparse()));
}

Matrix scaled(double alpha, const Matrix& A) {
    if (const auto* d = A.diagonal_entries()) return Matrix::diagonal(alpha * *d);
    if (const auto* D = A.dense()) return Matrix(DenseMatrix(alpha * *D));
    return Matrix(SparseMatrix(alpha * *A.sparse()));
}

}  // namespace tact
