#include "report.hpp"

#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <cstdio>

#include "../../lib/errors.hpp"
#include "../../lib/io/write_file.hpp"
#include "interrupt.hpp"

namespace tact::bench {

std::string digits(const Json& number, int significant) {
    if (!number.is_number()) return "-";
    const double x = number.get<double>();
    std::array<char, 40> text{};
    // %g would turn 2230 into 2.23e+03.
    if (std::abs(x) >= std::pow(10, significant) && std::abs(x) < 1e8)
        std::snprintf(text.data(), text.size(), "%.0f", x);
    else
        std::snprintf(text.data(), text.size(), "%.*g", significant, x);
    return text.data();
}

std::string with_unit(const Json& seconds) {
    if (!seconds.is_number()) return "-";
    const double s = seconds.get<double>();
    if (s < 1e-3) return digits(s * 1e6) + " us";
    if (s < 1) return digits(s * 1e3) + " ms";
    return digits(s) + " s";
}

Json norm_percent(const Json& squared_percent) {
    return squared_percent.is_number() ? Json(10 * std::sqrt(squared_percent.get<double>())) : Json();
}

const char* const what_the_errors_are =
    "- *relative error in the norm*: the Euclidean norm of U q - u over that of u, of the displacements of all nodes "
    "at all "
    "steps (statics: of the one solution), in %, against the full run on the same grid with the same steps at the "
    "same "
    "parameter. What that full run itself lacks, because of its grid and its steps, is not in it: see "
    "[tradeoff](tradeoff.md).\n"
    "- *squared, as the paper prints it*: eq. 16 or 17, the square of that ratio, in %: 1 % there is 10 % in the "
    "norm.\n";

std::string table(const std::vector<std::vector<std::string>>& rows) {
    std::vector<std::size_t> widths;
    for (const auto& row : rows)
        for (std::size_t k = 0; k < row.size(); ++k) {
            if (k == widths.size()) widths.push_back(3);
            widths[k] = std::max(widths[k], row[k].size());
        }
    std::string text;
    for (std::size_t r = 0; r < rows.size(); ++r) {
        for (std::size_t k = 0; k < rows[r].size(); ++k) {
            const std::string padding(widths[k] - rows[r][k].size(), ' ');
            text.append("| ");
            text.append(k == 0 ? rows[r][k] + padding : padding + rows[r][k]).append(" ");
        }
        text.append("|\n");
        if (r > 0) continue;
        for (std::size_t k = 0; k < widths.size(); ++k)
            text.append("|").append(widths[k] + (k == 0 ? 2 : 1), '-').append(k == 0 ? "" : ":");
        text.append("|\n");
    }
    return text;
}

std::string machine_line(const Json& machine) {
    return machine["cpu"].get<std::string>() + ", " + machine["cores"].dump() + " cores, one used; " +
           machine["compiler"].get<std::string>() + " " + machine["flags"].get<std::string>() + "; " +
           machine["date"].get<std::string>();
}

namespace {

/// Exit code of a program; no shell between.
int execute(std::vector<std::string> words) {
    std::vector<char*> arguments;
    for (std::string& word : words) arguments.push_back(word.data());
    arguments.push_back(nullptr);
    pid_t child = 0;
    if (posix_spawn(&child, arguments[0], nullptr, nullptr, arguments.data(), environ) != 0) return 127;
    int status = 0;
    while (waitpid(child, &status, 0) < 0)
        if (errno != EINTR) return 127;
    return WIFEXITED(status) ? WEXITSTATUS(status) : 128;
}

}  // namespace

void check_out_folder(const std::filesystem::path& out) {
    const std::filesystem::path probe = out / ".tact-bench";
    write_file(probe, "");
    std::error_code ignored;
    std::filesystem::remove(probe, ignored);
}

void write_study(const std::filesystem::path& out, const std::string& name, const Json& json,
                 const std::string& markdown) {
    const std::filesystem::path data = out / (name + ".json");
    write_file(data, json.dump(2) + "\n");
    write_file(out / (name + ".md"), markdown);
    std::string room = name;
    std::ranges::replace(room, '-', '_');
    draw("studies/" + room + "/figure", data, out / (name + ".svg"),
         "needs python3-matplotlib; " + data.string() + " is complete");
}

void draw(const std::string& script, const std::filesystem::path& input, const std::filesystem::path& file,
          const std::string& hint) {
    const std::string path = std::string(TACT_BENCH_FOLDER) + "/" + script + ".py";
    const std::filesystem::path part = file.string() + ".part";
    const int code = execute({TACT_PYTHON, "-B", path, input.string(), part.string()});
    std::error_code error;
    if (code == 0) std::filesystem::rename(part, file, error);
    if (code == 0 && !error) return;
    std::error_code ignored;
    std::filesystem::remove(part, ignored);
    throw_if_interrupted();
    throw NumericalError("plots: " + file.string() + " could not be made (exit code " + std::to_string(code) +
                         "): " + TACT_PYTHON + " " + path + " " + hint);
}

}  // namespace tact::bench
