#include <IpIpoptApplication.hpp>
#include <IpTNLP.hpp>
#include <algorithm>
#include <optional>

#include "../../lib/errors.hpp"
#include "../harness/interrupt.hpp"
#include "interior_point.hpp"

namespace tact::bench {
namespace {

using Ipopt::Number;
using IpIndex = Ipopt::Index;

/// IPOPT's "no bound" is anything beyond 1e19.
constexpr double no_bound = 1e20;

/// Fixed for one (A, B): triplets of the lower triangle of A, and B as bounds or as rows.
struct Structure {
    Structure(const Matrix& A_, const Matrix& B_) : A(A_.to_sparse()), B(B_.to_sparse()), certificate(A_, B_) {
        if (!A_.is_symmetric()) throw InputError("interior_point: A is " + A_.shape() + " and not symmetric");
        for (Index j = 0; j < A.outerSize(); ++j)
            for (SparseMatrix::InnerIterator it(A, j); it; ++it)
                if (it.row() >= j) lower.emplace_back(it.row(), j, it.value());
        bound_of.assign(static_cast<std::size_t>(B.rows()), -1);
        std::vector<int> entries(static_cast<std::size_t>(B.rows()), 0);
        bounds = true;
        for (Index j = 0; j < B.outerSize(); ++j)
            for (SparseMatrix::InnerIterator it(B, j); it; ++it) {
                bounds = bounds && it.value() == 1 && ++entries[static_cast<std::size_t>(it.row())] == 1;
                bound_of[static_cast<std::size_t>(it.row())] = j;
            }
    }
    IpIndex n() const { return static_cast<IpIndex>(A.rows()); }
    IpIndex m() const { return bounds ? 0 : static_cast<IpIndex>(B.rows()); }

    SparseMatrix A, B;
    KktCertificate certificate;
    std::vector<Eigen::Triplet<double, Index>> lower;
    std::vector<Index> bound_of;  ///< the unknown that a row of B bounds, where bounds
    bool bounds;
};

/// min scale (1/2 x'Ax - b'x)  s.t.  Bx >= c.
class Qp final : public Ipopt::TNLP {
public:
    Qp(const Structure& s, const ConstVectorRef& b, const ConstVectorRef& c, const ContactPoint& start)
        : s_(s), b_(b), c_(c), u(start.u), lambda(start.lambda), scale_(1), Ax_(b.size()) {
        const double largest = b.cwiseAbs().maxCoeff();
        if (largest > 0) scale_ = 1 / largest;
    }

    bool get_nlp_info(IpIndex& n, IpIndex& m, IpIndex& jacobian, IpIndex& hessian, IndexStyleEnum& style) override {
        n = s_.n();
        m = s_.m();
        jacobian = m == 0 ? 0 : static_cast<IpIndex>(s_.B.nonZeros());
        hessian = static_cast<IpIndex>(s_.lower.size());
        style = C_STYLE;
        return true;
    }
    bool get_bounds_info(IpIndex n, Number* lower, Number* upper, IpIndex m, Number* g_lower,
                         Number* g_upper) override {
        std::fill(lower, lower + n, -no_bound);
        std::fill(upper, upper + n, no_bound);
        std::fill(g_upper, g_upper + m, no_bound);
        for (Index i = 0; i < c_.size(); ++i) {
            const double c = std::max(c_[i], -no_bound);
            if (s_.bounds)
                lower[s_.bound_of[static_cast<std::size_t>(i)]] = c;
            else
                g_lower[i] = c;
        }
        return true;
    }
    bool get_starting_point(IpIndex n, bool, Number* x, bool, Number*, Number*, IpIndex, bool, Number*) override {
        std::copy_n(u.data(), n, x);
        return true;
    }
    bool eval_f(IpIndex, const Number* x, bool is_new, Number& value) override {
        product(x, is_new);
        value = scale_ * at(x).dot(0.5 * Ax_ - b_);
        return true;
    }
    bool eval_grad_f(IpIndex n, const Number* x, bool is_new, Number* gradient) override {
        product(x, is_new);
        Eigen::Map<Vector>(gradient, n) = scale_ * (Ax_ - b_);
        return true;
    }
    bool eval_g(IpIndex, const Number* x, bool is_new, IpIndex m, Number* g) override {
        moved(is_new);
        if (m > 0) Eigen::Map<Vector>(g, m) = s_.B * at(x);
        return true;
    }
    bool eval_jac_g(IpIndex, const Number*, bool is_new, IpIndex, IpIndex, IpIndex* rows, IpIndex* columns,
                    Number* values) override {
        moved(is_new);
        if (s_.bounds) return true;
        Index k = 0;
        for (Index j = 0; j < s_.B.outerSize(); ++j)
            for (SparseMatrix::InnerIterator it(s_.B, j); it; ++it, ++k) {
                if (rows) rows[k] = static_cast<IpIndex>(it.row());
                if (columns) columns[k] = static_cast<IpIndex>(j);
                if (values) values[k] = it.value();
            }
        return true;
    }
    bool eval_h(IpIndex, const Number*, bool is_new, Number factor, IpIndex, const Number*, bool, IpIndex,
                IpIndex* rows, IpIndex* columns, Number* values) override {
        moved(is_new);
        for (std::size_t k = 0; k < s_.lower.size(); ++k) {
            if (rows) rows[k] = static_cast<IpIndex>(s_.lower[k].row());
            if (columns) columns[k] = static_cast<IpIndex>(s_.lower[k].col());
            if (values) values[k] = factor * scale_ * s_.lower[k].value();
        }
        return true;
    }
    void finalize_solution(Ipopt::SolverReturn, IpIndex n, const Number* x, const Number* z, const Number*, IpIndex m,
                           const Number*, const Number* multipliers, Number, const Ipopt::IpoptData*,
                           Ipopt::IpoptCalculatedQuantities*) override {
        u = Eigen::Map<const Vector>(x, n);
        if (s_.bounds) {
            for (Index i = 0; i < lambda.size(); ++i)
                lambda[i] = z[s_.bound_of[static_cast<std::size_t>(i)]] / scale_;
        } else {
            lambda = Eigen::Map<const Vector>(multipliers, m) / -scale_;  // IPOPT's sign for a lower bound is minus
        }
    }
    bool intermediate_callback(Ipopt::AlgorithmMode, IpIndex iteration, Number, Number, Number, Number, Number,
                               Number, Number, Number, IpIndex, const Ipopt::IpoptData*,
                               Ipopt::IpoptCalculatedQuantities*) override {
        iterations = iteration;
        return !interrupted();
    }

private:
    Eigen::Map<const Vector> at(const Number* x) const { return {x, b_.size()}; }
    /// IPOPT announces a new point only to the first function it evaluates there, whichever that is.
    void moved(bool is_new) { product_is_old_ = product_is_old_ || is_new; }
    void product(const Number* x, bool is_new) {
        moved(is_new);
        if (product_is_old_) Ax_.noalias() = s_.A * at(x);
        product_is_old_ = false;
    }

    const Structure& s_;
    const ConstVectorRef b_, c_;

public:
    Vector u, lambda;
    int iterations = 0;

private:
    double scale_;
    Vector Ax_;
    bool product_is_old_ = true;
};

Outcome outcome_of(Ipopt::ApplicationReturnStatus status) {
    switch (status) {
        case Ipopt::Solve_Succeeded: return Outcome::converged;
        case Ipopt::Infeasible_Problem_Detected: return Outcome::infeasible;
        case Ipopt::Diverging_Iterates: return Outcome::unbounded;
        case Ipopt::User_Requested_Stop: return Outcome::stopped;
        case Ipopt::Maximum_Iterations_Exceeded: return Outcome::iteration_limit;
        default: return Outcome::inaccurate;
    }
}

class PreparedIpopt final : public PreparedContact {
public:
    PreparedIpopt(const Matrix& A, const Matrix& B) : structure_(A, B), application_(IpoptApplicationFactory()) {
        auto options = application_->Options();
        options->SetStringValue("sb", "yes");
        options->SetIntegerValue("print_level", 0);
        options->SetNumericValue("tol", 1e-8);
        options->SetNumericValue("bound_relax_factor", 0);
        options->SetStringValue("nlp_scaling_method", "none");  // the load is scaled to one already
        options->SetStringValue("hessian_constant", "yes");
        options->SetStringValue("jac_c_constant", "yes");
        options->SetStringValue("jac_d_constant", "yes");
        if (application_->Initialize() != Ipopt::Solve_Succeeded)
            throw NumericalError("interior_point: IPOPT does not initialise");
    }
    ContactReport solve(const ConstVectorRef& b, const ConstVectorRef& c, ContactPoint point) override {
        Ipopt::SmartPtr<Qp> qp = new Qp(structure_, b, c, point);
        ContactReport report;
        report.outcome = outcome_of(application_->OptimizeTNLP(GetRawPtr(qp)));
        report.iterations = qp->iterations;
        report.strategy = "interior point, IPOPT";
        report.kkt = structure_.certificate(b, c, qp->u, qp->lambda);
        if (report.outcome != Outcome::converged) return report;
        report.active = (qp->lambda.array() > 1e-6 * qp->lambda.maxCoeff()).count();
        point.u = qp->u;
        point.lambda = qp->lambda;
        return report;
    }
    bool reads_guess() const override { return true; }

private:
    Structure structure_;
    Ipopt::SmartPtr<Ipopt::IpoptApplication> application_;
};

class InteriorPoint final : public ContactSolver {
public:
    std::unique_ptr<PreparedContact> prepare(const Matrix& A, const Matrix& B) const override {
        return std::make_unique<PreparedIpopt>(A, B);
    }
};

}  // namespace

std::shared_ptr<const ContactSolver> interior_point() { return std::make_shared<InteriorPoint>(); }
std::string interior_point_version() { return IPOPT_VERSION; }

}  // namespace tact::bench
