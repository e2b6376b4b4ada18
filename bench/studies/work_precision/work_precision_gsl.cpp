#include "work_precision_gsl.hpp"

#include <gsl/gsl_errno.h>
#include <gsl/gsl_odeiv2.h>

#include <algorithm>
#include <map>
#include <memory>

#include "../../../lib/errors.hpp"
#include "../../harness/interrupt.hpp"
#include "../../harness/timing.hpp"

namespace tact::bench {
namespace {

/// What GSL calls us with. Nothing here throws: only products of matrices.
struct Call {
    const OrdinaryProblem& problem;
    double stop_at;
    long calls = 0;
};

int derivative(double t, const double y[], double dydt[], void* given) {
    Call& call = *static_cast<Call*>(given);
    constexpr long every = 64;
    if (++call.calls % every == 0 && (interrupted() || cpu_seconds() > call.stop_at)) return GSL_EBADFUNC;
    call.problem.derivative(t, y, dydt);
    return GSL_SUCCESS;
}

int jacobian(double, const double[], double* dfdy, double dfdt[], void* given) {
    const Call& call = *static_cast<Call*>(given);
    const DenseMatrix& J = call.problem.jacobian;
    using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    Eigen::Map<RowMajor>(dfdy, J.rows(), J.cols()) = J;
    std::fill_n(dfdt, J.rows(), 0.0);  // the loads of these problems are constant
    return GSL_SUCCESS;
}

const gsl_odeiv2_step_type* step_type(const std::string& method) {
    const std::map<std::string, const gsl_odeiv2_step_type*> all{{"msbdf", gsl_odeiv2_step_msbdf},
                                                                 {"msadams", gsl_odeiv2_step_msadams},
                                                                 {"rk8pd", gsl_odeiv2_step_rk8pd},
                                                                 {"rkf45", gsl_odeiv2_step_rkf45}};
    const auto found = all.find(method);
    if (found == all.end())
        throw InputError("solve_ordinary: method is " + method + ", expected msbdf, msadams, rk8pd or rkf45");
    return found->second;
}

}  // namespace

OrdinaryProblem ordinary(const ContactProblem& problem, bool with_jacobian) {
    if (!problem.M || !problem.M->diagonal_entries() || problem.D || problem.r || problem.constraints() > 0)
        throw InputError(
            "ordinary: the problem has no diagonal M, or a D, an r or contact rows, expected M u'' = f - K u");
    const Index n = problem.size();
    const Vector inverse = problem.M->diagonal_entries()->cwiseInverse();
    const Eigen::SparseMatrix<double, Eigen::RowMajor, long> K = inverse.asDiagonal() * problem.K.to_sparse();
    OrdinaryProblem result;
    result.y0.resize(2 * n);
    result.y0 << problem.u0, problem.v0;
    if (with_jacobian) {
        result.jacobian = DenseMatrix::Zero(2 * n, 2 * n);
        result.jacobian.topRightCorner(n, n).setIdentity();
        result.jacobian.bottomLeftCorner(n, n) = -DenseMatrix(K);
    }
    if (!problem.f.constant()) throw InputError("ordinary: f depends on time, expected a constant one");
    result.derivative = [n, K, load = Vector(inverse.cwiseProduct(problem.f.at(0)))](double, const double* y,
                                                                                     double* out) {
        Eigen::Map<Vector>(out, n) = Eigen::Map<const Vector>(y + n, n);
        Eigen::Map<Vector> change(out + n, n);
        change = load;
        change.noalias() -= K * Eigen::Map<const Vector>(y, n);
    };
    return result;
}

OrdinaryRun solve_ordinary(const std::string& method, const OrdinaryProblem& problem,
                           const std::vector<double>& times, double rtol, double atol, double limit) {
    gsl_set_error_handler_off();
    Call call{problem, cpu_seconds() + limit};
    const auto size = static_cast<std::size_t>(problem.y0.size());
    gsl_odeiv2_system system{derivative, problem.jacobian.size() > 0 ? jacobian : nullptr, size, &call};
    constexpr double first_step = 1e-6;
    const std::unique_ptr<gsl_odeiv2_driver, void (*)(gsl_odeiv2_driver*)> driver(
        gsl_odeiv2_driver_alloc_y_new(&system, step_type(method), first_step, atol, rtol), gsl_odeiv2_driver_free);
    OrdinaryRun run;
    Vector y = problem.y0;
    run.y.resize(y.size(), static_cast<Index>(times.size()));
    double t = 0;
    for (std::size_t k = 0; k < times.size(); ++k) {
        const int code = gsl_odeiv2_driver_apply(driver.get(), &t, times[k], y.data());
        throw_if_interrupted();
        run.steps += static_cast<long>(driver->n);  // counted from one call to the next
        if (code != GSL_SUCCESS) {
            run.failure = cpu_seconds() > call.stop_at ? "out of time" : gsl_strerror(code);
            return run;
        }
        run.y.col(static_cast<Index>(k)) = y;
    }
    return run;
}

}  // namespace tact::bench
