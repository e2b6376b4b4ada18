#include "petsc_peer.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <fstream>

#include "../../contact/prepare/rows.hpp"
#include "../../lib/io/write_file.hpp"
#include "../harness/isolated.hpp"
#include "../harness/report.hpp"
#include "peer_program.hpp"

namespace tact::bench {
namespace {

namespace fs = std::filesystem;

/// u = T y, where y holds B_i u in place of one unknown of each row i.
struct BoundForm {
    BoundForm(const Matrix& A, const Matrix& B) : rows(B), B_(B.to_sparse()) {
        const Index n = A.rows();
        bounded.assign(static_cast<std::size_t>(n), -1);
        std::vector<Eigen::Triplet<double, long>> entries;
        std::vector<char> replaced(static_cast<std::size_t>(n), 0);
        for (Index i = 0; i < rows.rows(); ++i) {
            const auto columns = rows.columns(i);
            const auto weights = rows.weights(i);
            const Index j = columns.back();
            bounded[static_cast<std::size_t>(j)] = i;
            replaced[static_cast<std::size_t>(j)] = 1;
            entries.emplace_back(j, j, 1 / weights.back());
            for (std::size_t k = 0; k + 1 < columns.size(); ++k)
                entries.emplace_back(j, columns[k], -weights[k] / weights.back());
        }
        for (Index j = 0; j < n; ++j)
            if (!replaced[static_cast<std::size_t>(j)]) entries.emplace_back(j, j, 1.0);
        T.resize(n, n);
        T.setFromTriplets(entries.begin(), entries.end());
        transformed = T.transpose() * A.to_sparse() * T;
        transformed.makeCompressed();
    }
    Vector lower(const Vector& c) const {
        Vector bounds = Vector::Constant(T.rows(), -infinity);
        for (std::size_t j = 0; j < bounded.size(); ++j)
            if (bounded[j] >= 0) bounds[static_cast<Index>(j)] = c[bounded[j]];
        return bounds;
    }
    Vector from(const Vector& u) const {
        Vector y = u;
        for (std::size_t j = 0; j < bounded.size(); ++j)
            if (bounded[j] >= 0) y[static_cast<Index>(j)] = rows.gather(bounded[j], u.data());
        return y;
    }
    /// Of the rows that y meets: B B' is diagonal because rows do not overlap. Elsewhere what is left of Au - b is not a
    /// multiplier but an error.
    Vector multipliers(const Vector& residual, const Vector& y, const Vector& bounds) const {
        constexpr double met = 1e-12;
        Vector lambda = Vector::Zero(rows.rows());
        for (Index i = 0; i < rows.rows(); ++i) {
            const Index j = rows.columns(i).back();
            if (!(y[j] - bounds[j] <= met * std::abs(bounds[j]))) continue;
            double squares = 0;
            for (const double weight : rows.weights(i)) squares += weight * weight;
            lambda[i] = std::max(0.0, rows.gather(i, residual.data()) / squares);
        }
        return lambda;
    }

    ConstraintRows rows;
    SparseMatrix T, transformed;
    std::vector<Index> bounded;  ///< the row that bounds an unknown, or -1

private:
    SparseMatrix B_;
};

void write_problem(const fs::path& path, const SolverProblem& problem, const BoundForm& form, int repeats) {
    write_file(path, [&](std::ostream& out) {
        const SparseMatrix& A = form.transformed;  // symmetric: its columns are its rows
        const std::vector<std::int64_t> head{A.rows(), A.nonZeros(), problem.cold, repeats,
                                             static_cast<std::int64_t>(problem.samples.size())};
        put(out, head.data(), static_cast<Index>(head.size()));
        const std::vector<std::int32_t> start(A.outerIndexPtr(), A.outerIndexPtr() + A.rows() + 1);
        const std::vector<std::int32_t> column(A.innerIndexPtr(), A.innerIndexPtr() + A.nonZeros());
        put(out, start.data(), static_cast<Index>(start.size()));
        put(out, column.data(), static_cast<Index>(column.size()));
        put(out, A.valuePtr(), A.nonZeros());
        for (const SampledSolve& sample : problem.samples)
            for (const Vector& values :
                 {Vector(form.T.transpose() * sample.b), form.lower(sample.c), form.from(sample.u)})
                put(out, values.data(), values.size());
    });
}

/// Reads the answers and certifies them by our own residuals.
void read_answers(const fs::path& path, Json& row, const SolverProblem& problem, const BoundForm& form) {
    std::ifstream in(path, std::ios::binary);
    std::vector<std::vector<double>> seconds;
    double iterations = 0, weight = 0, kkt = 0, error = 0;
    bool converged = true;
    const SampledSolve& first = problem.samples.front();
    const KktCertificate certificate(first.A, first.B);
    for (std::size_t k = 0; k < problem.samples.size(); ++k) {
        const SampledSolve& sample = problem.samples[k];
        std::int64_t head[3] = {};
        get(in, head, 3);
        Vector times(head[2]), y(sample.u.size());
        for (Vector* values : {&times, &y}) get(in, values->data(), values->size());
        if (!in) throw NumericalError("petsc: the answer is not whole");
        seconds.resize(static_cast<std::size_t>(head[2]));
        for (Index r = 0; r < times.size(); ++r) seconds[static_cast<std::size_t>(r)].push_back(times[r]);
        const Vector u = form.T * y;
        const Vector lambda = form.multipliers(sample.A * u - sample.b, y, form.lower(sample.c));
        kkt = std::max(kkt, certificate(sample.b, sample.c, u, lambda).largest());
        error = std::max(error, solution_error(u, sample));
        converged = converged && head[0] > 0;
        iterations += problem.weights[k] * static_cast<double>(head[1]);
        weight += problem.weights[k];
    }
    put_seconds(row, problem, seconds);
    row["iterations"] = weight > 0 ? iterations / weight : 0.0;
    row["outcome"] = converged ? "converged" : "not converged";
    if (!converged) return;
    row["kkt_residual"] = kkt;
    row["solution_error"] = error;
}

std::string scientific(double x) {
    char text[32];
    std::snprintf(text, sizeof text, "%g", x);
    return text;
}

}  // namespace

const std::vector<PetscMethod>& petsc_methods() {
    static const std::vector<PetscMethod> methods{
        {"snes-rsls cg+icc", "snes", "-snes_linesearch_type basic -ksp_type cg -ksp_rtol 1e-6 -pc_type icc"},
        // GAMG cannot follow a set that changes from iteration to iteration in PETSc 3.18.
        {"snes-rsls cg+boomeramg", "snes", "-snes_linesearch_type basic -ksp_type cg -ksp_rtol 1e-6 -pc_type hypre"},
        {"snes-rsls cholesky", "snes",
         "-snes_linesearch_type basic -ksp_type preonly -pc_type cholesky -pc_factor_mat_solver_type cholmod"},
        // Its projected gradient stays above 1e-12: asked for that it goes on for ever.
        {"tao-gpcg", "tao", "-tao_type gpcg", 1e-9},
        {"tao-tron", "tao", "-tao_type tron"},
    };
    return methods;
}

std::optional<std::string> petsc_program() { return peer_program("tact-peer-petsc"); }

Json time_petsc(const SolverProblem& problem, const PetscMethod& method, const std::string& program,
                const TimingOptions& options) {
    const SampledSolve& first = problem.samples.front();
    if (!ConstraintRows(first.B).disjoint()) return nullptr;
    Json row = empty_row(problem, "petsc " + method.name, true);
    row["strategy"] = method.options;
    const BoundForm form(first.A, first.B);
    const TemporaryFolder folder;
    const fs::path question = folder.path() / "problem", answer = folder.path() / "answer";
    const int repeats = std::min(options.repeats, 3);  // they cost seconds
    write_problem(question, problem, form, repeats);
    const std::string why =
        run_program({program, question.string(), answer.string(), method.family, scientific(method.accuracy),
                     scientific(options.peer_solve), scientific(options.enough), method.options},
                    options.limit);
    if (!why.empty()) {
        row["message"] = why == own_timer ? "more than " + with_unit(options.peer_solve) + " for one solve" : why;
        return row;
    }
    read_answers(answer, row, problem, form);
    row["how"] = problem.march ? "from " + std::to_string(problem.samples.size()) + " sampled steps" : problem.what;
    return row;
}

}  // namespace tact::bench
