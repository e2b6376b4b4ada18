// Generated programmes in any number: tact-generated --count N --seed S [--show K]. Programme k is drawn from seed S + k
// alone. Counts the verdicts of each strategy, and why the chooser had no answer; exit code 1 if one is wrong or missed. --show: print programme K.
#include <cstdlib>
#include <cstring>
#include <iomanip>
#include <iostream>
#include <map>

#include "../laws/generated.hpp"

namespace tact::laws {
namespace {

void print(const Generated& g) {
    const Eigen::IOFormat exact(17);
    std::cout << (g.as_sparse ? "sparse" : "dense") << ", condition " << g.condition << "\nA\n"
              << g.qp.A.format(exact) << "\nB\n"
              << g.qp.B.format(exact) << "\nb " << g.qp.b.transpose().format(exact) << "\nc "
              << g.qp.c.transpose().format(exact) << "\nguess " << g.guess.transpose() << "\n";
    if (g.u) std::cout << "planted u " << g.u->transpose().format(exact) << "\n";
}

/// What of a programme may excuse the chooser from an answer.
std::string kind_of(const Generated& g) {
    if (!std::isfinite(g.condition)) return "A singular to rounding";
    if (!g.symmetric) return g.condition < 1e8 ? "A unsymmetric" : "A unsymmetric, condition 1e8 to 1e12";
    if (g.condition >= 1e10) return "condition 1e10 to 1e12";
    return g.truth == Truth::unknown ? "rows that exclude each other, in other units" : "condition below 1e10";
}

int run(std::uint64_t count, std::uint64_t seed, bool show) {
    const auto all = strategies();
    std::map<std::string, std::map<std::string, long>> totals;
    std::map<std::string, long> without_answer;
    int code = 0, reported = 0;
    for (std::uint64_t k = 0; k < count; ++k) {
        const Generated g = Generator(seed + k).draw();
        if (show) print(g);
        for (const Strategy& strategy : all) {
            const Judged j = judge(g, strategy);
            const char* verdict = verdict_names[static_cast<std::size_t>(j.verdict)];
            ++totals[strategy.name][verdict];
            if (strategy.name == std::string("AutomaticContact") && j.verdict != Verdict::right &&
                j.verdict != Verdict::infeasible)
                ++without_answer[kind_of(g) + ": " +
                                 (j.verdict == Verdict::refused ? "refused"
                                                                : std::string(to_string(j.solved.report.outcome)))];
            if (show)
                std::cout << strategy.name << ": " << verdict << " " << j.why << ", KKT "
                          << j.solved.report.kkt.largest() << ", u " << j.solved.u.transpose() << ", lambda "
                          << j.solved.lambda.transpose() << ", certificate "
                          << j.solved.report.infeasibility.transpose() << "\n";
            if (j.verdict != Verdict::wrong && j.verdict != Verdict::missed) continue;
            code = 1;
            if (++reported <= 200)
                std::cout << "seed " << seed + k << ": " << strategy.name << ": " << verdict << ": " << j.why
                          << std::endl;
        }
    }
    for (const auto& [name, verdicts] : totals) {
        std::cout << std::setw(20) << std::left << name;
        for (const char* verdict : verdict_names) {
            const auto it = verdicts.find(verdict);
            std::cout << " " << verdict << " " << (it == verdicts.end() ? 0 : it->second);
        }
        std::cout << "\n";
    }
    std::cout << "AutomaticContact without an answer:\n";
    for (const auto& [kind, times] : without_answer)
        std::cout << std::setw(8) << std::right << times << "  " << kind << "\n";
    return code;
}

}  // namespace
}  // namespace tact::laws

int main(int argc, char** argv) {
    std::uint64_t count = 1000, seed = 1;
    bool show = false;
    for (int i = 1; i + 1 < argc; i += 2) {
        const std::uint64_t value = std::strtoull(argv[i + 1], nullptr, 10);
        if (!std::strcmp(argv[i], "--count")) count = value;
        if (!std::strcmp(argv[i], "--seed")) seed = value;
        if (!std::strcmp(argv[i], "--show")) {
            seed = value;
            count = 1;
            show = true;
        }
    }
    return tact::laws::run(count, seed, show);
}
