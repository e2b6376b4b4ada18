// tact-peer-petsc PROBLEM ANSWER snes|tao ACCURACY LIMIT ENOUGH OPTIONS: bound-constrained quadratic programmes by PETSc, timed
// here. A solve of more than LIMIT CPU s ends it by SIGPROF, after ENOUGH CPU s no repeat is begun. A program of its own because
// PETSc brings MPI. The files are those of bench/petsc_peer.cpp, which starts it; no tact library.
#include <petscksp.h>
#include <petscsnes.h>
#include <petsctao.h>
#include <sys/time.h>

#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <fstream>
#include <limits>
#include <string>
#include <vector>

namespace {

static_assert(sizeof(PetscScalar) == sizeof(double));

struct Sample {
    std::vector<double> b, lower, guess;
};
struct Problem {
    std::int64_t n = 0, entries = 0, cold = 0, repeats = 0, count = 0;
    std::vector<PetscInt> start, column;
    std::vector<double> value;
    std::vector<Sample> samples;
};
struct Answer {
    std::int64_t reason = 0, iterations = 0;
    std::vector<double> seconds, u;
};

template <class T> void read(std::ifstream& in, std::vector<T>& values, std::int64_t count) {
    values.resize(static_cast<std::size_t>(count));
    in.read(reinterpret_cast<char*>(values.data()), static_cast<std::streamsize>(sizeof(T) * values.size()));
}
template <class T> void write(std::ofstream& out, const std::vector<T>& values) {
    out.write(reinterpret_cast<const char*>(values.data()), static_cast<std::streamsize>(sizeof(T) * values.size()));
}

bool read_problem(const char* path, Problem& p) {
    std::ifstream in(path, std::ios::binary);
    std::vector<std::int64_t> head;
    read(in, head, 5);
    if (!in) return false;
    p.n = head[0], p.entries = head[1], p.cold = head[2], p.repeats = head[3], p.count = head[4];
    std::vector<std::int32_t> start, column;
    read(in, start, p.n + 1);
    read(in, column, p.entries);
    read(in, p.value, p.entries);
    p.start.assign(start.begin(), start.end());
    p.column.assign(column.begin(), column.end());
    for (std::int64_t k = 0; k < p.count; ++k) {
        Sample& sample = p.samples.emplace_back();
        for (auto* values : {&sample.b, &sample.lower, &sample.guess}) read(in, *values, p.n);
    }
    return static_cast<bool>(in);
}

bool write_answers(const char* path, const std::vector<Answer>& answers) {
    std::ofstream out(path, std::ios::binary);
    for (const Answer& answer : answers) {
        const auto repeats = static_cast<std::int64_t>(answer.seconds.size());
        write(out, std::vector<std::int64_t>{answer.reason, answer.iterations, repeats});
        write(out, answer.seconds);
        write(out, answer.u);
    }
    out.close();
    return static_cast<bool>(out);
}

/// Of the only thread: the clock of the process is as coarse as the tick under a limit of CPU time.
double cpu_seconds() {
    timespec now{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// SIGPROF after so many CPU s: PETSc cannot be asked to look at a clock.
void end_after(double seconds) {
    itimerval timer{};
    timer.it_value.tv_sec = static_cast<time_t>(seconds);
    timer.it_value.tv_usec = static_cast<suseconds_t>(1e6 * (seconds - std::floor(seconds)));
    setitimer(ITIMER_PROF, &timer, nullptr);
}

/// What the user asks of all solves alike.
struct Limits {
    double accuracy = 0;  ///< over |b|
    double solve = 0, enough = 0;
};

/// What PETSc's call-backs see.
struct Programme {
    Mat A = nullptr;
    Vec b = nullptr, lower = nullptr, upper = nullptr, x = nullptr, work = nullptr;
};

PetscErrorCode residual(SNES, Vec x, Vec f, void* context) {
    auto* p = static_cast<Programme*>(context);
    PetscFunctionBeginUser;
    PetscCall(MatMult(p->A, x, f));
    PetscCall(VecAXPY(f, -1, p->b));
    PetscFunctionReturn(0);
}
PetscErrorCode jacobian(SNES, Vec, Mat, Mat, void*) { return 0; }  // constant

PetscErrorCode objective(Tao, Vec x, PetscReal* f, Vec g, void* context) {
    auto* p = static_cast<Programme*>(context);
    PetscReal linear = 0, quadratic = 0;
    PetscFunctionBeginUser;
    PetscCall(MatMult(p->A, x, g));
    PetscCall(VecDot(x, g, &quadratic));
    PetscCall(VecDot(x, p->b, &linear));
    PetscCall(VecAXPY(g, -1, p->b));
    *f = 0.5 * quadratic - linear;
    PetscFunctionReturn(0);
}
PetscErrorCode hessian(Tao, Vec, Mat, Mat, void*) { return 0; }

constexpr int most_iterations = 300;

/// One of the two families, made afresh or kept from solve to solve.
class Solver {
public:
    PetscErrorCode create(bool use_snes, Programme& p) {
        PetscFunctionBeginUser;
        if (use_snes) {
            PetscCall(SNESCreate(PETSC_COMM_SELF, &snes_));
            PetscCall(SNESSetType(snes_, SNESVINEWTONRSLS));
            PetscCall(SNESSetFunction(snes_, p.work, residual, &p));
            PetscCall(SNESSetJacobian(snes_, p.A, p.A, jacobian, &p));
            PetscCall(SNESVISetVariableBounds(snes_, p.lower, p.upper));
            PetscCall(SNESSetFromOptions(snes_));
        } else {
            PetscCall(TaoCreate(PETSC_COMM_SELF, &tao_));
            PetscCall(TaoSetType(tao_, TAOGPCG));
            PetscCall(TaoSetSolution(tao_, p.x));
            PetscCall(TaoSetObjectiveAndGradient(tao_, nullptr, objective, &p));
            PetscCall(TaoSetHessian(tao_, p.A, p.A, hessian, &p));
            PetscCall(TaoSetVariableBounds(tao_, p.lower, p.upper));
            PetscCall(TaoSetFromOptions(tao_));
        }
        PetscFunctionReturn(0);
    }
    /// `accuracy`: of the norm of the residual or of the projected gradient.
    PetscErrorCode solve(Programme& p, double accuracy, Answer& answer) {
        PetscInt iterations = 0;
        PetscFunctionBeginUser;
        if (snes_) {
            SNESConvergedReason reason = SNES_CONVERGED_ITERATING;
            PetscCall(SNESSetTolerances(snes_, accuracy, 0, 0, most_iterations, 1000 * most_iterations));
            PetscCall(SNESSolve(snes_, nullptr, p.x));
            PetscCall(SNESGetConvergedReason(snes_, &reason));
            PetscCall(SNESGetIterationNumber(snes_, &iterations));
            answer.reason = reason;
        } else {
            TaoConvergedReason reason = TAO_CONTINUE_ITERATING;
            PetscCall(TaoSetTolerances(tao_, accuracy, 0, 0));
            PetscCall(TaoSetMaximumIterations(tao_, most_iterations));
            PetscCall(TaoSolve(tao_));
            PetscCall(TaoGetConvergedReason(tao_, &reason));
            PetscCall(TaoGetIterationNumber(tao_, &iterations));
            answer.reason = reason;
        }
        answer.iterations = iterations;
        PetscFunctionReturn(0);
    }
    PetscErrorCode destroy() {
        PetscFunctionBeginUser;
        PetscCall(SNESDestroy(&snes_));
        PetscCall(TaoDestroy(&tao_));
        PetscFunctionReturn(0);
    }

private:
    SNES snes_ = nullptr;
    Tao tao_ = nullptr;
};

PetscErrorCode fill(Vec to, const std::vector<double>& from) {
    PetscScalar* values = nullptr;
    PetscFunctionBeginUser;
    PetscCall(VecGetArray(to, &values));
    for (std::size_t i = 0; i < from.size(); ++i)
        values[i] = from[i] == -std::numeric_limits<double>::infinity() ? PETSC_NINFINITY : from[i];
    PetscCall(VecRestoreArray(to, &values));
    PetscFunctionReturn(0);
}

/// All samples in turn, as often as asked. Making the solver counts where every solve is cold; copying data in never does.
PetscErrorCode run(Problem& problem, bool use_snes, const Limits& limits, std::vector<Answer>& answers) {
    Programme p;
    const auto n = static_cast<PetscInt>(problem.n);
    PetscFunctionBeginUser;
    PetscCall(MatCreateSeqAIJWithArrays(PETSC_COMM_SELF, n, n, problem.start.data(), problem.column.data(),
                                        problem.value.data(), &p.A));
    PetscCall(MatSetOption(p.A, MAT_SPD, PETSC_TRUE));
    for (Vec* v : {&p.b, &p.lower, &p.upper, &p.x, &p.work}) PetscCall(VecCreateSeq(PETSC_COMM_SELF, n, v));
    PetscCall(VecSet(p.upper, PETSC_INFINITY));
    answers.resize(problem.samples.size());
    const double begin = cpu_seconds();
    for (std::int64_t repeat = 0; repeat < problem.repeats; ++repeat) {
        if (repeat > 0 && cpu_seconds() - begin > limits.enough) break;
        Solver solver;
        if (!problem.cold) PetscCall(solver.create(use_snes, p));
        for (std::size_t k = 0; k < problem.samples.size(); ++k) {
            const Sample& sample = problem.samples[k];
            Answer& answer = answers[k];
            PetscReal size = 0;
            PetscCall(fill(p.b, sample.b));
            PetscCall(fill(p.lower, sample.lower));
            PetscCall(fill(p.x, sample.guess));
            PetscCall(VecNorm(p.b, NORM_2, &size));
            end_after(limits.solve);
            const double start = cpu_seconds();
            if (problem.cold) PetscCall(solver.create(use_snes, p));
            PetscCall(solver.solve(p, limits.accuracy * size, answer));
            answer.seconds.push_back(cpu_seconds() - start);
            if (problem.cold) PetscCall(solver.destroy());
            const PetscScalar* values = nullptr;
            PetscCall(VecGetArrayRead(p.x, &values));
            answer.u.assign(values, values + n);
            PetscCall(VecRestoreArrayRead(p.x, &values));
        }
        PetscCall(solver.destroy());
    }
    for (Vec* v : {&p.b, &p.lower, &p.upper, &p.x, &p.work}) PetscCall(VecDestroy(v));
    PetscCall(MatDestroy(&p.A));
    PetscFunctionReturn(0);
}

}  // namespace

int main(int argc, char** argv) {
    if (argc == 2 && std::string(argv[1]) == "--version") {
        std::printf("%d.%d.%d\n", PETSC_VERSION_MAJOR, PETSC_VERSION_MINOR, PETSC_VERSION_SUBMINOR);
        return 0;
    }
    if (argc != 8) {
        std::fprintf(stderr, "usage: tact-peer-petsc PROBLEM ANSWER snes|tao ACCURACY LIMIT ENOUGH OPTIONS\n");
        return 2;
    }
    Problem problem;
    if (!read_problem(argv[1], problem)) {
        std::fprintf(stderr, "tact-peer-petsc: %s cannot be read\n", argv[1]);
        return 1;
    }
    int none = 0;
    PetscCall(PetscInitialize(&none, nullptr, nullptr, nullptr));
    PetscCall(PetscOptionsInsertString(nullptr, argv[7]));
    std::vector<Answer> answers;
    const Limits limits{std::atof(argv[4]), std::atof(argv[5]), std::atof(argv[6])};
    PetscCall(run(problem, std::string(argv[3]) == "snes", limits, answers));
    end_after(0);
    PetscCall(PetscFinalize());
    if (write_answers(argv[2], answers)) return 0;
    std::fprintf(stderr, "tact-peer-petsc: %s cannot be written\n", argv[2]);
    return 1;
}
