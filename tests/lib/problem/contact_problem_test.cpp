#include "../../../lib/problem/contact_problem.hpp"

#include <gtest/gtest.h>

#include <cmath>

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

TEST(AffineVector, SparseModesAreWhatDenseOnesAre) {
    DenseMatrix modes = DenseMatrix::Zero(5, 3);
    modes(1, 0) = 2;
    modes(4, 0) = modes(1, 1) = -3;
    modes(2, 2) = 0.5;
    const auto coefficients = [](double t, Side, VectorRef out) { out << t, 0, t * t; };
    const AffineVector dense(modes, coefficients, {0.5}),
        sparse(SparseMatrix(modes.sparseView()), coefficients, {0.5});
    EXPECT_EQ(sparse.size(), 5);
    EXPECT_EQ(sparse.mode_count(), 3);
    EXPECT_FALSE(sparse.constant() || sparse.is_function());
    EXPECT_EQ(sparse.jumps, dense.jumps);
    EXPECT_EQ(sparse.at(0.7), dense.at(0.7));
    EXPECT_EQ(sparse.dense_modes("f"), modes);
    const AffineVector constant(SparseMatrix(modes.sparseView()), {});
    EXPECT_TRUE(constant.constant());
    EXPECT_EQ(constant.at(0), Vector(modes.rowwise().sum()));
}

TEST(AffineVector, IsAFunctionOfItsFullSizeWithoutModes) {
    const AffineVector f = AffineVector::function(4, [](double t, Side side, VectorRef out) {
        for (Index i = 0; i < 4; ++i) out[i] = std::sin(t + static_cast<double>(i)) + (side == Side::left ? 0 : 1);
    });
    EXPECT_EQ(f.size(), 4);
    EXPECT_EQ(f.mode_count(), 0);
    EXPECT_TRUE(f.is_function() && !f.constant());
    EXPECT_EQ(f.at(0.3, Side::left)[2], std::sin(2.3));
    EXPECT_EQ(f.at(0.3)[2], std::sin(2.3) + 1);
    EXPECT_THROW((void)AffineVector::function(4, {}), InputError);
    try {
        (void)f.dense_modes("reduce: f");
        FAIL();
    } catch (const InputError& error) {
        EXPECT_EQ(std::string(error.what()).rfind("reduce: f is a function", 0), 0u) << error.what();
    }
    ContactProblem p = valid();
    p.f = f;
    expect_rejected(p, "f", "4 rows", "3");
}

TEST(AffineVector, TakesAnyColumnOfEigens) {
    const Eigen::VectorXd plain = Eigen::VectorXd::LinSpaced(3, 1, 3);
    AffineVector f = plain;
    EXPECT_EQ(f.at(0), plain);
    f = Vector::Constant(2, 7);
    EXPECT_EQ(f.at(0), Eigen::Vector2d(7, 7));
    f = 2 * plain;
    EXPECT_EQ(f.at(0), 2 * plain);
}

}  // namespace
}  // namespace tact
