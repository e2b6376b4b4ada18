// SUNDIALS' serial vectors over Eigen storage.
#pragma once

#include <nvector/nvector_serial.h>

#include <algorithm>
#include <array>
#include <utility>

#include "../../lib/types.hpp"
#include "context.hpp"

namespace tact::sundials {

/// The entries of a serial vector.
inline Eigen::Map<Vector> map(N_Vector v) { return {NV_DATA_S(v), NV_LENGTH_S(v)}; }

/// Some entries that follow each other.
struct Entries {
    Index first = 0, count = 0;
};

/// An N_Vector that looks at an Eigen vector, which must keep its size and outlive it. The operations that integrators
/// spend their time in are Eigen's: Debian ships SUNDIALS built without optimisation. Clones inherit them.
class VectorView {
public:
    VectorView(const Context& context, Vector& storage);
    /// For vectors that come from memory: sums of several pass over it once, and norms with a mask read the `tested` entries
    /// only, whatever the mask.
    VectorView(const Context& context, Vector& storage, Entries tested);
    ~VectorView() { N_VDestroy(vector_); }
    VectorView(VectorView&& other) noexcept : vector_(std::exchange(other.vector_, nullptr)) {}
    VectorView& operator=(VectorView&& other) noexcept {
        std::swap(vector_, other.vector_);
        return *this;
    }
    N_Vector get() const { return vector_; }
    friend void swap(VectorView& a, VectorView& b) noexcept { std::swap(a.vector_, b.vector_); }

private:
    N_Vector vector_;
};

/// sum_k factor_k term_k.
struct Sum {
    static constexpr int most = 6;  ///< terms of a predictor of order 5
    int terms = 0;
    std::array<double, most> factor{};
    std::array<N_Vector, most> term{};

    /// Its entries from `first` on.
    void evaluate(Index first, VectorRef out) const;
};
/// What a vector stands for: itself, or after `note_sums` the last sum that SUNDIALS meant to write into it.
Sum noted(N_Vector vector);
/// From now on linear combinations into this vector are noted instead of formed, for those who need them in passing.
void note_sums(N_Vector vector);

/// Entries that stay in the first cache between uses.
inline constexpr Index block_size = 512;
/// Calls each(first, count) for one block after the other.
template <class Each> void for_each_block(Index size, const Each& each) {
    for (Index first = 0; first < size; first += block_size) each(first, std::min(block_size, size - first));
}

/// From now on sums, multiples and constants that SUNDIALS writes into this vector are dropped: for results that nobody
/// reads. What is written through `map` stays.
void drop_results(N_Vector vector);

}  // namespace tact::sundials
