#include "write_file.hpp"

#include <fstream>
#include <iterator>
#include <string>
#include <system_error>

#include "../errors.hpp"

namespace tact {
namespace {

[[noreturn]] void cannot_write(const std::filesystem::path& path, const std::string& why) {
    throw InputError("write_file: path is " + path.string() + ", expected one that can be written (" + why + ")");
}

/// Takes the part file away again unless it was renamed.
class PartFile {
public:
    explicit PartFile(const std::filesystem::path& path) : path_(path.string() + ".part") {}
    PartFile(const PartFile&) = delete;
    PartFile& operator=(const PartFile&) = delete;
    ~PartFile() {
        std::error_code ignored;
        if (!renamed_) std::filesystem::remove(path_, ignored);
    }
    const std::filesystem::path& path() const { return path_; }
    void rename_to(const std::filesystem::path& target) {
        std::error_code error;
        std::filesystem::rename(path_, target, error);
        if (error) cannot_write(target, error.message());
        renamed_ = true;
    }

private:
    std::filesystem::path path_;
    bool renamed_ = false;
};

}  // namespace

void write_file(const std::filesystem::path& path, const std::function<void(std::ostream&)>& write) {
    if (path.has_parent_path()) {
        std::error_code error;
        std::filesystem::create_directories(path.parent_path(), error);
        if (error) cannot_write(path, error.message());
    }
    PartFile part(path);
    std::ofstream out(part.path(), std::ios::binary | std::ios::trunc);
    if (!out) cannot_write(path, "it cannot be opened");
    write(out);
    out.close();
    if (!out) cannot_write(path, "writing stopped half way");
    part.rename_to(path);
}

void write_file(const std::filesystem::path& path, std::string_view text) {
    write_file(path, [text](std::ostream& out) { out << text; });
}

std::string read_file(const std::filesystem::path& path) {
    std::string text;
    std::error_code error;
    std::ifstream in(path, std::ios::binary);
    if (in && !std::filesystem::is_directory(path, error))
        text.assign(std::istreambuf_iterator<char>(in), {});
    else
        in.setstate(std::ios::failbit);
    if (!in) throw InputError("read_file: path is " + path.string() + ", expected a file that can be read");
    return text;
}

}  // namespace tact
