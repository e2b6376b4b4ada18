// Files that say what they are and notice when they were damaged.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace tact {

/// What a sealed file declares itself to be.
struct FileKind {
    std::string_view name;  ///< one line, such as "tact reduced model"
    int version;            ///< of the format
};

/// Writes `contents` behind a block of 512 bytes of text: kind, format version, `writer`, size of the contents and a
/// CRC-64 of all that.
/// HDF5 looks for its own start at byte 512, so its tools open a sealed HDF5 image as it is. Whole or not at all (write_file).
/// InputError if the path cannot be written.
void write_sealed_file(const std::filesystem::path& path, const FileKind& kind, std::string_view writer,
                       std::string_view contents);

/// The contents. InputError that names the path and what is wrong: not to be read, another kind of file, another version of
/// the format, another size, or bytes that changed.
std::string read_sealed_file(const std::filesystem::path& path, const FileKind& kind);

}  // namespace tact
