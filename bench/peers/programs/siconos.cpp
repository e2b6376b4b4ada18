// tact-peer-siconos PROBLEM ANSWER: linear motion with unilateral contact by Siconos' own time stepping, timed here. A program of
// its own because Siconos brings Boost and MUMPS. The files are those of bench/siconos_peer.cpp, which starts it; no tact
// library. Its products with sparse matrices take time with the square of their size, as those with dense ones do: a step
// costs the same either way at 1,000 unknowns. Siconos' solvers of the complementarity problem take the same time: it is
// not what a step costs. Lemke's is finite.
#include <lcp_cst.h>

#include <SiconosKernel.hpp>
#include <boost/numeric/ublas/matrix_sparse.hpp>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <ctime>
#include <exception>
#include <fstream>
#include <string>
#include <vector>

namespace {

/// Of the only thread: the clock of the process is as coarse as the tick under a limit of CPU time.
double cpu_seconds() {
    timespec now{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

template <class T> std::vector<T> read(std::ifstream& in, std::int64_t count) {
    std::vector<T> values(static_cast<std::size_t>(count));
    in.read(reinterpret_cast<char*>(values.data()), static_cast<std::streamsize>(sizeof(T) * values.size()));
    return values;
}
template <class T> void write(std::ofstream& out, const std::vector<T>& values) {
    out.write(reinterpret_cast<const char*>(values.data()), static_cast<std::streamsize>(sizeof(T) * values.size()));
}

/// Columns of entries; of B they are its rows.
struct Columns {
    std::vector<std::int32_t> start, index;
    std::vector<double> value;

    void read_from(std::ifstream& in, std::int64_t columns) {
        start = read<std::int32_t>(in, columns + 1);
        index = read<std::int32_t>(in, start.back());
        value = read<double>(in, start.back());
    }
};

struct Problem {
    std::int64_t n = 0, m = 0, loads = 0, steps = 0, outputs = 0;
    double dt = 0;
    Columns M, K, B;
    std::vector<double> c, u0, v0;
    std::vector<double> load_modes, load_values;  ///< f(t_k) = modes (n x loads) * values (loads x steps + 1)
};
struct Answer {
    std::vector<double> seconds, u, v, impulse;  ///< at the outputs, columns
};

bool read_problem(const char* path, Problem& p) {
    std::ifstream in(path, std::ios::binary);
    const auto head = read<std::int64_t>(in, 5);
    if (!in) return false;
    p.n = head[0], p.m = head[1], p.loads = head[2], p.steps = head[3], p.outputs = head[4];
    p.dt = read<double>(in, 1).front();
    p.M.read_from(in, p.n);
    p.K.read_from(in, p.n);
    p.B.read_from(in, p.m);
    p.c = read<double>(in, p.m);
    p.u0 = read<double>(in, p.n);
    p.v0 = read<double>(in, p.n);
    p.load_modes = read<double>(in, p.n * p.loads);
    p.load_values = read<double>(in, p.loads * (p.steps + 1));
    return static_cast<bool>(in);
}

bool write_answer(const char* path, const Answer& answer) {
    std::ofstream out(path, std::ios::binary);
    for (const auto* values : {&answer.seconds, &answer.u, &answer.v, &answer.impulse}) write(out, *values);
    out.close();
    return static_cast<bool>(out);
}

SP::SimpleMatrix sparse(const Columns& columns, std::int64_t n) {
    SparseMat matrix(static_cast<std::size_t>(n), static_cast<std::size_t>(n), columns.value.size());
    for (std::size_t j = 0; j + 1 < columns.start.size(); ++j)
        for (auto k = static_cast<std::size_t>(columns.start[j]); k < static_cast<std::size_t>(columns.start[j + 1]);
             ++k)
            matrix.push_back(static_cast<std::size_t>(columns.index[k]), j, columns.value[k]);
    return std::make_shared<SimpleMatrix>(matrix);
}

SP::SiconosVector vector(const std::vector<double>& values) {
    auto result = std::make_shared<SiconosVector>(static_cast<unsigned>(values.size()));
    for (unsigned i = 0; i < values.size(); ++i) result->setValue(i, values[i]);
    return result;
}

const Problem* loaded = nullptr;  // Siconos calls back with nothing but a time
void load(double t, unsigned n, double* f, unsigned, double*) {
    const auto k = static_cast<std::size_t>(std::lround(t / loaded->dt));
    for (unsigned i = 0; i < n; ++i) f[i] = 0;
    for (std::size_t l = 0; l < static_cast<std::size_t>(loaded->loads); ++l) {
        const double value = loaded->load_values[l + k * static_cast<std::size_t>(loaded->loads)];
        for (unsigned i = 0; i < n; ++i) f[i] += value * loaded->load_modes[i + l * n];
    }
}

/// A body and one interaction for each row of B: y = B u - c >= 0.
struct Model {
    explicit Model(const Problem& p) {
        nsds = std::make_shared<NonSmoothDynamicalSystem>(0, p.dt * static_cast<double>(p.steps + 1));
        body = std::make_shared<LagrangianLinearTIDS>(vector(p.u0), vector(p.v0), sparse(p.M, p.n));
        body->setKPtr(sparse(p.K, p.n));
        if (p.loads > 0) body->setComputeFExtFunction(load);
        nsds->insertDynamicalSystem(body);
        const auto law = std::make_shared<NewtonImpactNSL>(0.0);
        for (std::size_t i = 0; i < static_cast<std::size_t>(p.m); ++i) {
            auto row = std::make_shared<SimpleMatrix>(1, static_cast<unsigned>(p.n));
            for (auto k = static_cast<std::size_t>(p.B.start[i]); k < static_cast<std::size_t>(p.B.start[i + 1]); ++k)
                row->setValue(0, static_cast<unsigned>(p.B.index[k]), p.B.value[k]);
            const auto relation = std::make_shared<LagrangianLinearTIR>(row, vector({-p.c[i]}));
            rows.push_back(std::make_shared<Interaction>(law, relation));
            nsds->link(rows.back(), body);
        }
        constexpr double theta = 0.5;
        const auto method = std::make_shared<MoreauJeanOSI>(theta);
        method->setIsWSymmetricDefinitePositive(true);
        const auto lcp = std::make_shared<LCP>(SICONOS_LCP_LEMKE);
        stepping = std::make_shared<TimeStepping>(nsds, std::make_shared<TimeDiscretisation>(0, p.dt), method, lcp);
        stepping->setNewtonOptions(SICONOS_TS_LINEAR);
    }

    SP::NonSmoothDynamicalSystem nsds;
    SP::LagrangianLinearTIDS body;
    std::vector<SP::Interaction> rows;
    SP::TimeStepping stepping;
};

void append(std::vector<double>& to, const SiconosVector& from) {
    for (unsigned i = 0; i < from.size(); ++i) to.push_back(from.getValue(i));
}

/// The steps count, and what Siconos prepares in the first of them; making the objects does not.
void run(const Problem& p, Answer& answer) {
    const Model model(p);
    const std::int64_t stride = p.steps / p.outputs;
    double impulse = 0;
    const double start = cpu_seconds();
    for (std::int64_t step = 1; step <= p.steps; ++step) {
        model.stepping->computeOneStep();
        for (const SP::Interaction& row : model.rows) impulse += row->lambda(1)->getValue(0);
        if (step % stride == 0) {
            append(answer.u, *model.body->q());
            append(answer.v, *model.body->velocity());
            answer.impulse.push_back(impulse);
        }
        model.stepping->nextStep();
    }
    answer.seconds = {cpu_seconds() - start};
}

}  // namespace

int main(int argc, char** argv) {
    if (argc == 2 && std::string(argv[1]) == "--version") {
        std::puts(TACT_SICONOS_VERSION);
        return 0;
    }
    if (argc != 3) {
        std::fprintf(stderr, "usage: tact-peer-siconos PROBLEM ANSWER\n");
        return 2;
    }
    Problem problem;
    if (!read_problem(argv[1], problem)) {
        std::fprintf(stderr, "tact-peer-siconos: %s cannot be read\n", argv[1]);
        return 1;
    }
    loaded = &problem;
    Answer answer;
    try {
        run(problem, answer);
    } catch (const std::exception& error) {
        std::fprintf(stderr, "tact-peer-siconos: %s\n", error.what());
        return 1;
    }
    if (write_answer(argv[2], answer)) return 0;
    std::fprintf(stderr, "tact-peer-siconos: %s cannot be written\n", argv[2]);
    return 1;
}
