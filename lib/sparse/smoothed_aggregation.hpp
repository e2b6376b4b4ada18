// A multigrid hierarchy from the matrix alone: smoothed aggregation, colour Gauss-Seidel, one cycle.
#pragma once

#include <Eigen/Cholesky>
#include <span>
#include <vector>

#include "aggregation.hpp"
#include "sliced_rows.hpp"

namespace tact {

/// Approximate inverse of a symmetric positive definite A, best where A is near an M-matrix whose slow modes are
/// locally constant (diffusion, membranes). A cycle is a V on the two finest levels and a W below. Every level is scaled to unit diagonal and kept colour by colour; numbers
/// of a level stand at `place`s, `padded` of them with zeros between the colours and `padding` around.
///
/// Unknowns may be masked: the cycle then acts as if they were fixed. On the level of the mask this is exact; coarser
/// levels feel it as springs on their diagonal (the row sums of stiffness P'EP, an upper bound of it, E the indicator
/// of the mask), so that the cycle stays symmetric positive definite and a change of the mask costs its own size.
/// Single precision: this is a preconditioner; only `residual` is in double.
/// (Vanek, Mandel, Brezina, Computing 56, 1996.)
class SmoothedAggregation {
public:
    using Floats = Eigen::VectorXf;
    static constexpr int padding = SlicedRows<float>::padding;

    /// `finest`: in any numbering, symmetric, diagonal > 0. NumericalError if a coarse operator is not positive definite.
    explicit SmoothedAggregation(CompressedRows finest);

    int levels() const { return static_cast<int>(level_.size()); }
    int size(int level) const { return of(level).size; }
    /// Length of a vector of this level, paddings included.
    int padded(int level) const { return of(level).padded + 2 * padding; }
    /// Of each unknown of the level: its index in such a vector.
    const std::vector<int>& place(int level) const { return of(level).place; }
    /// x of the level is D^1/2 u, D the diagonal: u_i = scale_i x_i.
    const std::vector<double>& scale(int level) const { return of(level).scale; }

    /// The matrix it was made for, and the unknown at an index of a vector of the finest level, -1 for none.
    const CompressedRows& finest() const { return A_; }
    int unknown(int place) const { return of(0).unknown[static_cast<std::size_t>(place - padding)]; }
    /// (b - A x)_i on the finest level, scaled, for one unknown.
    double residual(int unknown, const double* b, const double* x) const;
    /// r = b - A x on the finest level, scaled: all in double.
    void residual(const double* b, const double* x, double* r) const;
    /// r = b - A x on a level.
    void residual(int level, const float* b, const float* x, float* r) const;
    /// q = A p on a level, zero where masked, as p must be; returns p . q.
    float multiply(int level, const float* p, float* q, std::span<const int> masked) const;

    /// Masks unknowns of one level, given by their index in a vector; nothing on finer levels.
    void mask(int level, std::span<const int> masked);
    /// z ~ A^-1 r on the unmasked unknowns of the level that was masked last, zero on the masked ones.
    void cycle(const float* r, float* z) { descend(masked_level_, r, z); }

    /// From a level to the next coarser, r_coarse = P' r.
    void restrict_all(int level, const float* r, float* coarse) const;
    /// x = P x_coarse, and on the last colour what solves A x = r there.
    void prolong_all(int level, const float* coarse, const float* r, float* x) const;
    /// Bounds of a level to the next coarser: the tightest of each aggregate.
    void restrict_bounds(int level, const float* lower, const float* upper, float* coarse_lower,
                         float* coarse_upper) const;

private:
    struct Level {
        int size = 0, padded = 0;
        std::vector<int> place, unknown;  // unknown: of each place without padding, -1 between colours
        std::vector<int> first_slice;     // of each colour, and the end
        std::vector<double> scale;
        SlicedRows<float> couplings;  // A without its unit diagonal
        SlicedRows<float> prolong, restrict_swept;
        CompressedRows P, R;  // rows and columns by unknown, scaled; R = transpose of P while the hierarchy is made
        std::vector<float> row_sum;  // of |P|
        std::vector<int> aggregate;  // of each unknown, -1 if none
        Floats diagonal, inverse;    // 1 + springs, and one over it
        Floats r, x, t;              // of the cycle
    };
    const Level& of(int level) const { return level_[static_cast<std::size_t>(level)]; }
    Level& of(int level) { return level_[static_cast<std::size_t>(level)]; }

    static void order_by_colour(Level& level, const CompressedRows& A);
    void store_couplings(Level& level, const CompressedRows& A);
    static void scale_transfer(Level& level, const CompressedRows& coarse, const Aggregates& aggregates);
    static void store_transfer(Level& fine, const Level& coarse);
    void store_coarsest(const CompressedRows& A);
    void spread_springs();
    void factor_coarsest();
    void descend(int level, const float* r, float* z);
    void sweep_from_zero(int level, const float* r, float* x) const;
    void correct(int level, const float* r, float* x);
    void sweep(int level, int colour, const float* r, float* x) const;
    void hold(float* x) const;

    static constexpr int coarsest_size = 100;
    static constexpr int first_visited_twice = 2;
    static constexpr double strength = 0.08;
    static constexpr float stiffness = 0.2F;

    CompressedRows A_;
    std::vector<Level> level_;
    SlicedRows<double> finest_;  // the couplings of level 0, unless single precision holds them exactly
    Eigen::MatrixXf coarsest_, work_;
    Eigen::LLT<Eigen::MatrixXf> factor_;
    Floats dense_;
    int masked_level_ = 0;
    std::vector<int> masked_;
    std::vector<std::vector<int>> sprung_;  // per level: unknowns with springs
};

}  // namespace tact
