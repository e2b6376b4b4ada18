// SUNDIALS' serial vectors over Eigen storage.
#pragma once

#include <nvector/nvector_serial.h>

#include <utility>

#include "tact/integrators/sundials/context.hpp"
#include "tact/lib/types.hpp"

namespace tact::sundials {

/// The entries of a serial vector.
inline Eigen::Map<Vector> map(N_Vector v) { return {NV_DATA_S(v), NV_LENGTH_S(v)}; }

/// An N_Vector that looks at an Eigen vector, which must keep its size and outlive it. The operations that integrators
/// spend their time in are Eigen's: Debian ships SUNDIALS built without optimisation. Clones inherit them.
class VectorView {
public:
    VectorView(const Context& context, Vector& storage);
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

}  // namespace tact::sundials
