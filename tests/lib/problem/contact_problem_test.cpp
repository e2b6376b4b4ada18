#include "../../../lib/problem/contact_problem.hpp"

#include <gtest/gtest.h>

#include "../../../lib/errors.hpp"

namespace tact {
namespace {

ContactProblem valid() {
    ContactProblem p;
    p.M = Matrix::identity(3);
    p.K = Matrix::identity(3);
    p.B = Matrix(DenseMatrix(DenseMatrix::Ones(2, 3)));
    p.c = Vector(Vector::Zero(2));
    p.f = Vector(Vector::Zero(3));
    p.u0 = p.v0 = Vector::Zero(3);
    return p;
}

/// The error names the field, what came and what was expected.
void expect_rejected(const ContactProblem& p, const std::string& field, const std::string& found,
                     const std::string& expected) {
    try {
        validate(p);
        FAIL() << "accepted a bad " << field;
    } catch (const InputError& error) {
        const std::string text = error.what();
        EXPECT_NE(text.find("ContactProblem: " + field), std::string::npos) << text;
        EXPECT_NE(text.find(found), std::string::npos) << text;
        EXPECT_NE(text.find("expected " + expected), std::string::npos) << text;
    }
}

TEST(ContactProblem, AcceptsWhatIsRightAndWhatIsAbsent) {
    ContactProblem p = valid();
    validate(p);
    p.c = Vector(Vector::Constant(2, -infinity));
    validate(p);
    p.M.reset();
    p.v0.resize(0);
    p.D = Matrix::identity(3);
    validate(p);
    p.D.reset();
    p.u0.resize(0);
    p.B = Matrix::without_rows(3);
    p.c = {};
    validate(p);
}

TEST(ContactProblem, NamesTheFieldThatIsWrong) {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    ContactProblem p = valid();
    p.u0 = Vector::Zero(2);
    expect_rejected(p, "u0", "2x1", "3x1");
    p = valid();
    p.v0 = Vector::Constant(3, infinity);
    expect_rejected(p, "v0", "infinite", "finite");
    p = valid();
    p.M = Matrix::identity(4);
    expect_rejected(p, "M", "4x4", "3x3");
    p = valid();
    DenseMatrix skew = DenseMatrix::Identity(3, 3);
    skew(0, 2) = 1;
    p.M = Matrix(skew);
    expect_rejected(p, "M", "not symmetric", "a symmetric 3x3");
    p = valid();
    p.B = Matrix(DenseMatrix(DenseMatrix::Ones(2, 4)));
    expect_rejected(p, "B", "2x4", "2x3");
    p = valid();
    p.c = Vector(Vector::Zero(3));
    expect_rejected(p, "c", "3 rows", "2");
    p = valid();
    p.c = Vector(Vector::Constant(2, infinity));
    expect_rejected(p, "c[0]", "inf", "a number or");
    p = valid();
    p.f = Vector(Vector::Constant(3, nan));
    expect_rejected(p, "f[0]", "nan", "a finite number");
    p = valid();
    p.K = Matrix(DenseMatrix(DenseMatrix::Constant(3, 3, nan)));
    expect_rejected(p, "K", "NaN", "finite");
}

TEST(AffineVector, IsModesTimesCoefficientsWithOneSidedLimits) {
    const AffineVector step(DenseMatrix(DenseMatrix::Identity(2, 2)),
                            [](double t, Side side, VectorRef out) {
                                out[0] = t > 1 || (t == 1 && side == Side::right) ? 1 : 0;
                                out[1] = t;
                            },
                            {1.0});
    EXPECT_EQ(step.at(1, Side::left), Eigen::Vector2d(0, 1));
    EXPECT_EQ(step.at(1, Side::right), Eigen::Vector2d(1, 1));
    EXPECT_EQ(AffineVector(Vector(Vector::Ones(3))).at(7), Vector::Ones(3));
}

}  // namespace
}  // namespace tact
