// Peers that run as programs of their own: where they lie, and the files they are spoken to with.
#pragma once

#include <cstddef>
#include <filesystem>
#include <istream>
#include <optional>
#include <ostream>
#include <string>

#include "../../lib/problem/matrix.hpp"

namespace tact::bench {

/// A folder for the exchange, gone with its owner. NumericalError where there is no room for one.
class TemporaryFolder {
public:
    TemporaryFolder();
    TemporaryFolder(const TemporaryFolder&) = delete;
    TemporaryFolder& operator=(const TemporaryFolder&) = delete;
    ~TemporaryFolder();
    const std::filesystem::path& path() const { return path_; }

private:
    std::filesystem::path path_;
};

/// The program of this name beside this one; nothing where its library was not there when it was built.
std::optional<std::string> peer_program(const std::string& name);
/// What it answers to --version.
std::string peer_version(const std::string& program);

/// Numbers as they lie in memory.
template <class T> void put(std::ostream& out, const T* values, Index count) {
    out.write(reinterpret_cast<const char*>(values),
              static_cast<std::streamsize>(sizeof(T) * static_cast<std::size_t>(count)));
}
template <class T> void get(std::istream& in, T* values, Index count) {
    in.read(reinterpret_cast<char*>(values),
            static_cast<std::streamsize>(sizeof(T) * static_cast<std::size_t>(count)));
}

}  // namespace tact::bench
