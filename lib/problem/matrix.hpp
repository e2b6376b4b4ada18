// A matrix as a value: sparse, dense or diagonal, immutable, with shared storage.
#pragma once

#include <atomic>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <variant>

#include "../types.hpp"

namespace tact {

/// An immutable matrix of one of three kinds; entries below the smallest normal number are taken as zero. Copies are
/// free; `same_storage` asks cheaply whether two matrices are one, which is how the problems of a family share factors
/// from one parameter to the next.
class Matrix {
public:
    struct Diagonal {
        Vector entries;
    };

    /// 0 x 0.
    Matrix();
    /// Any sparse matrix, compressed or not. Rows in a column need not be in order, and entries that name one place twice are
    /// summed, as SciPy does: what is stored is in order and names each place once. InputError for a row that is not there.
    /// Entries must be finite (checked by ContactProblem::validate).
    explicit Matrix(SparseMatrix entries);
    /// The same from compressed columns as other libraries hold them (SciPy's indptr, indices, data): column j has the entries
    /// starts[j] to starts[j + 1] - 1. InputError if the arrays do not fit together.
    static Matrix from_columns(Index rows, Index cols, std::span<const long> starts,
                               std::span<const long> row_indices, std::span<const double> entries);
    explicit Matrix(DenseMatrix entries);
    explicit Matrix(Diagonal diagonal);
    static Matrix diagonal(Vector entries);
    static Matrix identity(Index n);
    /// No rows, n columns: the B of a scene without contact.
    static Matrix without_rows(Index n);

    Index rows() const { return rows_; }
    Index cols() const { return cols_; }

    /// The storage if it is of this kind, else nullptr.
    const SparseMatrix* sparse() const { return std::get_if<SparseMatrix>(&storage_->entries); }
    const DenseMatrix* dense() const { return std::get_if<DenseMatrix>(&storage_->entries); }
    const Vector* diagonal_entries() const;

    bool same_storage(const Matrix& other) const { return storage_ == other.storage_; }
    /// Address of the shared storage: a key for caches, valid while any copy lives.
    const void* identity_key() const { return storage_.get(); }

    /// y = alpha A x + beta y (beta = 0 overwrites, NaN in y included).
    void multiply(const ConstVectorRef& x, VectorRef y, double alpha = 1, double beta = 0) const;
    /// y = alpha A' x + beta y.
    void multiply_transposed(const ConstVectorRef& x, VectorRef y, double alpha = 1, double beta = 0) const;
    Vector operator*(const Vector& x) const;
    /// A X for a block of columns.
    DenseMatrix times(const DenseMatrix& X) const;
    /// A' X for a block of columns.
    DenseMatrix transposed_times(const DenseMatrix& X) const;

    Vector main_diagonal() const;
    /// The same entries as a sparse matrix (a copy unless already sparse) or as a dense one.
    SparseMatrix to_sparse() const;
    DenseMatrix to_dense() const;

    bool all_finite() const;
    /// |A_ij - A_ji| <= tolerance max(|A_ij|, |A_ji|, sqrt|A_ii A_jj|): no large entry excuses another. Found out once for
    /// all copies.
    bool is_symmetric(double tolerance = 1e-12) const;
    /// "99x99 sparse", for messages.
    std::string shape() const;

private:
    struct Storage {
        std::variant<SparseMatrix, DenseMatrix, Diagonal> entries;
        /// What is_symmetric compares with its tolerance; negative: nobody has asked yet. Two threads may both find it out: they find the same.
        mutable std::atomic<double> asymmetry = -1;

        template <class Entries> explicit Storage(Entries A) : entries(std::move(A)) {}
    };
    std::shared_ptr<const Storage> storage_;
    Index rows_ = 0;
    Index cols_ = 0;
};

/// alpha A + beta B; diagonal if both are, dense if one is, else sparse. InputError if the shapes differ.
Matrix combine(double alpha, const Matrix& A, double beta, const Matrix& B);
Matrix scaled(double alpha, const Matrix& A);

}  // namespace tact
