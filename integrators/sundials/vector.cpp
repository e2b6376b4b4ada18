#include "tact/integrators/sundials/vector.hpp"

#include <cmath>
#include <limits>

namespace tact::sundials {
namespace {

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
realtype wrms_norm_mask(N_Vector x, N_Vector w, N_Vector id) {
    const auto n = static_cast<double>(NV_LENGTH_S(x));
    const auto masked = (map(id).array() > 0).select(map(x).cwiseProduct(map(w)), 0.0);
    return n == 0 ? 0 : std::sqrt(masked.matrix().squaredNorm() / n);
}

}  // namespace

VectorView::VectorView(const Context& context, Vector& storage)
    : vector_(N_VMake_Serial(storage.size(), storage.data(), context.get())) {
    if (!vector_) throw NumericalError("SUNDIALS: N_VMake_Serial failed");
    auto* ops = vector_->ops;
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

}  // namespace tact::sundials
