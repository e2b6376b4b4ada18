#include "peer_program.hpp"

#include <unistd.h>

#include <cstdio>
#include <cstdlib>

#include "../../lib/errors.hpp"

namespace tact::bench {

namespace fs = std::filesystem;

TemporaryFolder::TemporaryFolder() {
    std::string pattern = (fs::temp_directory_path() / "tact-peer-XXXXXX").string();
    if (!mkdtemp(pattern.data())) throw NumericalError("peer: no temporary folder " + pattern);
    path_ = pattern;
}

TemporaryFolder::~TemporaryFolder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
}

std::optional<std::string> peer_program(const std::string& name) {
    std::error_code error;
    const fs::path self = fs::read_symlink("/proc/self/exe", error);
    for (const fs::path& folder : {self.parent_path(), self.parent_path().parent_path() / "bench"})
        if (const fs::path program = folder / name; fs::exists(program, error)) return program.string();
    return std::nullopt;
}

std::string peer_version(const std::string& program) {
    std::FILE* pipe = popen(("'" + program + "' --version").c_str(), "r");
    if (!pipe) return {};
    char text[64] = {};
    const std::size_t count = std::fread(text, 1, sizeof text - 1, pipe);
    pclose(pipe);
    std::string version(text, count);
    while (!version.empty() && version.back() == '\n') version.pop_back();
    return version;
}

}  // namespace tact::bench
