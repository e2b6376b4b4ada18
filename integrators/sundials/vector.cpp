#include "vector.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <memory>

namespace tact::sundials {
namespace {

/// A serial vector's content, and what else its clones take over.
struct Content : _N_VectorContent_Serial {
    Entries tested;
    Sum noted;
};

Content& content_of(N_Vector v) { return *static_cast<Content*>(v->content); }
const Entries& tested(N_Vector v) { return content_of(v).tested; }

/// A vector without operations over `data`, or over entries of its own.
N_Vector made(SUNContext context, Index size, double* data, Entries tested) {
    N_Vector v = N_VNewEmpty(context);
    if (!v) return nullptr;
    auto content = std::make_unique<Content>();
    content->length = size;
    content->own_data = data ? SUNFALSE : SUNTRUE;
    content->data = data;
    content->tested = tested;
    if (!data && size > 0) {
        content->data = static_cast<double*>(
            std::aligned_alloc(64, (sizeof(double) * static_cast<std::size_t>(size) + 63) / 64 * 64));
        if (!content->data) {
            N_VFreeEmpty(v);
            return nullptr;
        }
    }
    v->content = content.release();
    return v;
}

N_Vector clone(N_Vector w) {
    N_Vector v = made(w->sunctx, NV_LENGTH_S(w), nullptr, tested(w));
    if (v && N_VCopyOps(w, v) != 0) {
        N_VDestroy(v);
        return nullptr;
    }
    return v;
}

void destroy(N_Vector v) {
    if (!v) return;
    auto* content = static_cast<Content*>(v->content);
    if (content->own_data) std::free(content->data);
    delete content;
    v->content = nullptr;
    N_VFreeEmpty(v);
}

void linear_sum(realtype a, N_Vector x, realtype b, N_Vector y, N_Vector z) { map(z) = a * map(x) + b * map(y); }
void constant(realtype c, N_Vector z) { map(z).setConstant(c); }
void product(N_Vector x, N_Vector y, N_Vector z) { map(z) = map(x).cwiseProduct(map(y)); }
void quotient(N_Vector x, N_Vector y, N_Vector z) { map(z) = map(x).cwiseQuotient(map(y)); }
void scale(realtype c, N_Vector x, N_Vector z) { map(z) = c * map(x); }
void absolute(N_Vector x, N_Vector z) { map(z) = map(x).cwiseAbs(); }
void inverse(N_Vector x, N_Vector z) { map(z) = map(x).cwiseInverse(); }
void add_constant(N_Vector x, realtype b, N_Vector z) { map(z) = map(x).array() + b; }
realtype dot(N_Vector x, N_Vector y) { return map(x).dot(map(y)); }
realtype max_norm(N_Vector x) { return NV_LENGTH_S(x) == 0 ? 0 : map(x).cwiseAbs().maxCoeff(); }
realtype wrms_norm(N_Vector x, N_Vector w) {
    const auto n = static_cast<double>(NV_LENGTH_S(x));
    return n == 0 ? 0 : std::sqrt(map(x).cwiseProduct(map(w)).squaredNorm() / n);
}
/// The mask lets the tested entries through, whatever else it holds.
realtype wrms_norm_mask(N_Vector x, N_Vector w, N_Vector) {
    const auto n = static_cast<double>(NV_LENGTH_S(x));
    const auto [first, count] = tested(x);
    const auto weighted = map(x).segment(first, count).cwiseProduct(map(w).segment(first, count));
    return n == 0 ? 0 : std::sqrt(weighted.squaredNorm() / n);
}

int linear_combination(int count, realtype* c, N_Vector* X, N_Vector z) {
    auto sum = map(z);
    for_each_block(sum.size(), [&](Index first, Index size) {
        const auto part = [&](int k) { return map(X[k]).segment(first, size); };
        auto block = sum.segment(first, size);
        block = c[0] * part(0);
        for (int k = 1; k < count; ++k) block += c[k] * part(k);
    });
    return 0;
}
/// Z_j = a X_j + b Y_j in turn: a Z may be the X or Y of a later one.
int linear_sums(int count, realtype a, N_Vector* X, realtype b, N_Vector* Y, N_Vector* Z) {
    for_each_block(NV_LENGTH_S(Z[0]), [&](Index first, Index size) {
        const auto part = [&](N_Vector v) { return map(v).segment(first, size); };
        for (int j = 0; j < count; ++j) part(Z[j]) = a * part(X[j]) + b * part(Y[j]);
    });
    return 0;
}

}  // namespace

VectorView::VectorView(const Context& context, Vector& storage)
    : vector_(made(context.get(), storage.size(), storage.data(), {0, storage.size()})) {
    N_Vector serial = N_VNewEmpty_Serial(storage.size(), context.get());
    if (!vector_ || !serial || N_VCopyOps(serial, vector_) != 0) throw NumericalError("SUNDIALS: no vector was made");
    N_VDestroy(serial);
    auto* ops = vector_->ops;
    ops->nvclone = clone;
    ops->nvcloneempty = nullptr;
    ops->nvdestroy = destroy;
    ops->nvlinearsum = linear_sum;
    ops->nvconst = constant;
    ops->nvprod = product;
    ops->nvdiv = quotient;
    ops->nvscale = scale;
    ops->nvabs = absolute;
    ops->nvinv = inverse;
    ops->nvaddconst = add_constant;
    ops->nvdotprod = dot;
    ops->nvmaxnorm = max_norm;
    ops->nvwrmsnorm = wrms_norm;
    ops->nvwrmsnormmask = wrms_norm_mask;
}

VectorView::VectorView(const Context& context, Vector& storage, Entries tested) : VectorView(context, storage) {
    static_cast<Content*>(vector_->content)->tested = tested;
    vector_->ops->nvlinearcombination = linear_combination;
    vector_->ops->nvlinearsumvectorarray = linear_sums;
}

void Sum::evaluate(Index first, VectorRef out) const {
    const auto part = [&](std::size_t k) { return factor[k] * map(term[k]).segment(first, out.size()); };
    out = part(0);
    for (std::size_t k = 1; k < static_cast<std::size_t>(terms); ++k) out += part(k);
}

Sum noted(N_Vector vector) {
    const Sum& sum = content_of(vector).noted;
    return sum.terms > 0 ? sum : Sum{1, {1}, {vector}};
}

void note_sums(N_Vector vector) {
    vector->ops->nvlinearcombination = [](int count, realtype* c, N_Vector* X, N_Vector z) {
        if (count < 1 || count > Sum::most) return -1;
        Sum& sum = content_of(z).noted;
        sum.terms = count;
        std::copy_n(c, count, sum.factor.begin());
        std::copy_n(X, count, sum.term.begin());
        return 0;
    };
}

void drop_results(N_Vector vector) {
    auto* ops = vector->ops;
    ops->nvconst = [](realtype, N_Vector) {};
    ops->nvscale = [](realtype, N_Vector, N_Vector) {};
    ops->nvlinearsum = [](realtype, N_Vector, realtype, N_Vector, N_Vector) {};
    ops->nvlinearcombination = [](int, realtype*, N_Vector*, N_Vector) { return 0; };
}

}  // namespace tact::sundials
