#include "../../../lib/io/sealed_file.hpp"

#include <gtest/gtest.h>

#include <cstdint>

#include "../../../lib/errors.hpp"
#include "../../../lib/io/write_file.hpp"

namespace tact {
namespace {

constexpr FileKind kind{"tact test", 3};

/// Tests run side by side: each has files of its own.
std::filesystem::path somewhere(const std::string& name) {
    const auto* test = ::testing::UnitTest::GetInstance()->current_test_info();
    return std::filesystem::path(::testing::TempDir()) / ("tact_" + std::string(test->name()) + "_" + name);
}

TEST(SealedFile, GivesBackItsContents) {
    const auto path = somewhere("sealed");
    const std::string contents("a\0b\n", 4);
    write_sealed_file(path, kind, "tact 1", contents);
    EXPECT_EQ(read_sealed_file(path, kind), contents);
    write_sealed_file(path, kind, "tact 1", "");
    EXPECT_EQ(read_sealed_file(path, kind), "");
}

TEST(SealedFile, HasTheCheckSumOfADivisionBitByBit) {
    const auto path = somewhere("standard");
    write_sealed_file(path, kind, "tact 1", "123456789");
    const std::string whole = read_file(path);
    const std::size_t line = whole.find("crc64 ");
    std::uint64_t remainder = ~std::uint64_t{0};
    for (const char c : whole.substr(0, line) + "123456789")
        for (int bit = 0; bit < 8; ++bit) {
            const bool odd = ((remainder ^ (static_cast<unsigned char>(c) >> bit)) & 1) != 0;
            remainder = (remainder >> 1) ^ (odd ? 0xc96c5795d7870f42ULL : 0);
        }
    EXPECT_EQ(std::stoull(whole.substr(line + 6), nullptr, 16), ~remainder);
}

TEST(SealedFile, NoticesEveryByteThatChanges) {
    const auto path = somewhere("changed");
    write_sealed_file(path, kind, "tact 1", "some contents");
    const std::string whole = read_file(path);
    for (std::size_t k = 0; k < whole.size(); ++k) {
        std::string damaged = whole;
        damaged[k] = static_cast<char>(damaged[k] ^ 4);
        write_file(path, damaged);
        EXPECT_THROW((void)read_sealed_file(path, kind), InputError) << k;
    }
    for (const std::size_t size : {std::size_t{0}, std::size_t{7}, std::size_t{512}, whole.size() - 1}) {
        write_file(path, whole.substr(0, size));
        EXPECT_THROW((void)read_sealed_file(path, kind), InputError) << size;
    }
    write_file(path, whole + "x");
    EXPECT_THROW((void)read_sealed_file(path, kind), InputError);
}

TEST(SealedFile, RefusesAnotherKindOrVersion) {
    const auto path = somewhere("other");
    write_sealed_file(path, kind, "tact 1", "contents");
    EXPECT_THROW((void)read_sealed_file(path, {"tact other", 3}), InputError);
    EXPECT_THROW((void)read_sealed_file(path, {"tact test", 4}), InputError);
    EXPECT_THROW((void)read_sealed_file(somewhere("nowhere/at all"), kind), InputError);
}

}  // namespace
}  // namespace tact
