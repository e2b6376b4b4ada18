#include "hdf5_image.hpp"

#include <hdf5.h>

#include <algorithm>
#include <mutex>
#include <utility>

#include "../errors.hpp"

namespace tact {
namespace {

/// An identifier of the library, closed by the function of its kind.
class Handle {
public:
    Handle(hid_t id, herr_t (*close)(hid_t)) : id_(id), close_(close) {}
    Handle(Handle&& other) noexcept : id_(std::exchange(other.id_, -1)), close_(other.close_) {}
    Handle& operator=(Handle&&) = delete;
    ~Handle() {
        if (id_ >= 0) close_(id_);
    }
    operator hid_t() const { return id_; }  // NOLINT: this is what the C functions take
    bool valid() const { return id_ >= 0; }

private:
    hid_t id_;
    herr_t (*close_)(hid_t);
};

/// The library has one global state and prints its errors: one user at a time, in silence.
class Quiet {
public:
    Quiet() : lock_(mutex()) {
        H5Eget_auto2(H5E_DEFAULT, &print_, &data_);
        H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
    }
    Quiet(const Quiet&) = delete;
    Quiet& operator=(const Quiet&) = delete;
    ~Quiet() { H5Eset_auto2(H5E_DEFAULT, print_, data_); }

private:
    static std::mutex& mutex() {
        static std::mutex one;
        return one;
    }
    std::lock_guard<std::mutex> lock_;
    H5E_auto2_t print_ = nullptr;
    void* data_ = nullptr;
};

/// The library refuses to open an image under the name of a file that exists: none can exist here.
constexpr const char* no_file = "/dev/null/image";

Handle in_memory() {
    Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
    constexpr std::size_t growth = std::size_t{1} << 20;
    H5Pset_fapl_core(access, growth, 0);
    return access;
}

void write_array(hid_t file, const std::string& name, hid_t stored, hid_t held, std::vector<hsize_t> extents,
                 const void* data) {
    const Handle links(H5Pcreate(H5P_LINK_CREATE), H5Pclose);
    H5Pset_create_intermediate_group(links, 1);
    const Handle space(H5Screate_simple(static_cast<int>(extents.size()), extents.data(), nullptr), H5Sclose);
    const Handle array(H5Dcreate2(file, name.c_str(), stored, space, links, H5P_DEFAULT, H5P_DEFAULT), H5Dclose);
    const bool empty = std::find(extents.begin(), extents.end(), hsize_t{0}) != extents.end();
    if (!array.valid() || (!empty && H5Dwrite(array, held, H5S_ALL, H5S_ALL, H5P_DEFAULT, data) < 0))
        throw NumericalError("Hdf5Writer: the library cannot write " + name);
}

Handle text_type(std::size_t length) {
    Handle type(H5Tcopy(H5T_C_S1), H5Tclose);
    H5Tset_size(type, std::max<std::size_t>(length, 1));
    H5Tset_strpad(type, H5T_STR_NULLPAD);
    H5Tset_cset(type, H5T_CSET_UTF8);
    return type;
}

}  // namespace

struct Hdf5Writer::File {
    Quiet quiet;  // first, so that it is left last
    Handle file;
};

Hdf5Writer::Hdf5Writer()
    : file_(new File{{}, {H5Fcreate(no_file, H5F_ACC_TRUNC, H5P_DEFAULT, in_memory()), H5Fclose}}) {
    if (!file_->file.valid()) throw NumericalError("Hdf5Writer: the library cannot make a file in memory");
}
Hdf5Writer::~Hdf5Writer() = default;

void Hdf5Writer::write(const std::string& name, const DenseMatrix& numbers) {
    write_array(file_->file, name, H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE,
                {static_cast<hsize_t>(numbers.cols()), static_cast<hsize_t>(numbers.rows())}, numbers.data());
}

void Hdf5Writer::write(const std::string& name, const Vector& numbers) {
    write_array(file_->file, name, H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE, {static_cast<hsize_t>(numbers.size())},
                numbers.data());
}

void Hdf5Writer::write(const std::string& name, const std::vector<long>& numbers) {
    write_array(file_->file, name, H5T_STD_I64LE, H5T_NATIVE_LONG, {numbers.size()}, numbers.data());
}

void Hdf5Writer::write(const std::string& name, const std::vector<std::string>& texts) {
    std::size_t length = 1;
    for (const std::string& text : texts) length = std::max(length, text.size());
    std::string padded;
    for (std::string text : texts) {
        text.resize(length, '\0');
        padded += text;
    }
    const Handle type = text_type(length);
    write_array(file_->file, name, type, type, {texts.size()}, padded.data());
}

std::string Hdf5Writer::image() const {
    H5Fflush(file_->file, H5F_SCOPE_GLOBAL);
    const ssize_t size = H5Fget_file_image(file_->file, nullptr, 0);
    std::string bytes(static_cast<std::size_t>(std::max<ssize_t>(size, 0)), '\0');
    if (size <= 0 || H5Fget_file_image(file_->file, bytes.data(), bytes.size()) != size)
        throw NumericalError("Hdf5Writer: the library gives no file image");
    return bytes;
}

struct Hdf5Reader::File {
    Quiet quiet;
    std::string image, path;
    Handle file{-1, H5Fclose};

    File(std::string bytes, std::string name) : image(std::move(bytes)), path(std::move(name)), file(open()) {}

    [[noreturn]] void reject(const std::string& what) const { throw InputError("Hdf5Reader: " + path + ": " + what); }

    Handle open() {
        const Handle access = in_memory();
        if (image.empty() || H5Pset_file_image(access, image.data(), image.size()) < 0)
            reject("the file is empty, expected an HDF5 file");
        Handle opened(H5Fopen(no_file, H5F_ACC_RDONLY, access), H5Fclose);
        if (!opened.valid()) reject("the library cannot read it, expected an HDF5 file");
        return opened;
    }

    /// The array of this name, class and rank, and its extents.
    std::pair<Handle, std::vector<hsize_t>> array(const std::string& name, H5T_class_t kind, int rank) const {
        Handle found(H5Dopen2(file, name.c_str(), H5P_DEFAULT), H5Dclose);
        if (!found.valid()) reject("array " + name + " is missing");
        const Handle type(H5Dget_type(found), H5Tclose);
        const Handle space(H5Dget_space(found), H5Sclose);
        const int dimensions = H5Sget_simple_extent_ndims(space);
        if (H5Tget_class(type) != kind || dimensions != rank)
            reject("array " + name + " has another type or " + std::to_string(dimensions) + " dimensions, expected " +
                   std::to_string(rank));
        std::vector<hsize_t> extents(static_cast<std::size_t>(rank));
        H5Sget_simple_extent_dims(space, extents.data(), nullptr);
        return {std::move(found), std::move(extents)};
    }

    void read(const Handle& from, const std::string& name, hid_t held, bool empty, void* to) const {
        if (!empty && H5Dread(from, held, H5S_ALL, H5S_ALL, H5P_DEFAULT, to) < 0)
            reject("array " + name + " cannot be read");
    }
};

Hdf5Reader::Hdf5Reader(std::string image, std::string path)
    : file_(std::make_unique<File>(std::move(image), std::move(path))) {}
Hdf5Reader::~Hdf5Reader() = default;

bool Hdf5Reader::has(const std::string& name) const {
    for (std::size_t end = name.find('/'); end != std::string::npos; end = name.find('/', end + 1))
        if (H5Lexists(file_->file, name.substr(0, end).c_str(), H5P_DEFAULT) <= 0) return false;
    return H5Lexists(file_->file, name.c_str(), H5P_DEFAULT) > 0;
}

DenseMatrix Hdf5Reader::matrix(const std::string& name) const {
    const auto [array, extents] = file_->array(name, H5T_FLOAT, 2);
    DenseMatrix numbers(static_cast<Index>(extents[1]), static_cast<Index>(extents[0]));
    file_->read(array, name, H5T_NATIVE_DOUBLE, numbers.size() == 0, numbers.data());
    return numbers;
}

Vector Hdf5Reader::vector(const std::string& name) const {
    const auto [array, extents] = file_->array(name, H5T_FLOAT, 1);
    Vector numbers(static_cast<Index>(extents[0]));
    file_->read(array, name, H5T_NATIVE_DOUBLE, numbers.size() == 0, numbers.data());
    return numbers;
}

std::vector<long> Hdf5Reader::integers(const std::string& name) const {
    const auto [array, extents] = file_->array(name, H5T_INTEGER, 1);
    std::vector<long> numbers(extents[0]);
    file_->read(array, name, H5T_NATIVE_LONG, numbers.empty(), numbers.data());
    return numbers;
}

std::vector<std::string> Hdf5Reader::texts(const std::string& name) const {
    const auto [array, extents] = file_->array(name, H5T_STRING, 1);
    const Handle stored(H5Dget_type(array), H5Tclose);
    if (H5Tis_variable_str(stored) > 0) file_->reject("array " + name + " holds texts of variable length");
    const std::size_t length = H5Tget_size(stored), count = extents[0];
    std::string padded(length * count, '\0');
    const Handle held = text_type(length);
    file_->read(array, name, held, count == 0, padded.data());
    std::vector<std::string> texts;
    for (std::size_t k = 0; k < count; ++k) {
        const std::string text = padded.substr(k * length, length);
        texts.push_back(text.substr(0, text.find_last_not_of('\0') + 1));
    }
    return texts;
}

}  // namespace tact
