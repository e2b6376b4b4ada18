#include "matrix_market.hpp"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "../errors.hpp"
#include "write_file.hpp"

namespace tact {
namespace {

using Words = std::span<const std::string_view>;

/// The lines of a file, split into words; knows where it is, so that every complaint names file and line.
class Lines {
public:
    Lines(const char* reader, const std::filesystem::path& path)
        : reader_(reader), path_(path), text_(read_file(path)) {}

    /// The words of the next line that has any and is no comment (first character '%', if `comments`).
    bool next(bool comments) {
        while (place_ < text_.size()) {
            const std::size_t end = std::min(text_.find('\n', place_), text_.size());
            const std::string_view line(text_.data() + place_, end - place_);
            place_ = end + 1;
            ++number_;
            if (comments && line.starts_with('%')) continue;
            split(line);
            if (!words_.empty()) return true;
        }
        words_.clear();
        ++number_;  // what is missing is missing after the last line
        return false;
    }
    Words words() const { return words_; }

    [[noreturn]] void fail(const std::string& found, const std::string& expected) const {
        throw InputError(std::string(reader_) + ": " + path_.string() + ", line " + std::to_string(number_) + ": " +
                         found + ", expected " + expected);
    }
    /// A number as strtod reads it, the whole word; not NaN.
    double number(std::string_view word) const {
        char* end = nullptr;
        const double value = std::strtod(word.data(), &end);  // the text goes on after the word: a space or its end
        if (end != word.data() + word.size() || std::isnan(value))
            fail("the value is '" + std::string(word) + "'", "a number");
        return value;
    }
    /// A whole number from `least` to `most`.
    Index index(std::string_view word, const char* what, Index least, Index most) const {
        Index value = 0;
        const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
        if (error != std::errc() || end != word.data() + word.size() || value < least || value > most)
            fail(std::string(what) + " is '" + std::string(word) + "'",
                 "a whole number from " + std::to_string(least) + " to " + std::to_string(most));
        return value;
    }

private:
    void split(std::string_view line) {
        constexpr std::string_view space = " \t\r\v\f";
        words_.clear();
        for (std::size_t k = line.find_first_not_of(space); k != std::string_view::npos;) {
            const std::size_t end = std::min(line.find_first_of(space, k), line.size());
            words_.push_back(line.substr(k, end - k));
            k = line.find_first_not_of(space, end);
        }
    }

    const char* reader_;
    std::filesystem::path path_;
    std::string text_;
    std::size_t place_ = 0;
    long number_ = 0;
    std::vector<std::string_view> words_;
};

std::string lower_case(std::string_view word) {
    std::string text(word);
    std::ranges::transform(text, text.begin(),
                           [](unsigned char letter) { return static_cast<char>(std::tolower(letter)); });
    return text;
}

/// Reads the banner: whether the matrix is symmetric.
bool read_banner(Lines& lines) {
    const std::string expected =
        "'%%MatrixMarket matrix coordinate real general' or '%%MatrixMarket matrix coordinate real symmetric'";
    if (!lines.next(false)) lines.fail("the file is empty", expected);
    std::vector<std::string> words;
    for (const std::string_view word : lines.words()) words.push_back(lower_case(word));
    if (words.size() != 5 || words[0] != "%%matrixmarket" || words[1] != "matrix" || words[2] != "coordinate" ||
        (words[3] != "real" && words[3] != "integer") || (words[4] != "general" && words[4] != "symmetric")) {
        std::string found;
        for (const std::string_view word : lines.words()) found.append(found.empty() ? "" : " ").append(word);
        constexpr std::size_t shown = 80;
        lines.fail("the header is '" + found.substr(0, shown) + "'", expected);
    }
    return words[4] == "symmetric";
}

}  // namespace

SparseMatrix read_matrix_market(const std::filesystem::path& path) {
    Lines lines("read_matrix_market", path);
    const bool symmetric = read_banner(lines);
    constexpr Index most = std::numeric_limits<Index>::max() / 2;
    if (!lines.next(true) || lines.words().size() != 3)
        lines.fail("there are " + std::to_string(lines.words().size()) + " words",
                   "the number of rows, of columns and of entries");
    const Index rows = lines.index(lines.words()[0], "the number of rows", 0, most);
    const Index cols = lines.index(lines.words()[1], "the number of columns", 0, most);
    if (symmetric && cols != rows)
        lines.fail("a symmetric matrix is " + std::to_string(rows) + "x" + std::to_string(cols), "a square one");
    const Index count = lines.index(lines.words()[2], "the number of entries", 0, most);

    std::vector<Eigen::Triplet<double, Index>> entries;
    for (Index k = 0; k < count; ++k) {
        if (!lines.next(true))
            lines.fail("the file ends after " + std::to_string(k) + " entries", std::to_string(count));
        const Words words = lines.words();
        if (words.size() != 3)
            lines.fail("there are " + std::to_string(words.size()) + " words", "row, column and value");
        const Index i = lines.index(words[0], "the row", 1, rows) - 1;
        const Index j = lines.index(words[1], "the column", 1, cols) - 1;
        if (symmetric && i < j)
            lines.fail(
                "the entry (" + std::string(words[0]) + ", " + std::string(words[1]) + ") is above the diagonal",
                "the lower half of a symmetric matrix");
        const double value = lines.number(words[2]);
        if (!std::isfinite(value)) lines.fail("the value is '" + std::string(words[2]) + "'", "a finite number");
        entries.emplace_back(i, j, value);
        if (symmetric && i != j) entries.emplace_back(j, i, value);
    }
    if (lines.next(true))
        lines.fail("there is more after " + std::to_string(count) + " entries", "the end of the file");

    // A place named twice is summed by some readers and overwritten by others: no silent choice.
    SparseMatrix matrix(rows, cols);
    matrix.setFromTriplets(entries.begin(), entries.end());
    if (matrix.nonZeros() != static_cast<Index>(entries.size()))
        lines.fail("some places have more than one entry", "each place at most once");
    return matrix;
}

Vector read_vector(const std::filesystem::path& path) {
    Lines lines("read_vector", path);
    std::vector<double> values;
    while (lines.next(false)) {
        if (lines.words().size() != 1)
            lines.fail("there are " + std::to_string(lines.words().size()) + " words", "one number a line");
        values.push_back(lines.number(lines.words()[0]));
    }
    return Eigen::Map<const Vector>(values.data(), static_cast<Index>(values.size()));
}

}  // namespace tact
