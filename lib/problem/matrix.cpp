#include "matrix.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numeric>
#include <vector>

#include "../errors.hpp"

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

/// |a - b| by the larger of the two or of what their diagonal entries allow, 0/0 = 0; a NaN counts as infinity.
struct Asymmetry {
    explicit Asymmetry(Vector diagonal) : unit(diagonal.cwiseAbs().cwiseSqrt()) {}
    void add(Index i, Index j, double a, double b) {
        if (a == b) return;
        const double share = std::abs(a - b) / std::max({std::abs(a), std::abs(b), unit[i] * unit[j]});
        largest = share <= largest ? largest : std::isnan(share) ? infinity : share;
    }
    Vector unit;
    double largest = 0;
};

/// The asymmetry of a pattern that is symmetric with sorted columns, negative for any other: one pass. The columns
/// in turn meet the entries above the diagonal of every later column in that column's order, so a cursor each is
/// enough: a tenth of the cost of a transpose.
double mirrored_asymmetry(const SparseMatrix& A) {
    const auto* outer = A.outerIndexPtr();
    const auto* inner = A.innerIndexPtr();
    const double* value = A.valuePtr();
    std::vector<SparseMatrix::StorageIndex> cursor(outer, outer + A.outerSize());
    Asymmetry asymmetry(A.diagonal());
    for (Index j = 0; j < A.outerSize(); ++j) {
        auto k = cursor[static_cast<std::size_t>(j)];
        if (k < outer[j + 1] && inner[k] < j) return -1;
        if (k < outer[j + 1] && inner[k] == j) ++k;
        for (; k < outer[j + 1]; ++k) {
            const auto i = inner[k];
            const auto mirror = cursor[static_cast<std::size_t>(i)]++;
            if (i <= j || mirror >= outer[i + 1] || inner[mirror] != j) return -1;
            asymmetry.add(i, j, value[k], value[mirror]);
        }
    }
    return asymmetry.largest;
}

double asymmetry_of(const SparseMatrix& A) {
    const double mirrored = mirrored_asymmetry(A);
    if (mirrored >= 0) return mirrored;
    Asymmetry asymmetry(A.diagonal());
    const SparseMatrix transposed = A.transpose();
    const SparseMatrix skew = A - transposed;
    for (Index j = 0; j < skew.outerSize(); ++j)
        for (SparseMatrix::InnerIterator it(skew, j); it; ++it)
            if (it.value() != 0) asymmetry.add(it.row(), j, A.coeff(it.row(), j), A.coeff(j, it.row()));
    return asymmetry.largest;
}

double asymmetry_of(const DenseMatrix& A) {
    Asymmetry asymmetry(A.diagonal());
    for (Index j = 0; j < A.cols(); ++j)
        for (Index i = 0; i < j; ++i) asymmetry.add(i, j, A(i, j), A(j, i));
    return asymmetry.largest;
}

/// Where a compressed matrix stores its diagonal; empty unless it stores all of it.
std::vector<long> diagonal_places(const SparseMatrix& S) {
    const auto* outer = S.outerIndexPtr();
    const auto* inner = S.innerIndexPtr();
    std::vector<long> places(static_cast<std::size_t>(S.cols()));
    for (Index j = 0; j < S.cols(); ++j) {
        auto k = outer[j];
        while (k < outer[j + 1] && inner[k] != j) ++k;
        if (k == outer[j + 1]) return {};
        places[static_cast<std::size_t>(j)] = k;
    }
    return places;
}

/// What is too small for a normal number has lost its digits, and with them every ratio that a solver would form.
void drop_subnormal(double* entries, Index count) {
    for (Index i = 0; i < count; ++i)
        entries[i] = std::abs(entries[i]) < std::numeric_limits<double>::min() ? 0.0 : entries[i];
}

/// The entries of one column by their rows, each row once: equal ones are summed in the order they came in.
void merge_column(std::vector<std::pair<long, double>>& column) {
    std::stable_sort(column.begin(), column.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    std::size_t kept = 0;
    for (std::size_t k = 1; k < column.size(); ++k)
        if (column[k].first == column[kept].first)
            column[kept].second += column[k].second;
        else
            column[++kept] = column[k];
    column.resize(std::min(column.size(), kept + 1));
}

/// Rows in each column in order and once. One pass where they are.
void put_in_order(SparseMatrix& A) {
    auto* outer = A.outerIndexPtr();
    auto* inner = A.innerIndexPtr();
    double* value = A.valuePtr();
    bool in_order = true;
    for (Index j = 0; j < A.outerSize(); ++j)
        for (auto k = outer[j]; k < outer[j + 1]; ++k) {
            if (inner[k] < 0 || inner[k] >= A.rows())
                throw InputError("Matrix: column " + std::to_string(j) + " has an entry in row " +
                                 std::to_string(inner[k]) + ", expected 0 to " + std::to_string(A.rows() - 1));
            in_order &= k == outer[j] || inner[k - 1] < inner[k];
        }
    if (in_order) return;
    std::vector<std::pair<long, double>> column;
    long from = outer[0], kept = 0;
    for (Index j = 0; j < A.outerSize(); ++j) {
        const long end = outer[j + 1];
        column.clear();
        for (; from < end; ++from) column.emplace_back(inner[from], value[from]);
        merge_column(column);
        outer[j] = kept;
        for (const auto& [row, entry] : column) {
            inner[kept] = row;
            value[kept++] = entry;
        }
    }
    outer[A.outerSize()] = kept;
    A.resizeNonZeros(kept);
}

}  // namespace

Matrix::Matrix() : Matrix(SparseMatrix(0, 0)) {}

Matrix::Matrix(SparseMatrix entries) : rows_(entries.rows()), cols_(entries.cols()) {
    entries.makeCompressed();
    put_in_order(entries);
    drop_subnormal(entries.valuePtr(), entries.nonZeros());
    // Eigen's sparse matrices have no move constructor.
    const auto storage = std::make_shared<Storage>(SparseMatrix());
    std::get<SparseMatrix>(storage->entries).swap(entries);
    storage_ = storage;
}

Matrix Matrix::from_columns(Index rows, Index cols, std::span<const long> starts, std::span<const long> row_indices,
                            std::span<const double> entries) {
    const auto reject = [](const std::string& what) { throw InputError("Matrix: " + what); };
    if (rows < 0 || cols < 0)
        reject("the shape is " + std::to_string(rows) + "x" + std::to_string(cols) + ", expected >= 0");
    if (static_cast<Index>(starts.size()) != cols + 1)
        reject("there are " + std::to_string(starts.size()) + " starts, expected " + std::to_string(cols + 1) +
               ", one more than columns");
    if (row_indices.size() != entries.size())
        reject("there are " + std::to_string(row_indices.size()) + " row indices, expected one for each of the " +
               std::to_string(entries.size()) + " entries");
    if (starts.front() != 0 || starts.back() != static_cast<long>(entries.size()))
        reject("starts go from " + std::to_string(starts.front()) + " to " + std::to_string(starts.back()) +
               ", expected from 0 to the number of entries, " + std::to_string(entries.size()));
    if (const auto fall = std::adjacent_find(starts.begin(), starts.end(), std::greater<>()); fall != starts.end())
        reject("starts[" + std::to_string(fall - starts.begin() + 1) + "] is " + std::to_string(fall[1]) +
               ", expected at least the one before, " + std::to_string(fall[0]));
    SparseMatrix A(rows, cols);
    A.resizeNonZeros(static_cast<Index>(entries.size()));
    std::copy(starts.begin(), starts.end(), A.outerIndexPtr());
    std::copy(row_indices.begin(), row_indices.end(), A.innerIndexPtr());
    std::copy(entries.begin(), entries.end(), A.valuePtr());
    return Matrix(std::move(A));
}

Matrix::Matrix(DenseMatrix entries) : rows_(entries.rows()), cols_(entries.cols()) {
    drop_subnormal(entries.data(), entries.size());
    storage_ = std::make_shared<const Storage>(std::move(entries));
}

Matrix::Matrix(Diagonal diagonal) : rows_(diagonal.entries.size()), cols_(diagonal.entries.size()) {
    drop_subnormal(diagonal.entries.data(), diagonal.entries.size());
    storage_ = std::make_shared<const Storage>(std::move(diagonal));
}

Matrix Matrix::diagonal(Vector entries) { return Matrix(Diagonal{std::move(entries)}); }
Matrix Matrix::identity(Index n) { return diagonal(Vector::Ones(n)); }
Matrix Matrix::without_rows(Index n) { return Matrix(SparseMatrix(0, n)); }

const Vector* Matrix::diagonal_entries() const {
    const auto* d = std::get_if<Diagonal>(&storage_->entries);
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
               storage_->entries);
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
               storage_->entries);
}

Vector Matrix::operator*(const Vector& x) const {
    Vector y(rows());
    multiply(x, y);
    return y;
}

DenseMatrix Matrix::times(const DenseMatrix& X) const {
    return std::visit(Overload{[&](const Diagonal& d) -> DenseMatrix { return d.entries.asDiagonal() * X; },
                               [&](const auto& A) -> DenseMatrix { return A * X; }},
                      storage_->entries);
}

DenseMatrix Matrix::transposed_times(const DenseMatrix& X) const {
    return std::visit(Overload{[&](const Diagonal& d) -> DenseMatrix { return d.entries.asDiagonal() * X; },
                               [&](const auto& A) -> DenseMatrix { return A.transpose() * X; }},
                      storage_->entries);
}

Vector Matrix::main_diagonal() const {
    return std::visit(Overload{[](const SparseMatrix& A) -> Vector { return A.diagonal(); },
                               [](const DenseMatrix& A) -> Vector { return A.diagonal(); },
                               [](const Diagonal& d) -> Vector { return d.entries; }},
                      storage_->entries);
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
                                   S.resizeNonZeros(d.entries.size());
                                   std::copy(d.entries.begin(), d.entries.end(), S.valuePtr());
                                   std::iota(S.innerIndexPtr(), S.innerIndexPtr() + d.entries.size(), 0);
                                   std::iota(S.outerIndexPtr(), S.outerIndexPtr() + S.outerSize() + 1, 0);
                                   return S;
                               }},
                      storage_->entries);
}

DenseMatrix Matrix::to_dense() const {
    return std::visit(Overload{[](const SparseMatrix& A) -> DenseMatrix { return A; },
                               [](const DenseMatrix& A) -> DenseMatrix { return A; },
                               [](const Diagonal& d) -> DenseMatrix { return d.entries.asDiagonal(); }},
                      storage_->entries);
}

bool Matrix::all_finite() const {
    return std::visit(Overload{[](const SparseMatrix& A) {
                                   return Eigen::Map<const Vector>(A.valuePtr(), A.nonZeros()).allFinite();
                               },
                               [](const DenseMatrix& A) { return A.allFinite(); },
                               [](const Diagonal& d) { return d.entries.allFinite(); }},
                      storage_->entries);
}

bool Matrix::is_symmetric(double tolerance) const {
    if (rows_ != cols_) return false;
    double asymmetry = storage_->asymmetry.load(std::memory_order_relaxed);
    if (asymmetry < 0) {
        asymmetry = std::visit(
            Overload{[](const SparseMatrix& A) { return asymmetry_of(A); },
                     [](const DenseMatrix& A) { return asymmetry_of(A); }, [](const Diagonal&) { return 0.0; }},
            storage_->entries);
        storage_->asymmetry.store(asymmetry, std::memory_order_relaxed);
    }
    return asymmetry <= tolerance;
}

std::string Matrix::shape() const {
    const char* kinds[] = {"sparse", "dense", "diagonal"};
    return std::to_string(rows_) + "x" + std::to_string(cols_) + " " + kinds[storage_->entries.index()];
}

Matrix combine(double alpha, const Matrix& A, double beta, const Matrix& B) {
    if (A.rows() != B.rows() || A.cols() != B.cols())
        throw InputError("combine: second matrix is " + B.shape() + ", expected the first one's " + A.shape());
    if (A.diagonal_entries() && B.diagonal_entries())
        return Matrix::diagonal(alpha * *A.diagonal_entries() + beta * *B.diagonal_entries());
    if (A.dense() || B.dense()) return Matrix(DenseMatrix(alpha * A.to_dense() + beta * B.to_dense()));
    if (A.diagonal_entries() || B.diagonal_entries()) {
        const bool first = A.diagonal_entries() != nullptr;
        const SparseMatrix& S = first ? *B.sparse() : *A.sparse();
        if (const std::vector<long> places = diagonal_places(S); !places.empty()) {
            SparseMatrix sum = S;
            Eigen::Map<Vector> value(sum.valuePtr(), sum.nonZeros());
            const Vector own = value(places);
            value *= first ? beta : alpha;
            if (first)
                value(places) = alpha * *A.diagonal_entries() + beta * own;
            else
                value(places) = alpha * own + beta * *B.diagonal_entries();
            return Matrix(std::move(sum));
        }
    }
    return Matrix(SparseMatrix(alpha * A.to_sparse() + beta * B.to_sparse()));
}

Matrix scaled(double alpha, const Matrix& A) {
    if (const auto* d = A.diagonal_entries()) return Matrix::diagonal(alpha * *d);
    if (const auto* D = A.dense()) return Matrix(DenseMatrix(alpha * *D));
    return Matrix(SparseMatrix(alpha * *A.sparse()));
}

}  // namespace tact
