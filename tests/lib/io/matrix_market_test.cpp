#include "../../../lib/io/matrix_market.hpp"

#include <gtest/gtest.h>

#include "../../../lib/errors.hpp"
#include "../../../lib/io/write_file.hpp"

namespace tact {
namespace {

class MatrixMarket : public testing::Test {
protected:
    void SetUp() override {
        const auto* test = testing::UnitTest::GetInstance()->current_test_info();
        folder_ = std::filesystem::path(testing::TempDir()) / (std::string("tact_matrix_market_") + test->name());
        std::filesystem::remove_all(folder_);
    }
    void TearDown() override { std::filesystem::remove_all(folder_); }

    SparseMatrix matrix(const std::string& text) const {
        write_file(folder_ / "A.mtx", text);
        return read_matrix_market(folder_ / "A.mtx");
    }
    Vector vector(const std::string& text) const {
        write_file(folder_ / "c.txt", text);
        return read_vector(folder_ / "c.txt");
    }
    /// What the reader says of a text that it must refuse.
    template <class Read> static std::string complaint(Read read) {
        try {
            read();
        } catch (const InputError& error) {
            return error.what();
        }
        return "nothing";
    }

    std::filesystem::path folder_;
};

const std::string general = "%%MatrixMarket matrix coordinate real general\n";
const std::string symmetric = "%%MatrixMarket matrix coordinate real symmetric\n";

TEST_F(MatrixMarket, ReadsGeneralWithCommentsBlankLinesAndCarriageReturns) {
    const SparseMatrix A = matrix(
        "%%MatrixMarket MATRIX coordinate Real general\r\n% a comment\n\n2 3 3\n1 3 -1.5e-3\r\n"
        "%another\n 2\t1  4\n2 2 +7");
    DenseMatrix expected(2, 3);
    expected << 0, 0, -1.5e-3, 4, 7, 0;
    EXPECT_EQ(DenseMatrix(A), expected);
}

TEST_F(MatrixMarket, FillsTheUpperHalfOfASymmetricMatrix) {
    DenseMatrix expected(2, 2);
    expected << 2, -1, -1, 3;
    EXPECT_EQ(DenseMatrix(matrix(symmetric + "2 2 3\n1 1 2\n2 1 -1\n2 2 3\n")), expected);
}

TEST_F(MatrixMarket, ReadsMatricesWithoutRowsOrEntries) {
    const SparseMatrix B = matrix(general + "0 5 0\n");
    EXPECT_EQ(B.rows(), 0);
    EXPECT_EQ(B.cols(), 5);
    EXPECT_EQ(matrix(symmetric + "4 4 0\n").nonZeros(), 0);
}

TEST_F(MatrixMarket, RefusesWhatIsMalformedAndNamesFileAndLine) {
    struct Case {
        std::string text, line, word;
    };
    const std::vector<Case> cases{
        {"", "line 1", "empty"},
        {"2 2 1\n1 1 1\n", "line 1", "header"},
        {"%%MatrixMarket matrix array real general\n1 1\n1\n", "line 1", "header"},
        {"%%MatrixMarket matrix coordinate complex general\n1 1 1\n1 1 1 0\n", "line 1", "header"},
        {"%%MatrixMarket matrix coordinate real skew-symmetric\n2 2 1\n2 1 1\n", "line 1", "header"},
        {"%%MatrixMarket matrix coordinate real general extra\n1 1 1\n1 1 1\n", "line 1", "header"},
        {general, "line 2", "number of rows"},
        {general + "2 2\n", "line 2", "number of rows"},
        {general + "-1 2 0\n", "line 2", "number of rows is '-1'"},
        {general + "2 2.0 0\n", "line 2", "'2.0'"},
        {general + "99999999999999999999 2 0\n", "line 2", "rows"},
        {symmetric + "2 3 0\n", "line 2", "square"},
        {general + "2 2 1\n3 1 1\n", "line 3", "the row is '3'"},
        {general + "2 2 1\n0 1 1\n", "line 3", "the row is '0'"},
        {general + "2 2 1\n1 3 1\n", "line 3", "the column is '3'"},
        {general + "2 2 1\n1 1\n", "line 3", "2 words"},
        {general + "2 2 1\n1 1 1 1\n", "line 3", "4 words"},
        {general + "% text\n2 2 2\n1 1 1\n", "line 5", "ends after 1"},
        {general + "2 2 1\n1 1 1\n2 2 1\n", "line 4", "more after 1"},
        {general + "2 2 1\n1 1 nan\n", "line 3", "'nan'"},
        {general + "2 2 1\n1 1 -inf\n", "line 3", "finite"},
        {general + "2 2 1\n1 1 1.5x\n", "line 3", "'1.5x'"},
        {general + "2 2 2\n1 1 1\n1 1 1\n", "line 5", "more than one"},
        {symmetric + "2 2 1\n1 2 1\n", "line 3", "above the diagonal"},
    };
    for (const Case& bad : cases) {
        const std::string said = complaint([&] { (void)matrix(bad.text); });
        for (const std::string& word : {std::string("read_matrix_market"), std::string("A.mtx"), bad.line, bad.word})
            EXPECT_NE(said.find(word), std::string::npos) << bad.text << "\n" << said;
    }
    EXPECT_THROW(read_matrix_market(folder_ / "absent.mtx"), InputError);
}

TEST_F(MatrixMarket, ReadsVectorsWithInfinities) {
    const Vector c = vector("-inf\n 1e-3 \r\n\n+2\ninf");
    ASSERT_EQ(c.size(), 4);
    EXPECT_EQ(c[0], -infinity);
    EXPECT_EQ(c[1], 1e-3);
    EXPECT_EQ(c[2], 2);
    EXPECT_EQ(c[3], infinity);
    EXPECT_EQ(vector("").size(), 0);
}

TEST_F(MatrixMarket, RefusesMalformedVectors) {
    for (const char* bad : {"1\nnan\n", "1\n2 3\n", "1\nzwei\n", "1\n% 2\n", "1\n2,\n"}) {
        const std::string said = complaint([&] { (void)vector(bad); });
        for (const char* word : {"read_vector", "c.txt", "line 2"})
            EXPECT_NE(said.find(word), std::string::npos) << bad << "\n" << said;
    }
    EXPECT_THROW(read_vector(folder_ / "absent.txt"), InputError);
}

}  // namespace
}  // namespace tact
