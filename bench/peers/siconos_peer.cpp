#include "siconos_peer.hpp"

#include <algorithm>
#include <cstdint>
#include <fstream>

#include "../../lib/errors.hpp"
#include "../../lib/io/write_file.hpp"
#include "../harness/isolated.hpp"
#include "../harness/report.hpp"
#include "peer_program.hpp"

namespace tact::bench {
namespace {

void put_columns(std::ostream& out, const SparseMatrix& A) {
    const std::vector<std::int32_t> start(A.outerIndexPtr(), A.outerIndexPtr() + A.cols() + 1);
    const std::vector<std::int32_t> index(A.innerIndexPtr(), A.innerIndexPtr() + A.nonZeros());
    put(out, start.data(), static_cast<Index>(start.size()));
    put(out, index.data(), static_cast<Index>(index.size()));
    put(out, A.valuePtr(), A.nonZeros());
}

/// The coefficients of f at t_k, k from 0: one column a time, the mean of both limits.
DenseMatrix load_values(const AffineVector& f, double dt, long steps) {
    DenseMatrix values = DenseMatrix::Ones(f.modes.cols(), steps + 1);
    if (f.constant()) return values;
    Vector left(f.modes.cols()), right(f.modes.cols());
    for (long k = 0; k <= steps; ++k) {
        const double t = static_cast<double>(k) * dt;
        f.coefficients(t, Side::left, left);
        f.coefficients(t, Side::right, right);
        values.col(k) = (left + right) / 2;
    }
    return values;
}

bool without_load(const AffineVector& f) { return f.constant() && f.at(0).isZero(0); }

void write_problem(const std::filesystem::path& path, const PrecisionScene& scene, long steps) {
    const ContactProblem& problem = scene.problem;
    const DenseMatrix modes = without_load(problem.f) ? DenseMatrix(problem.size(), 0) : problem.f.modes;
    const double dt = scene.t_end / static_cast<double>(steps);
    write_file(path, [&](std::ostream& out) {
        const std::vector<std::int64_t> head{problem.size(), problem.constraints(), modes.cols(), steps,
                                             scene.outputs};
        put(out, head.data(), static_cast<Index>(head.size()));
        put(out, &dt, 1);
        put_columns(out, problem.M->to_sparse());
        put_columns(out, problem.K.to_sparse());
        put_columns(out, problem.B.to_sparse().transpose());
        for (const Vector& values : {problem.c.at(0), problem.u0, problem.v0}) put(out, values.data(), values.size());
        put(out, modes.data(), modes.size());
        if (modes.cols() > 0) {
            const DenseMatrix values = load_values(problem.f, dt, steps);
            put(out, values.data(), values.size());
        }
    });
}

/// (Energy at the end - energy at first) / largest energy, of those at the output times.
double drift(const ContactProblem& problem, const DenseMatrix& u, const DenseMatrix& v) {
    const auto energy = [&](const Vector& at, const Vector& velocity) {
        return 0.5 * velocity.dot(*problem.M * velocity) + 0.5 * at.dot(problem.K * at);
    };
    const double first = energy(problem.u0, problem.v0);
    double largest = first, last = first;
    for (Index k = 0; k < u.cols(); ++k) largest = std::max(largest, last = energy(u.col(k), v.col(k)));
    return (last - first) / largest;
}

void read_answer(const std::filesystem::path& path, Json& row, const PrecisionScene& scene, long steps) {
    const Index n = scene.problem.size();
    double seconds = 0;
    DenseMatrix u(n, scene.outputs), v(n, scene.outputs);
    Vector impulse(scene.outputs);
    std::ifstream in(path, std::ios::binary);
    get(in, &seconds, 1);
    for (DenseMatrix* values : {&u, &v}) get(in, values->data(), values->size());
    get(in, impulse.data(), impulse.size());
    if (!in) throw NumericalError("siconos: the answer is not whole");
    if (!u.allFinite()) {
        row["outcome"] = "not finite";
        return;
    }
    const auto reference = scene.reference({"moreau-jean", false, true});
    row["steps"] = steps;
    row["seconds"] = seconds;
    row["error_u"] = error_u(scene, u, *reference);
    row["error_lambda"] = error_lambda(impulse, *reference);
    if (without_load(scene.problem.f)) row["energy_drift"] = drift(scene.problem, u, v);
}

void march(Json& row, const PrecisionScene& scene, long steps, const std::string& program, double limit) {
    const TemporaryFolder folder;
    const std::filesystem::path question = folder.path() / "problem", answer = folder.path() / "answer";
    write_problem(question, scene, steps);
    const std::string why = run_program({program, question.string(), answer.string()}, 2 * limit);
    if (why.empty())
        read_answer(answer, row, scene, steps);
    else
        row["outcome"] = why;
}

}  // namespace

std::optional<std::string> siconos_program() { return peer_program("tact-peer-siconos"); }

std::vector<Json> siconos_rows(const PrecisionScene& scene, const std::string& program, double limit,
                               const std::function<void()>& done) {
    const ContactProblem& problem = scene.problem;
    if (!problem.M || problem.D || problem.r || !problem.c.constant())
        throw InputError(
            "siconos_rows: the problem has no M, or a D, an r or a c that moves, expected "
            "M u'' + K u = f + B' lambda with a constant c");
    std::vector<Json> rows;
    double step_seconds = 0;
    for (const long steps : scene.steps) {
        Json row =
            empty_precision_row(scene, siconos_method, "dt=" + digits(scene.t_end / static_cast<double>(steps), 6));
        const double expected = step_seconds * static_cast<double>(steps);
        if (expected > limit) {
            row["outcome"] = "left out: it would take " + with_unit(expected);
        } else {
            march(row, scene, steps, program, limit);
            if (row["seconds"].is_number()) step_seconds = row["seconds"].get<double>() / static_cast<double>(steps);
        }
        rows.push_back(std::move(row));
        done();
    }
    return rows;
}

}  // namespace tact::bench
