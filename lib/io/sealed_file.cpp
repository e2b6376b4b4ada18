#include "sealed_file.hpp"

#include <array>
#include <charconv>
#include <cstdint>

#include "../errors.hpp"
#include "write_file.hpp"

namespace tact {
namespace {

constexpr std::size_t block_size = 512;

/// CRC-64 of ECMA-182, bits reflected (as in xz).
std::uint64_t crc64(std::string_view first, std::string_view second) {
    static const auto table = [] {
        std::array<std::uint64_t, 256> entries{};
        for (std::uint64_t i = 0; i < 256; ++i) {
            std::uint64_t x = i;
            for (int bit = 0; bit < 8; ++bit) x = x & 1 ? (x >> 1) ^ 0xc96c5795d7870f42ULL : x >> 1;
            entries[i] = x;
        }
        return entries;
    }();
    std::uint64_t crc = ~std::uint64_t{0};
    for (const std::string_view bytes : {first, second})
        for (const char c : bytes) crc = table[(crc ^ static_cast<unsigned char>(c)) & 0xff] ^ (crc >> 8);
    return ~crc;
}

/// The check sum covers the lines above it as well; reading compares the whole block.
std::string block(const FileKind& kind, std::string_view writer, std::string_view contents) {
    std::string text = std::string(kind.name) + "\nformat " + std::to_string(kind.version) + "\nwriter " +
                       std::string(writer) + "\nbytes " + std::to_string(contents.size()) + "\n";
    std::array<char, 16> crc{};
    const auto end = std::to_chars(crc.data(), crc.data() + crc.size(), crc64(text, contents), 16).ptr;
    text += "crc64 " + std::string(crc.data(), end) + "\n";
    if (text.size() > block_size)
        throw InputError("write_sealed_file: kind and writer have " + std::to_string(text.size()) +
                         " characters, expected at most " + std::to_string(block_size) + " with the rest");
    text.resize(block_size, ' ');
    return text;
}

/// What stands between `label` and the end of its line.
std::string_view field(std::string_view text, std::string_view label) {
    const std::size_t start = text.find(label);
    if (start == std::string_view::npos) return {};
    text.remove_prefix(start + label.size());
    return text.substr(0, text.find('\n'));
}

}  // namespace

void write_sealed_file(const std::filesystem::path& path, const FileKind& kind, std::string_view writer,
                       std::string_view contents) {
    const std::string head = block(kind, writer, contents);
    write_file(path, [&](std::ostream& out) { out << head << contents; });
}

std::string read_sealed_file(const std::filesystem::path& path, const FileKind& kind) {
    std::string file = read_file(path);
    const auto reject = [&](const std::string& what) {
        throw InputError("read_sealed_file: " + path.string() + ": " + what);
    };
    const std::string_view head = std::string_view(file).substr(0, block_size);
    if (!head.starts_with(std::string(kind.name) + "\n"))
        reject("the first line is not \"" + std::string(kind.name) + "\", expected such a file");
    const std::string_view version = field(head, "\nformat ");
    if (version != std::to_string(kind.version))
        reject("format is " + std::string(version) + ", expected " + std::to_string(kind.version));
    const std::string writer(field(head, "\nwriter ")), size(field(head, "\nbytes ")), seal(head);
    file.erase(0, block_size);
    if (size != std::to_string(file.size()))
        reject("it holds " + std::to_string(file.size()) + " bytes, expected " + size);
    if (seal != block(kind, writer, file)) reject("its bytes are not those that were written: it is damaged");
    return file;
}

}  // namespace tact
