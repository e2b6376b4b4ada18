#include "reduce.hpp"

#include <Eigen/Cholesky>
#include <Eigen/SVD>
#include <Eigen/SparseCore>
#include <cmath>
#include <limits>
#include <string>

#include "../../lib/errors.hpp"

namespace tact {
namespace {

/// A diagonal matrix if all else is rounding.
Matrix compress(DenseMatrix A, bool symmetric) {
    if (symmetric) A = ((A + A.transpose()) / 2).eval();
    const Vector d = A.diagonal();
    const Vector root = d.cwiseAbs().cwiseSqrt();
    const double floor = 32 * std::numeric_limits<double>::epsilon() * d.cwiseAbs().maxCoeff();
    for (Index j = 0; j < A.cols(); ++j)
        for (Index i = 0; i < A.rows(); ++i)
            if (i != j && std::abs(A(i, j)) > rounding_level * root[i] * root[j] + floor) return Matrix(std::move(A));
    if ((d.array() - 1).abs().maxCoeff() <= rounding_level) return Matrix::identity(d.size());
    return Matrix::diagonal(d);
}

Matrix project(const Matrix& A, const DenseMatrix& U) {
    return compress(U.transpose() * A.times(U), A.is_symmetric());
}

/// U_lambda' c; rows that are off must be out of reach of U_lambda, and count as zero.
AffineVector project_gap(const AffineVector& c, const DenseMatrix& U_lambda) {
    if (U_lambda.cols() == 0) return Vector(0);
    DenseMatrix modes = c.dense_modes("reduce: c");
    for (Index j = 0; j < modes.cols(); ++j)
        for (Index i = 0; i < modes.rows(); ++i) {
            if (std::isfinite(modes(i, j))) continue;
            for (Index k = 0; k < U_lambda.cols(); ++k)
                if (U_lambda(i, k) != 0)
                    throw InputError("reduce: U_lambda(" + std::to_string(i) + "," + std::to_string(k) + ") is " +
                                     shown(U_lambda(i, k)) + ", expected 0 where c is -infinity");
            modes(i, j) = 0;
        }
    return {DenseMatrix(U_lambda.transpose() * modes), c.coefficients, c.jumps};
}

AffineVector project_load(const AffineVector& f, const DenseMatrix& U) {
    if (const SparseMatrix* modes = f.sparse_modes())
        return {DenseMatrix(U.transpose() * *modes), f.coefficients, f.jumps};
    return {DenseMatrix(U.transpose() * f.dense_modes("reduce: f")), f.coefficients, f.jumps};
}

/// argmin |U q - u| in the norm of W, or in the Euclidean one where W gives none.
Vector project_state(const DenseMatrix& U, const Matrix* W, const Vector& u) {
    if (u.size() == 0) return {};
    if (u.isZero(0)) return Vector::Zero(U.cols());
    if (W && W->is_symmetric()) {
        const Eigen::LLT<DenseMatrix> llt(U.transpose() * W->times(U));
        if (llt.info() == Eigen::Success && llt.rcond() > 1e-15) return llt.solve(U.transpose() * (*W * u));
    }
    const DenseMatrix gram = U.transpose() * U;
    return gram.ldlt().solve(U.transpose() * u);
}

class ReducedFamily final : public ContactFamily {
public:
    ReducedFamily(const Shared<ContactFamily>& family, const ReducedBasis& basis)
        : family_(family), names_(family->names()), lower_(family->lower()), upper_(family->upper()) {
        const ContactProblem full = family->at((lower_ + upper_) / 2);
        if (!names_.empty() && full.constraints() > 0 && !full.c.constant())
            throw InputError("reduce: the gap of a family with parameters varies in time, expected a constant one");
        reduced_ = reduce(full, basis);
        if (names_.empty()) return;
        const DenseMatrix& U_lambda = basis.U_lambda;
        for (Index i = 0; i < U_lambda.rows(); ++i)
            if (U_lambda.cols() > 0 && (U_lambda.row(i).array() != 0).any()) touched_.push_back(i);
        const DenseMatrix touched = U_lambda(touched_, Eigen::all);
        const auto entries = static_cast<double>((touched.array() != 0).count());
        if (entries < sparse_fill * static_cast<double>(touched.size()))
            sparse_ = touched.sparseView(0, 0);
        else
            dense_ = touched;
    }

    std::vector<std::string> names() const override { return names_; }
    Parameter lower() const override { return lower_; }
    Parameter upper() const override { return upper_; }
    std::vector<std::string> varying() const override { return family_->varying(); }

    ContactProblem at(const Parameter& gamma) const override {
        ContactProblem problem = reduced_;
        if (reduced_.constraints() > 0 && !names_.empty()) problem.c = AffineVector(reduced_gap(gamma));
        return problem;
    }

    void gap(const Parameter& gamma, std::span<const Index> rows, VectorRef out) const override {
        const Vector c_r = names_.empty() ? reduced_.c.at(0) : reduced_gap(gamma);
        for (std::size_t k = 0; k < rows.size(); ++k) out[static_cast<Index>(k)] = c_r[rows[k]];
    }

private:
    Vector reduced_gap(const Parameter& gamma) const {
        Vector c(static_cast<Index>(touched_.size()));
        family_->gap(gamma, touched_, c);
        Vector c_r(reduced_.constraints());
        if (dense_.size() > 0)
            c_r.noalias() = dense_.transpose() * c;
        else
            c_r.noalias() = sparse_.transpose() * c;
        if (!c_r.allFinite()) reject_gap(c);
        return c_r;
    }

    [[noreturn]] void reject_gap(const Vector& c) const {
        for (std::size_t k = 0; k < touched_.size(); ++k)
            if (!std::isfinite(c[static_cast<Index>(k)]))
                throw InputError("reduce: the family's gap is " + shown(c[static_cast<Index>(k)]) + " in row " +
                                 std::to_string(touched_[k]) +
                                 ", expected a finite number where U_lambda is not zero");
        throw InputError("reduce: the reduced gap overflows, expected finite entries");
    }

    Shared<ContactFamily> family_;
    std::vector<std::string> names_;
    Parameter lower_, upper_;
    ContactProblem reduced_;
    static constexpr double sparse_fill = 0.25;  // below it gathering beats reading the zeros; fronts fill 5 to 10 %
    std::vector<Index> touched_;                 // rows with an entry in U_lambda
    // U_lambda on the touched rows in one of two forms, both by columns: U_lambda' c is p_lambda dot products.
    DenseMatrix dense_;
    Eigen::SparseMatrix<double, Eigen::ColMajor, int> sparse_;
};

/// U' r(U q) and U' r'(U q) U.
InternalForce project_force(const InternalForce& r, const DenseMatrix& basis) {
    struct Lifted {
        DenseMatrix U;
        Vector u, force;
    };
    const auto lifted = std::make_shared<Lifted>(Lifted{basis, Vector(basis.rows()), Vector(basis.rows())});
    InternalForce reduced;
    reduced.force = [r, lifted](const ConstVectorRef& q, VectorRef out) {
        lifted->u.noalias() = lifted->U * q;
        r.force(lifted->u, lifted->force);
        out.noalias() = lifted->U.transpose() * lifted->force;
    };
    reduced.tangent = [r, lifted](const ConstVectorRef& q) {
        lifted->u.noalias() = lifted->U * q;
        return Matrix(DenseMatrix(lifted->U.transpose() * r.tangent(lifted->u).times(lifted->U)));
    };
    if (r.energy)
        reduced.energy = [r, lifted](const ConstVectorRef& q) {
            lifted->u.noalias() = lifted->U * q;
            return r.energy(lifted->u);
        };
    return reduced;
}

/// A family of which more than the gap varies.
class ProjectedFamily final : public ContactFamily {
public:
    ProjectedFamily(const Shared<ContactFamily>& family, ReducedBasis basis)
        : family_(family), basis_(std::move(basis)) {
        validate(basis_, family->at((family->lower() + family->upper()) / 2));
    }
    std::vector<std::string> names() const override { return family_->names(); }
    Parameter lower() const override { return family_->lower(); }
    Parameter upper() const override { return family_->upper(); }
    std::vector<std::string> varying() const override { return family_->varying(); }
    Vector coefficients(const Parameter& gamma) const override { return family_->coefficients(gamma); }
    ContactProblem at(const Parameter& gamma) const override { return reduce(family_->at(gamma), basis_); }
    void gap(const Parameter& gamma, std::span<const Index> rows, VectorRef out) const override {
        const Vector c = at(gamma).c.at(0);
        for (std::size_t k = 0; k < rows.size(); ++k) out[static_cast<Index>(k)] = c[rows[k]];
    }

private:
    Shared<ContactFamily> family_;
    ReducedBasis basis_;
};

}  // namespace

ContactProblem reduce(const ContactProblem& full, const ReducedBasis& basis) {
    require_contact_rows("reduce", full);
    validate(full);
    validate(basis, full);
    const DenseMatrix& U = basis.U;
    ContactProblem reduced;
    if (full.M) reduced.M = project(*full.M, U);
    if (full.D) reduced.D = project(*full.D, U);
    reduced.K = project(full.K, U);
    const bool touches = basis.dual_size() > 0;
    reduced.B =
        touches ? Matrix(DenseMatrix(basis.U_lambda.transpose() * full.B.times(U))) : Matrix::without_rows(U.cols());
    reduced.c = project_gap(full.c, basis.U_lambda);
    reduced.f = project_load(full.f, U);
    const Matrix* inner = full.M ? &*full.M : full.D ? &*full.D : &full.K;
    reduced.u0 = project_state(U, inner, full.u0);
    if (full.second_order()) reduced.v0 = project_state(U, inner, full.v0);
    if (full.r) reduced.r = project_force(*full.r, U);
    return reduced;
}

std::unique_ptr<ContactFamily> reduce(const Shared<ContactFamily>& family, const ReducedBasis& basis) {
    if (!family) throw InputError("reduce: the family is null");
    if (!only_gap_varies(*family)) return std::make_unique<ProjectedFamily>(family, basis);
    return std::make_unique<ReducedFamily>(family, basis);
}

double inf_sup_constant(const ContactProblem& reduced) {
    if (reduced.constraints() == 0) return 1;
    if (reduced.constraints() > reduced.size()) return 0;
    const Vector sigma = Eigen::JacobiSVD<DenseMatrix>(reduced.B.to_dense()).singularValues();
    return sigma[0] > 0 ? sigma[sigma.size() - 1] / sigma[0] : 0;
}

}  // namespace tact
