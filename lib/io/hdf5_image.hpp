// Named arrays as the image of an HDF5 file, in memory: what reaches the disk is whole or absent.
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "../types.hpp"

namespace tact {

/// Collects arrays under names such as "basis/U" (groups are made) into one HDF5 file. A matrix is stored by columns: readers
/// that count rows first see its transpose. Numbers keep their bits. NumericalError if the library refuses.
class Hdf5Writer {
public:
    Hdf5Writer();
    ~Hdf5Writer();
    Hdf5Writer(Hdf5Writer&&) = delete;
    Hdf5Writer& operator=(Hdf5Writer&&) = delete;

    void write(const std::string& name, const DenseMatrix& numbers);
    void write(const std::string& name, const Vector& numbers);
    void write(const std::string& name, const std::vector<long>& numbers);
    void write(const std::string& name, const std::vector<std::string>& texts);
    /// The file's bytes.
    std::string image() const;

private:
    struct File;
    std::unique_ptr<File> file_;
};

/// Reads what Hdf5Writer wrote. InputError that names `path` and the array if it is missing or of another kind.
class Hdf5Reader {
public:
    /// `image`: the file's bytes; `path`: for messages.
    Hdf5Reader(std::string image, std::string path);
    ~Hdf5Reader();
    Hdf5Reader(Hdf5Reader&&) = delete;
    Hdf5Reader& operator=(Hdf5Reader&&) = delete;

    bool has(const std::string& name) const;
    DenseMatrix matrix(const std::string& name) const;
    Vector vector(const std::string& name) const;
    std::vector<long> integers(const std::string& name) const;
    std::vector<std::string> texts(const std::string& name) const;

private:
    struct File;
    std::unique_ptr<File> file_;
};

}  // namespace tact
