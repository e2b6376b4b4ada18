// Result files that are whole or absent.
#pragma once

#include <filesystem>
#include <functional>
#include <ostream>
#include <string>
#include <string_view>

namespace tact {

/// Writes `path` in one piece: into `path`.part first, renamed when all of it is on disk, so that a run which ends half
/// way leaves the old file or none. Makes missing folders. InputError that names the path if it cannot be written.
void write_file(const std::filesystem::path& path, std::string_view text);

/// The same for a writer that streams. Whatever `write` throws goes on, and the part file with it.
void write_file(const std::filesystem::path& path, const std::function<void(std::ostream&)>& write);

/// The whole of a file. InputError that names the path if it cannot be read.
std::string read_file(const std::filesystem::path& path);

}  // namespace tact
