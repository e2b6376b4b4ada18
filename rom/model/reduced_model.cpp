#include "reduced_model.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <memory>
#include <utility>

#include "../../lib/algebra/linear_solver.hpp"
#include "reduce.hpp"

namespace tact {
namespace {

[[noreturn]] void reject(const std::string& what) { throw InputError("ReducedModel: " + what); }

std::string shape(const DenseMatrix& A) { return std::to_string(A.rows()) + "x" + std::to_string(A.cols()); }

void expect(const char* field, const DenseMatrix& A, Index rows, Index cols) {
    if (A.rows() != rows || A.cols() != cols)
        reject(std::string(field) + " is " + shape(A) + ", expected " + std::to_string(rows) + "x" +
               std::to_string(cols));
}

AffineVector::Coefficients function_of(const TimeTable& table) {
    const auto shared = std::make_shared<const TimeTable>(table);
    return [shared](double t, Side side, VectorRef out) { shared->evaluate(t, side, out); };
}

void attach(const char* field, const TimeTable& table, AffineVector& vector) {
    if (table.empty()) return;
    if (!(table.grid.dt > 0) || table.grid.steps < 0)
        reject(std::string(field) + " has a grid of " + std::to_string(table.grid.steps) + " steps of " +
               shown(table.grid.dt) + ", expected at least 0 of more than 0");
    for (const DenseMatrix* side : {&table.left, &table.right})
        expect(field, *side, vector.modes.cols(), table.grid.steps + 1);
    vector.coefficients = function_of(table);
    vector.jumps = table.jumps;
}

void expect_expansion(const char* field, const ParameterExpansion& expansion, Index size, Index parameters) {
    if (expansion.terms.rows() != size) expect(field, expansion.terms, size, expansion.terms.cols());
    if (!expansion.terms.allFinite() || !expansion.theta.coefficients.allFinite())
        reject(std::string(field) + " has a NaN or infinite entry, expected finite entries");
    if (expansion.theta.empty()) return;
    if (static_cast<Index>(expansion.theta.counts.size()) != parameters)
        reject(std::string(field) + " has counts of " + std::to_string(expansion.theta.counts.size()) +
               " parameters, expected " + std::to_string(parameters));
    expect(field, expansion.theta.lower, parameters, 1);
    expect(field, expansion.theta.upper, parameters, 1);
    Index count = 1;
    for (const Index each : expansion.theta.counts) {
        if (each < 1)
            reject(std::string(field) + " has a count of " + std::to_string(each) + ", expected at least 1");
        count *= each;
    }
    expect(field, expansion.theta.coefficients, expansion.terms.cols(), count);
}

/// The entries of a part, of `problem`, or its number of them.
Index part_size(const std::string& part, const ContactProblem& p) {
    if (part == "M" && p.M) return p.M->diagonal_entries() ? p.size() : p.size() * p.size();
    if (part == "D" && p.D) return p.D->diagonal_entries() ? p.size() : p.size() * p.size();
    if (part == "K") return p.K.diagonal_entries() ? p.size() : p.size() * p.size();
    if (part == "B") return p.B.rows() * p.B.cols();
    if (part == "f") return p.f.modes.size();
    if (part == "u0") return p.u0.size();
    if (part == "v0") return p.v0.size();
    reject("parts holds " + part + ", expected one of the problem's M, D, K, B, f, u0, v0");
}

Matrix matrix_like(const Matrix& A, const Vector& entries) {
    if (A.diagonal_entries()) return Matrix::diagonal(entries);
    return Matrix(DenseMatrix(entries.reshaped(A.rows(), A.cols())));
}

void assign(const std::string& part, const Vector& entries, ContactProblem& p) {
    if (part == "M") p.M = matrix_like(*p.M, entries);
    if (part == "D") p.D = matrix_like(*p.D, entries);
    if (part == "K") p.K = matrix_like(p.K, entries);
    if (part == "B") p.B = matrix_like(p.B, entries);
    if (part == "f") p.f.modes = entries.reshaped(p.f.modes.rows(), p.f.modes.cols());
    if (part == "u0") p.u0 = entries;
    if (part == "v0") p.v0 = entries;
}

void validate_checks(const ReducedModelData& d) {
    const ErrorChecks& checks = d.checks;
    const Index p = d.centre.size(), rows = static_cast<Index>(checks.rows.size()),
                unknowns = static_cast<Index>(checks.unknowns.size());
    if (rows > 0) {
        expect("checks.B_U", checks.B_U, rows, p);
        expect("checks.gap", checks.gap, rows, d.gap.empty() ? d.centre.c.modes.cols() : d.gap.terms.cols());
    }
    if (unknowns > 0) {
        expect("checks.K_U", checks.K_U, unknowns, p);
        if (d.centre.M) expect("checks.M_U", checks.M_U, unknowns, p);
        if (d.centre.D) expect("checks.D_U", checks.D_U, unknowns, p);
        expect("checks.load", checks.load, unknowns, d.centre.f.modes.cols());
        expect("checks.multipliers", checks.multipliers, unknowns, d.centre.constraints());
    }
    if (checks.stride < 1) reject("checks.stride is " + std::to_string(checks.stride) + ", expected at least 1");
}

}  // namespace

ReducedModel::ReducedModel(ReducedModelData data, ExactFunctions exact)
    : data_(std::move(data)), exact_(std::move(exact)) {
    ReducedModelData& d = data_;
    validate(d.centre);
    const Index parameters = static_cast<Index>(d.names.size());
    expect("lower", d.lower, parameters, 1);
    expect("upper", d.upper, parameters, 1);
    attach("load", d.load, d.centre.f);
    attach("moving", d.moving, d.centre.c);
    if (!d.gap.empty()) {
        expect_expansion("gap", d.gap, d.centre.constraints(), parameters);
        if (static_cast<Index>(d.gap_rows.size()) != d.gap.terms.cols())
            reject("gap_rows holds " + std::to_string(d.gap_rows.size()) + " rows, expected " +
                   std::to_string(d.gap.terms.cols()));
    }
    Index size = 0;
    for (const std::string& part : d.parts) size += part_size(part, d.centre);
    expect_expansion("others", d.others, size, parameters);
    if (exact_.coefficients && !d.affine)
        reject("coefficients are given, expected none: the model's other parts are not known by a family's");
    const Index quantities = static_cast<Index>(d.quantities.names.size());
    if (quantities > 0) {
        expect("quantities.Q", d.quantities.Q, quantities, d.centre.size());
        expect("quantities.Q_lambda", d.quantities.Q_lambda, quantities, d.centre.constraints());
    }
    if (d.basis.U.size() > 0) expect("basis.U", d.basis.U, d.basis.U.rows(), d.centre.size());
    validate_checks(d);
}

void ReducedModel::check(const Parameter& gamma) const {
    if (gamma.size() != data_.lower.size())
        reject("gamma is " + std::to_string(gamma.size()) + "x1, expected " + std::to_string(data_.lower.size()) +
               "x1");
    if (!gamma.allFinite()) reject("gamma has a NaN or infinite entry, expected finite entries");
}

bool ReducedModel::covers(const Parameter& gamma) const {
    // Rounding in a parameter that lies on the box's face is no excursion.
    const Vector slack = 1e-12 * (data_.upper - data_.lower);
    return ((gamma - data_.lower + slack).array() >= 0).all() && ((data_.upper - gamma + slack).array() >= 0).all();
}

Vector ReducedModel::gap_coefficients(const Parameter& gamma) const {
    if (exact_.gap) {
        Vector theta(data_.gap.terms.cols());
        exact_.gap(gamma, data_.gap_rows, theta);
        return theta;
    }
    if (data_.gap.theta.empty()) reject("the gap has no series over this box, expected a function of gamma");
    return data_.gap.theta.at(gamma);
}

Vector ReducedModel::other_coefficients(const Parameter& gamma) const {
    if (!exact_.coefficients) {
        if (data_.others.theta.empty())
            reject(data_.parts.front() + " has no series over this box, expected the family's coefficients");
        return data_.others.theta.at(gamma);
    }
    Vector theta = exact_.coefficients(gamma);
    if (theta.size() != data_.others.terms.cols())
        reject("coefficients are " + std::to_string(theta.size()) + ", expected " +
               std::to_string(data_.others.terms.cols()));
    return theta;
}

std::vector<std::string> ReducedModel::varying() const {
    std::vector<std::string> parts = data_.parts;
    if (!data_.gap.empty()) parts.emplace_back("c");
    return parts;
}

ContactProblem ReducedModel::at(const Parameter& gamma) const {
    check(gamma);
    ContactProblem problem = data_.centre;
    if (!data_.gap.empty()) problem.c.modes.noalias() = data_.gap.terms * gap_coefficients(gamma);
    if (data_.parts.empty()) return problem;
    const Vector entries = data_.others.terms * other_coefficients(gamma);
    Index from = 0;
    for (const std::string& part : data_.parts) {
        const Index size = part_size(part, problem);
        assign(part, entries.segment(from, size), problem);
        from += size;
    }
    return problem;
}

void ReducedModel::gap(const Parameter& gamma, std::span<const Index> rows, VectorRef out) const {
    check(gamma);
    const Vector c = data_.gap.empty() ? Vector(data_.centre.c.modes.rowwise().sum())
                                       : Vector(data_.gap.terms * gap_coefficients(gamma));
    for (std::size_t k = 0; k < rows.size(); ++k) out[static_cast<Index>(k)] = c[rows[k]];
}

void ReducedModel::checked_gap(const Parameter& gamma, double t, VectorRef out) const {
    if (!data_.gap.empty()) {
        out.noalias() = data_.checks.gap * gap_coefficients(gamma);
    } else if (data_.centre.c.constant()) {
        out = data_.checks.gap.rowwise().sum();
    } else {
        Vector coefficients(data_.checks.gap.cols());
        data_.moving.evaluate(t, Side::right, coefficients);
        out.noalias() = data_.checks.gap * coefficients;
    }
}

namespace {

Matrix unshared_copy(const Matrix& A) {
    if (const Vector* diagonal = A.diagonal_entries()) return Matrix::diagonal(*diagonal);
    if (const DenseMatrix* dense = A.dense()) return Matrix(*dense);
    return Matrix(*A.sparse());
}

}  // namespace

ReducedModel ReducedModel::unshared() const {
    ReducedModelData copy = data_;
    ContactProblem& problem = copy.centre;
    if (problem.M) problem.M = unshared_copy(*problem.M);
    if (problem.D) problem.D = unshared_copy(*problem.D);
    problem.K = unshared_copy(problem.K);
    problem.B = unshared_copy(problem.B);
    return ReducedModel(std::move(copy), exact_);
}

BasisReport report_basis(const ContactProblem& reduced, const Combination& combination) {
    BasisReport report;
    report.p = reduced.size();
    report.p_lambda = reduced.constraints();
    report.inf_sup_constant = inf_sup_constant(reduced);
    if (report.p_lambda == 0) return report;
    const DenseMatrix B = reduced.B.to_dense();
    DenseMatrix S = B.transpose();
    DenseLinearSolver().factorize(combined(reduced, combination))->solve(S);
    S = (B * S).eval();
    const Vector sigma =
        Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>((S + S.transpose()) / 2, Eigen::EigenvaluesOnly).eigenvalues();
    const double largest = sigma[sigma.size() - 1];
    report.schur_rank = (sigma.array() > 1e-12 * largest).count();
    report.schur_condition = report.schur_rank == report.p_lambda ? largest / sigma[0] : infinity;
    return report;
}

}  // namespace tact
