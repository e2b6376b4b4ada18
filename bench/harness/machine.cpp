#include "machine.hpp"

#include <unistd.h>
#include <CLI/Version.hpp>

#include <Eigen/Core>
#include <array>
#include <cstdlib>
#include <ctime>
#include <fstream>
#include <string>
#include <thread>

#include "../peers/interior_point.hpp"

// Weak: there with OpenBLAS or OpenMP, absent with others. No headers, because which BLAS it is is the distribution's choice.
extern "C" {
[[gnu::weak]] void openblas_set_num_threads(int);
[[gnu::weak]] char* openblas_get_config();
[[gnu::weak]] void omp_set_num_threads(int);
[[gnu::weak]] int SuiteSparse_version(int*);
[[gnu::weak]] extern const char* gsl_version;
[[gnu::weak]] int SUNDIALSGetVersion(char*, int);
}

namespace tact::bench {
namespace {

#ifdef __clang__
constexpr const char* compiler = __VERSION__;  // says "Clang" itself
#else
constexpr const char* compiler = "GCC " __VERSION__;
#endif

std::string processor() {
    std::ifstream in("/proc/cpuinfo");
    for (std::string line; std::getline(in, line);)
        if (line.starts_with("model name")) return line.substr(line.find(':') + 2);
    return "unknown";
}

std::string dotted(int a, int b, int c) {
    return std::to_string(a) + "." + std::to_string(b) + "." + std::to_string(c);
}

}  // namespace

Json machine() {
    Json libraries;
    libraries["Eigen"] = dotted(EIGEN_WORLD_VERSION, EIGEN_MAJOR_VERSION, EIGEN_MINOR_VERSION);
    libraries["nlohmann-json"] =
        dotted(NLOHMANN_JSON_VERSION_MAJOR, NLOHMANN_JSON_VERSION_MINOR, NLOHMANN_JSON_VERSION_PATCH);
    libraries["CLI11"] = CLI11_VERSION;
    if (SuiteSparse_version) {
        std::array<int, 3> version{};
        SuiteSparse_version(version.data());
        libraries["SuiteSparse"] = dotted(version[0], version[1], version[2]);
    }
    if (SUNDIALSGetVersion) {
        std::array<char, 32> version{};
        SUNDIALSGetVersion(version.data(), static_cast<int>(version.size()));
        libraries["SUNDIALS"] = version.data();
    }
    if (&gsl_version) libraries["GSL"] = gsl_version;
    if (openblas_get_config) libraries["BLAS"] = openblas_get_config();
    libraries["IPOPT"] = interior_point() ? Json(interior_point_version()) : Json();

    const std::time_t now = std::time(nullptr);
    std::tm utc{};
    gmtime_r(&now, &utc);
    std::array<char, 32> date{};
    std::strftime(date.data(), date.size(), "%Y-%m-%dT%H:%M:%SZ", &utc);

    Json machine;
    machine["cpu"] = processor();
    machine["cores"] = std::thread::hardware_concurrency();
    machine["threads_used"] = 1;
    machine["compiler"] = compiler;
    machine["flags"] = TACT_FLAGS;
    machine["libraries"] = std::move(libraries);
    machine["date"] = date.data();
    return machine;
}

void use_one_thread(char** arguments) {
    if (!std::getenv("OMP_THREAD_LIMIT")) {
        for (const char* name : {"OMP_THREAD_LIMIT", "OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"}) setenv(name, "1", 0);
        execv("/proc/self/exe", arguments);  // comes back only where it fails: then as before
    }
    if (openblas_set_num_threads && !std::getenv("OPENBLAS_NUM_THREADS")) openblas_set_num_threads(1);
    if (omp_set_num_threads && !std::getenv("OMP_NUM_THREADS")) omp_set_num_threads(1);
}

}  // namespace tact::bench
