#include "../../../lib/io/write_file.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <stdexcept>

#include "../../../lib/errors.hpp"

namespace tact {
namespace {

class WriteFile : public testing::Test {
protected:
    void SetUp() override {
        const auto* test = testing::UnitTest::GetInstance()->current_test_info();
        folder_ = std::filesystem::path(testing::TempDir()) / (std::string("tact_write_file_") + test->name());
        std::filesystem::remove_all(folder_);
    }
    void TearDown() override { std::filesystem::remove_all(folder_); }
    std::size_t files() const {
        return static_cast<std::size_t>(std::distance(std::filesystem::directory_iterator(folder_), {}));
    }
    std::filesystem::path folder_;
};

TEST_F(WriteFile, MakesFoldersAndReplaces) {
    const auto path = folder_ / "a" / "b.json";
    write_file(path, "first, the longer one");
    write_file(path, "second");
    EXPECT_EQ(read_file(path), "second");
    EXPECT_FALSE(std::filesystem::exists(path.string() + ".part"));
}

TEST_F(WriteFile, AWriterThatThrowsLeavesTheOldFile) {
    const auto path = folder_ / "result.md";
    write_file(path, "old");
    const auto fails = [](std::ostream& out) {
        out << "half of the new";
        throw std::runtime_error("stopped");
    };
    EXPECT_THROW(write_file(path, fails), std::runtime_error);
    EXPECT_EQ(read_file(path), "old");
    EXPECT_EQ(files(), 1u);
}

TEST_F(WriteFile, NamesThePathItCannotWrite) {
    write_file(folder_ / "file", "");
    EXPECT_EQ(read_file(folder_ / "file"), "");
    try {
        write_file(folder_ / "file" / "below.json", "text");
        FAIL() << "a file is no folder";
    } catch (const InputError& error) {
        EXPECT_NE(std::string(error.what()).find("below.json"), std::string::npos) << error.what();
    }
    std::filesystem::create_directories(folder_ / "taken");
    EXPECT_THROW(write_file(folder_ / "taken", "text"), InputError);
    EXPECT_EQ(files(), 2u);
}

TEST_F(WriteFile, ReadsBytesAsTheyAre) {
    const std::string bytes("a\r\n\0b", 5);
    write_file(folder_ / "bytes", bytes);
    EXPECT_EQ(read_file(folder_ / "bytes"), bytes);
    EXPECT_THROW(read_file(folder_ / "absent"), InputError);
    EXPECT_THROW(read_file(folder_), InputError);
}

}  // namespace
}  // namespace tact
