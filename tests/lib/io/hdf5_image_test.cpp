#include "../../../lib/io/hdf5_image.hpp"

#include <gtest/gtest.h>

#include <cstring>
#include <limits>

#include "../../../lib/errors.hpp"

namespace tact {
namespace {

TEST(Hdf5Image, GivesBackEveryArrayToTheBit) {
    DenseMatrix A(2, 3);
    A << 1, 0.1, -0.0, 1e-310, infinity, std::numeric_limits<double>::quiet_NaN();
    const std::vector<std::string> texts{"gamma1", "", "restitution \xc3\xa9"};
    std::string image;
    {
        Hdf5Writer writer;
        writer.write("a/b/matrix", A);
        writer.write("a/vector", Vector(A.col(1)));
        writer.write("integers", std::vector<long>{-3, 1L << 60});
        writer.write("texts", texts);
        writer.write("empty/matrix", DenseMatrix(0, 4));
        writer.write("empty/texts", std::vector<std::string>{});
        image = writer.image();
    }
    const Hdf5Reader reader(image, "here");
    const DenseMatrix B = reader.matrix("a/b/matrix");
    ASSERT_EQ(B.rows(), 2);
    ASSERT_EQ(B.cols(), 3);
    EXPECT_EQ(std::memcmp(A.data(), B.data(), 6 * sizeof(double)), 0);
    EXPECT_EQ(reader.vector("a/vector"), A.col(1));
    EXPECT_EQ(reader.integers("integers"), (std::vector<long>{-3, 1L << 60}));
    EXPECT_EQ(reader.texts("texts"), texts);
    EXPECT_EQ(reader.matrix("empty/matrix").cols(), 4);
    EXPECT_TRUE(reader.texts("empty/texts").empty());
    EXPECT_TRUE(reader.has("a/b/matrix"));
    EXPECT_FALSE(reader.has("a/c/matrix"));
}

TEST(Hdf5Image, RefusesWhatIsMissingOrOfAnotherKind) {
    std::string image;
    {
        Hdf5Writer writer;
        writer.write("x", Vector(Vector::Ones(3)));
        image = writer.image();
    }
    const Hdf5Reader reader(image, "here");
    EXPECT_THROW((void)reader.vector("y"), InputError);
    EXPECT_THROW((void)reader.matrix("x"), InputError);
    EXPECT_THROW((void)reader.texts("x"), InputError);
    EXPECT_THROW((void)reader.integers("x"), InputError);
}

TEST(Hdf5Image, RefusesBytesOfAnotherFormat) {
    EXPECT_THROW(Hdf5Reader("", "here"), InputError);
    EXPECT_THROW(Hdf5Reader(std::string(4096, 'x'), "here"), InputError);
}

}  // namespace
}  // namespace tact
