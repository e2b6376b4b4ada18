// Numbers to and from a binary stream, with a checksum; of this machine's byte order.
#pragma once

#include <cstdint>
#include <cstring>
#include <istream>
#include <ostream>
#include <string>
#include <type_traits>
#include <vector>

#include "../../lib/errors.hpp"
#include "../../lib/types.hpp"

namespace tact {

/// Of the bytes in the pieces they are written in.
class Checksum {
public:
    void add(const char* bytes, std::size_t size) {
        for (; size >= sizeof(std::uint64_t); bytes += sizeof(std::uint64_t), size -= sizeof(std::uint64_t)) {
            std::uint64_t word = 0;
            std::memcpy(&word, bytes, sizeof word);
            mix(word);
        }
        for (; size > 0; ++bytes, --size) mix(static_cast<unsigned char>(*bytes));
    }
    std::uint64_t value() const { return value_; }

private:
    void mix(std::uint64_t word) {  // FNV-1a by words, the high bits folded down
        value_ = (value_ ^ word) * 0x100000001b3u;
        value_ ^= value_ >> 32;
    }
    std::uint64_t value_ = 0xcbf29ce484222325u;
};

/// What writer and reader have in common: `archive(a, b, c)` takes plain values, strings, vectors and matrices, vectors of
/// all of these, and classes with a member `serialize(archive)`.
template <class Archive> class ArchiveFields {
public:
    template <class... Fields> void operator()(Fields&... fields) { (put(fields), ...); }
    std::uint64_t checksum() const { return checksum_.value(); }

protected:
    Checksum checksum_;

private:
    Archive& self() { return static_cast<Archive&>(*this); }
    template <class Field> void put(Field& field) {
        if constexpr (requires { field.serialize(self()); })
            field.serialize(self());
        else
            self().bytes(reinterpret_cast<char*>(&field), sizeof field);
        static_assert(std::is_trivially_copyable_v<Field> || requires { field.serialize(self()); });
    }
    void put(std::string& text) { put_items(text); }
    void put(std::vector<bool>& flags) = delete;
    template <class Item> void put(std::vector<Item>& items) { put_items(items); }
    template <int rows, int cols, int options> void put(Eigen::Matrix<double, rows, cols, options>& matrix) {
        std::int64_t m = matrix.rows(), n = matrix.cols();
        put(m);
        put(n);
        self().expect(m, n, sizeof(double));
        matrix.resize(m, n);
        self().bytes(reinterpret_cast<char*>(matrix.data()),
                     sizeof(double) * static_cast<std::size_t>(matrix.size()));
    }
    template <class Items> void put_items(Items& items) {
        using Item = typename Items::value_type;
        std::int64_t count = static_cast<std::int64_t>(items.size());
        put(count);
        constexpr bool plain = std::is_arithmetic_v<Item>;
        self().expect(count, 1, plain ? sizeof(Item) : 1);
        items.resize(static_cast<std::size_t>(count));
        if constexpr (plain)
            self().bytes(reinterpret_cast<char*>(items.data()), sizeof(Item) * items.size());
        else
            for (Item& item : items) put(item);
    }
};

class ArchiveWriter : public ArchiveFields<ArchiveWriter> {
public:
    explicit ArchiveWriter(std::ostream& out) : out_(out) {}

private:
    friend ArchiveFields;
    void expect(std::int64_t, std::int64_t, std::size_t) {}
    void bytes(const char* data, std::size_t size) {
        checksum_.add(data, size);
        out_.write(data, static_cast<std::streamsize>(size));
    }
    std::ostream& out_;
};

/// Throws InputError in the name of `what` where the stream ends too early.
class ArchiveReader : public ArchiveFields<ArchiveReader> {
public:
    /// `left`: bytes of the stream, which no count in it may exceed.
    ArchiveReader(std::istream& in, std::uint64_t left, std::string what)
        : in_(in), left_(left), what_(std::move(what)) {}

private:
    friend ArchiveFields;
    void expect(std::int64_t rows, std::int64_t cols, std::size_t size) {
        if (rows < 0 || cols < 0 ||
            static_cast<double>(rows) * static_cast<double>(cols) * static_cast<double>(size) >
                static_cast<double>(left_))
            damaged();
    }
    void bytes(char* data, std::size_t size) {
        if (size > left_ || !in_.read(data, static_cast<std::streamsize>(size))) damaged();
        left_ -= size;
        checksum_.add(data, size);
    }
    [[noreturn]] void damaged() const {
        throw InputError(what_ + " ends too early or is damaged, expected a whole file");
    }
    std::istream& in_;
    std::uint64_t left_;
    std::string what_;
};

}  // namespace tact
