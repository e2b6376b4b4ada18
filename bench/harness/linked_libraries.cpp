#include "linked_libraries.hpp"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <filesystem>
#include <sstream>

#include "../../lib/errors.hpp"
#include "interrupt.hpp"
#include "timing.hpp"

extern char** environ;

namespace tact::bench {
namespace {

namespace fs = std::filesystem;

/// The text a program writes, run with some environment added; code: how it ended.
std::string output_of(const fs::path& program, const std::vector<std::string>& added, int& code) {
    int ends[2];
    if (pipe(ends) != 0) throw NumericalError("omission: no pipe");
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_adddup2(&actions, ends[1], STDOUT_FILENO);
    posix_spawn_file_actions_addclose(&actions, ends[0]);
    std::vector<std::string> words = added;
    std::vector<char*> environment;
    for (std::string& word : words) environment.push_back(word.data());
    for (char** each = environ; *each; ++each) environment.push_back(*each);
    environment.push_back(nullptr);
    std::string path = program.string();
    char* arguments[]{path.data(), nullptr};
    pid_t child = 0;
    const int error = posix_spawn(&child, path.c_str(), &actions, nullptr, arguments, environment.data());
    posix_spawn_file_actions_destroy(&actions);
    close(ends[1]);
    std::string text;
    char buffer[4096];
    for (ssize_t got = 0; error == 0 && (got = read(ends[0], buffer, sizeof buffer)) != 0;) {
        if (got > 0)
            text.append(buffer, static_cast<std::size_t>(got));
        else if (errno != EINTR)
            break;
    }
    close(ends[0]);
    if (error != 0) throw NumericalError("omission: " + path + " cannot be run; build the target tact-bench");
    int status = 0;
    while (waitpid(child, &status, 0) < 0)
        if (errno != EINTR) break;
    code = WIFEXITED(status) ? WEXITSTATUS(status) : 128;
    return text;
}

/// Of the third parties that some component of tact links.
const std::vector<std::pair<std::string, std::string>>& third_parties() {
    static const std::vector<std::pair<std::string, std::string>> all{
        {"libsundials_", "SUNDIALS"}, {"libklu", "KLU"}, {"libcholmod", "CHOLMOD"}, {"libopenblas", "OpenBLAS"},
        {"libblas", "BLAS"},          {"libgsl", "GSL"}, {"libhdf5", "HDF5"},       {"libipopt", "IPOPT"}};
    return all;
}

}  // namespace

Json online_program(const std::string& name, const std::string& does, const std::string& components) {
    const fs::path program = fs::read_symlink("/proc/self/exe").parent_path() / name;
    const fs::path here = fs::exists(program) ? program : fs::path(TACT_BENCH_BINARIES) / name;
    int code = 0;
    // The dynamic linker's own answer, as ldd asks for it.
    std::istringstream loaded(output_of(here, {"LD_TRACE_LOADED_OBJECTS=1"}, code));
    Json libraries = Json::array();
    std::string line;
    while (std::getline(loaded, line)) {
        std::string library;
        std::istringstream(line) >> library;
        if (library.starts_with("lib")) libraries.push_back(library.substr(0, library.find(".so")));
    }
    Json left_out = Json::array();
    for (const auto& [prefix, party] : third_parties())
        if (std::ranges::none_of(libraries,
                                 [&](const Json& each) { return each.get<std::string>().starts_with(prefix); }))
            left_out.push_back(party);
    std::vector<double> seconds;
    constexpr int runs = 21;
    for (int k = 0; k < runs; ++k) {
        throw_if_interrupted();
        const auto start = std::chrono::steady_clock::now();
        (void)output_of(here, {}, code);
        seconds.push_back(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
        if (code != 0)
            throw NumericalError("omission: " + here.string() + " ended with code " + std::to_string(code));
    }
    return {{"program", name},
            {"does", does},
            {"components", components},
            {"bytes", fs::file_size(here)},
            {"libraries", libraries},
            {"left_out", left_out},
            {"startup_seconds", median(seconds)}};
}

}  // namespace tact::bench
