#include "qp.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <iostream>
#include <optional>
#include <set>
#include <vector>

#include "../../lib/algebra/empty_rows.hpp"
#include "../../lib/io/matrix_market.hpp"
#include "../../lib/io/write_file.hpp"
#include "../harness/contact_solvers.hpp"
#include "../harness/interrupt.hpp"
#include "../harness/progress.hpp"
#include "../harness/report.hpp"
#include "../harness/timing.hpp"

namespace tact::bench {
namespace {

namespace fs = std::filesystem;

constexpr double default_tolerance = 1e-8;

struct Problem {
    Matrix A, B;
    Vector b, c;
};

/// What expected.json asks for; NaN and no vector: not compared.
struct Expected {
    std::vector<std::string> outcomes;
    std::optional<double> objective;
    double tolerance = default_tolerance;
    std::optional<Vector> u;
    double tolerance_u = default_tolerance;
};

/// Folders with a problem, by name. Links are followed, a folder is looked into once.
std::vector<fs::path> problem_folders(const fs::path& root) {
    std::error_code error;
    if (!fs::is_directory(root, error)) throw InputError("qp: folder is " + root.string() + ", expected a folder");
    const auto holds_problem = [](const fs::path& folder) {
        std::error_code ignored;
        return fs::exists(folder / "A.mtx", ignored) || fs::exists(folder / "B.mtx", ignored);
    };
    std::vector<fs::path> folders;
    if (holds_problem(root)) folders.push_back(root);
    std::set<fs::path> seen{fs::canonical(root)};
    const auto options =
        fs::directory_options::follow_directory_symlink | fs::directory_options::skip_permission_denied;
    fs::recursive_directory_iterator it(root, options, error);
    for (; !error && it != fs::recursive_directory_iterator(); it.increment(error)) {
        std::error_code broken;
        if (!it->is_directory(broken)) continue;
        if (!seen.insert(fs::canonical(it->path(), broken)).second || broken) {
            it.disable_recursion_pending();
            continue;
        }
        if (holds_problem(it->path())) folders.push_back(it->path());
    }
    if (error) throw InputError("qp: folder is " + root.string() + ", which cannot be read: " + error.message());
    if (folders.empty())
        throw InputError("qp: folder is " + root.string() +
                         ", expected one with problem folders (A.mtx, B.mtx, ...)");
    std::ranges::sort(folders);
    return folders;
}

Problem read_problem(const fs::path& folder) {
    Problem p{Matrix(read_matrix_market(folder / "A.mtx")), Matrix(read_matrix_market(folder / "B.mtx")),
              read_vector(folder / "b.txt"), read_vector(folder / "c.txt")};
    const auto check = [](const char* field, const std::string& found, const std::string& expected, bool good) {
        if (!good) throw InputError(std::string("qp: ") + field + " is " + found + ", expected " + expected);
    };
    const auto rows = [](Index n) { return std::to_string(n) + " numbers"; };
    const Index n = p.A.rows();
    check("A.mtx", p.A.shape(), "square and not empty", n == p.A.cols() && n > 0);
    check("B.mtx", p.B.shape(), std::to_string(n) + " columns", p.B.cols() == n);
    check("b.txt", rows(p.b.size()), rows(n), p.b.size() == n);
    check("c.txt", rows(p.c.size()), rows(p.B.rows()), p.c.size() == p.B.rows());
    check("b.txt", "not finite", "finite numbers", p.b.allFinite());
    check("c.txt", "inf in some row", "finite numbers or -inf", (p.c.array() < infinity).all());
    return p;
}

bool is_there(const Json& json, const char* field) { return json.contains(field) && !json[field].is_null(); }

Expected parse_expected(const Json& json, const fs::path& folder) {
    Expected expected;
    if (is_there(json, "outcome_allowed"))
        expected.outcomes = json["outcome_allowed"].get<std::vector<std::string>>();
    else
        expected.outcomes = {json.at("outcome").get<std::string>()};
    if (is_there(json, "objective")) expected.objective = json["objective"].get<double>();
    if (is_there(json, "tolerance")) expected.tolerance = json["tolerance"].get<double>();
    expected.tolerance_u = is_there(json, "tolerance_u") ? json["tolerance_u"].get<double>() : expected.tolerance;
    if (!is_there(json, "u")) return expected;
    if (json["u"].is_string()) {
        expected.u = read_vector(folder / json["u"].get<std::string>());
    } else {
        const auto numbers = json["u"].get<std::vector<double>>();
        expected.u = Eigen::Map<const Vector>(numbers.data(), static_cast<Index>(numbers.size()));
    }
    return expected;
}

std::optional<Expected> read_expected(const fs::path& folder) {
    const fs::path file = folder / "expected.json";
    if (!fs::exists(file)) return std::nullopt;
    try {
        return parse_expected(Json::parse(read_file(file)), folder);
    } catch (const Json::exception& error) {
        throw InputError("qp: expected.json is not what it should be: " + std::string(error.what()));
    }
}

std::string number(double x) {
    char text[32];
    std::snprintf(text, sizeof text, "%.10g", x);
    return text;
}

/// Why the answer is not the expected one; empty where it is. A NaN never agrees.
std::string disagreement(const Json& row, const Vector& u, double size_of_unknowns, const Expected& expected) {
    const auto outcome = row["outcome"].get<std::string>();
    if (std::ranges::find(expected.outcomes, outcome) == expected.outcomes.end()) {
        std::string wanted;
        for (const std::string& each : expected.outcomes) wanted += (wanted.empty() ? "" : " or ") + each;
        return "outcome is " + outcome + ", expected " + wanted;
    }
    if (outcome != "converged") return {};
    if (expected.objective) {
        const double found = row["objective"].get<double>(), wanted = *expected.objective;
        // The sum of its terms is what its rounding is measured by, and is small where the problem is.
        const double size = std::max(row["objective_size"].get<double>(), std::abs(wanted));
        if (!(std::abs(found - wanted) <= expected.tolerance * size))
            return "objective is " + number(found) + ", expected " + number(wanted) + " to " +
                   number(expected.tolerance) + " of " + number(size);
    }
    if (expected.u) {
        if (expected.u->size() != u.size())
            return "u has " + std::to_string(u.size()) + " entries, expected " + std::to_string(expected.u->size());
        const double size = expected.u->lpNorm<Eigen::Infinity>(),
                     apart = (u - *expected.u).lpNorm<Eigen::Infinity>();
        if (!(apart <= expected.tolerance_u * (size > 0 ? size : size_of_unknowns)))
            return "u is " + number(apart) + " from the expected one, whose largest entry is " + number(size);
    }
    return {};
}

double largest_entry(const Matrix& A) {
    double largest = 0;
    const SparseMatrix S = A.to_sparse();
    for (Index k = 0; k < S.nonZeros(); ++k) largest = std::max(largest, std::abs(S.valuePtr()[k]));
    return largest;
}

/// What an entry of u is measured by where all that are expected are zero: the loads by A, the gaps by B.
double size_of_unknowns(const Problem& p) {
    const double a = largest_entry(p.A), b = largest_entry(p.B);
    double size = a > 0 ? p.b.lpNorm<Eigen::Infinity>() / a : 0;
    for (const double c : p.c)
        if (c != -infinity && b > 0) size = std::max(size, std::abs(c) / b);
    return size;
}

Json numbers(const Vector& v) { return std::vector<double>(v.begin(), v.end()); }

/// A proof that there is no solution: y >= 0 with B'y = 0 and c'y > 0, or d with A d = 0, B d >= 0 and b'd > 0, and how well
/// it holds. Residuals are by the largest term of their own sums; rows that are off take no part.
void write_certificates(Json& row, const Problem& p, const ContactReport& report) {
    const auto share = [](double value, double size) { return value == 0 ? 0 : value / size; };
    const auto absolute = [](const Matrix& A) { return Matrix(SparseMatrix(A.to_sparse().cwiseAbs())); };
    if (const Vector& y = report.infeasibility; y.size() > 0) {
        Vector balance(p.A.rows()), size(p.A.rows());
        p.B.multiply_transposed(y, balance);
        absolute(p.B).multiply_transposed(y.cwiseAbs(), size);
        double violation = 0;
        for (Index i = 0; i < y.size(); ++i)
            if (y[i] != 0) violation += y[i] * p.c[i];
        row["infeasibility"] = numbers(y);
        row["certificate"] = {{"c'y", violation},
                              {"B'y", share(balance.lpNorm<Eigen::Infinity>(), size.lpNorm<Eigen::Infinity>())},
                              {"least y", y.minCoeff()}};
        if (const std::string why = contradiction_of_empty_row(report, p.B, p.c); !why.empty()) row["message"] = why;
    }
    if (const Vector& d = report.ray; d.size() > 0) {
        const Vector curvature = p.A * d, gap = p.B * d;
        Vector size(p.A.rows());
        absolute(p.A).multiply(d.cwiseAbs(), size);
        double least = 0;
        for (Index i = 0; i < gap.size(); ++i)
            if (p.c[i] != -infinity) least = std::min(least, gap[i]);
        row["ray"] = numbers(d);
        row["certificate"] = {{"b'd", p.b.dot(d)},
                              {"A d", share(curvature.lpNorm<Eigen::Infinity>(), size.lpNorm<Eigen::Infinity>())},
                              {"least B d", least}};
    }
}

void fail(Json& row, const char* outcome, const char* why) {
    row["outcome"] = outcome;
    row["message"] = why;
}

/// Fills the row in; returns u where there is one.
Vector solve(Json& row, const Problem& p, const ContactSolver& solver) {
    row["unknowns"] = p.A.rows();
    row["constraints"] = p.B.rows();
    Vector u = Vector::Zero(p.A.rows()), lambda = Vector::Zero(p.B.rows());
    ContactReport report;
    const double start = cpu_seconds();
    try {
        // A programme has a symmetric A; a strategy for others would solve a complementarity problem instead.
        if (!p.A.is_symmetric()) throw InputError("qp: A is " + p.A.shape() + " and not symmetric");
        report = solver.prepare(p.A, p.B)->solve(p.b, p.c, {u, lambda});
    } catch (const InputError& error) {
        fail(row, "unsupported", error.what());
    } catch (const NumericalError& error) {
        fail(row, "unsupported", error.what());
    }
    row["seconds"] = cpu_seconds() - start;
    if (row.contains("message")) return {};
    row["outcome"] = to_string(report.outcome);
    row["iterations"] = report.iterations;
    row["strategy"] = report.strategy;
    if (!report.fallback.empty()) row["fallback"] = report.fallback;
    write_certificates(row, p, report);
    if (report.outcome != Outcome::converged) return {};
    row["active"] = report.active;
    const double elastic = 0.5 * u.dot(p.A * u), work = u.dot(p.b);
    row["objective"] = elastic - work;
    row["objective_size"] = std::abs(elastic) + std::abs(work);
    row["u"] = numbers(u);
    row["lambda"] = numbers(lambda);
    row["kkt"] = {{"stationarity", report.kkt.stationarity},
                  {"penetration", report.kkt.penetration},
                  {"negativity", report.kkt.negativity},
                  {"complementarity", report.kkt.complementarity}};
    return u;
}

Json solve_folder(const fs::path& root, const fs::path& folder, const ContactSolver& solver) {
    Json row;
    const fs::path relative = folder.lexically_relative(root);
    row["name"] = relative == "." ? fs::canonical(folder).filename().string() : relative.generic_string();
    for (const char* field : {"outcome", "objective", "u", "lambda", "infeasibility", "ray", "certificate"})
        row[field] = nullptr;
    for (const char* field : {"stationarity", "penetration", "negativity", "complementarity"})
        row["kkt"][field] = nullptr;
    for (const char* field : {"seconds", "agrees"}) row[field] = nullptr;
    try {
        const std::optional<Expected> expected = read_expected(folder);
        if (expected) row["agrees"] = false;  // until it is known better
        std::optional<Problem> problem;
        try {
            problem = read_problem(folder);
        } catch (const InputError& error) {
            fail(row, "invalid input", error.what());
        }
        const Vector u = problem ? solve(row, *problem, solver) : Vector();
        if (!expected) return row;
        const std::string why = disagreement(row, u, problem ? size_of_unknowns(*problem) : 0, *expected);
        row["agrees"] = why.empty();
        if (!why.empty()) row["message"] = why + (row.contains("message") ? "; " + std::string(row["message"]) : "");
    } catch (const InputError& error) {
        fail(row, "invalid input", error.what());
        row["agrees"] = false;
    } catch (const Interrupted&) {
        throw;
    } catch (const std::exception& error) {
        fail(row, "failed", error.what());
        row["agrees"] = false;
    }
    return row;
}

}  // namespace

Json run_qp(const fs::path& folder, const ContactSolver& solver) {
    const std::vector<fs::path> folders = problem_folders(folder);
    Json rows = Json::array();
    Progress progress("problems", static_cast<double>(folders.size()));
    for (const fs::path& each : folders) {
        progress.label(each.filename().string());
        progress.add(0);
        rows.push_back(solve_folder(folder, each, solver));
        progress.add(1);
    }
    return rows;
}

bool qp_agrees(const Json& problems) {
    return std::ranges::all_of(problems, [](const Json& row) {
        return row["agrees"].is_null() ? row["outcome"] != "invalid input" : row["agrees"].get<bool>();
    });
}

std::string qp_table(const Json& problems) {
    std::vector<std::vector<std::string>> rows{
        {"problem", "n", "m", "outcome", "objective", "KKT residual", "time", "solved by", "agrees"}};
    std::string messages;
    for (const Json& row : problems) {
        double kkt = 0;
        for (const Json& each : row["kkt"])
            if (each.is_number()) kkt = std::max(kkt, each.get<double>());
        const bool solved = row["objective"].is_number();
        const auto text = [&](const char* field) {
            return !is_there(row, field)    ? "-"
                   : row[field].is_string() ? row[field].get<std::string>()
                                            : row[field].dump();
        };
        std::string by = text("strategy");
        if (row.contains("fallback")) by += ", " + text("fallback");
        const std::string agrees = row["agrees"].is_null() ? "-" : row["agrees"].get<bool>() ? "yes" : "NO";
        rows.push_back({text("name"), text("unknowns"), text("constraints"), text("outcome"),
                        digits(row["objective"], 8), solved ? digits(kkt, 2) : "-", with_unit(row["seconds"]), by,
                        agrees});
        if (row.contains("message")) messages += text("name") + ": " + text("message") + "\n";
    }
    return table(rows) + messages;
}

namespace {

std::function<int()> declare(CLI::App& command) {
    struct Arguments {
        std::string folder, out, solver = "chooser";
    };
    const auto arguments = std::make_shared<Arguments>();
    command.add_option("folder", arguments->folder, "Folder of problem folders, or one of them")->required();
    command.add_option("--out", arguments->out, "json file of the answers");
    std::vector<std::string> names;
    for (const NamedSolver& each : contact_solvers()) names.push_back(each.name);
    command.add_option("--solver", arguments->solver, "What solves them")
        ->check(CLI::IsMember(names))
        ->capture_default_str();
    return [arguments] {
        const Json problems = run_qp(arguments->folder, *contact_solver(arguments->solver));
        std::cout << qp_table(problems) << std::flush;
        if (!arguments->out.empty()) write_file(arguments->out, problems.dump(1) + "\n");
        return qp_agrees(problems) ? 0 : 1;
    };
}

}  // namespace

Command qp_command() {
    return {"qp", "Quadratic programmes from files (A.mtx, B.mtx, b.txt, c.txt), compared with expected.json",
            declare};
}

}  // namespace tact::bench
