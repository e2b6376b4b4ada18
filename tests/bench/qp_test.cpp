#include "../../bench/commands/qp.hpp"

#include <gtest/gtest.h>

#include "../../bench/harness/contact_solvers.hpp"
#include "../../lib/io/write_file.hpp"

namespace tact::bench {
namespace {

namespace fs = std::filesystem;

class Qp : public testing::Test {
protected:
    void SetUp() override {
        const auto* test = testing::UnitTest::GetInstance()->current_test_info();
        root_ = fs::path(testing::TempDir()) / (std::string("tact_qp_") + test->name());
        fs::remove_all(root_);
        fs::create_directories(root_);
    }
    void TearDown() override { fs::remove_all(root_); }

    /// min u1^2 + u2^2 - u1 u2 - 2 u1 - 3 u2 with u1 >= 2, u2 switched off: u = (2, 2.5).
    void write_problem(const std::string& name, const std::string& expected = {}) const {
        const fs::path folder = root_ / name;
        write_file(folder / "A.mtx",
                   "%%MatrixMarket matrix coordinate real symmetric\n2 2 3\n1 1 2\n2 1 -1\n2 2 2\n");
        write_file(folder / "B.mtx", "%%MatrixMarket matrix coordinate real general\n2 2 2\n1 1 1\n2 2 1\n");
        write_file(folder / "b.txt", "0\n3\n");
        write_file(folder / "c.txt", "2\n-inf\n");
        if (!expected.empty()) write_file(folder / "expected.json", expected);
    }
    Json run(const std::string& solver = "chooser") const { return run_qp(root_, *contact_solver(solver)); }
    static bool says(const Json& row, const std::string& word) {
        return row.contains("message") && row["message"].get<std::string>().find(word) != std::string::npos;
    }

    fs::path root_;
};

constexpr double right_objective = 4 + 6.25 - 5 - 7.5;

TEST_F(Qp, SolvesEveryFolderAndComparesWithTheExpectedAnswer) {
    write_problem("deeper/b-list", R"({"outcome": "converged", "objective": -2.25, "u": [2, 2.5], "tolerance": 1e-9,
                                       "tolerance_u": 1e-9, "active": null, "source": "by hand"})");
    write_problem("a-file", R"({"outcome": "converged", "objective": null, "u": "u.txt", "tolerance_u": 1e-9})");
    write_file(root_ / "a-file" / "u.txt", "2\n2.5\n");
    write_problem("c-either",
                  R"({"outcome": "unbounded", "outcome_allowed": ["unbounded", "converged"], "u": null})");
    write_file(root_ / "README.md", "not a problem");
    write_file(root_ / "nor-this" / "notes.json", "[");
    for (const char* solver : {"chooser", "schur", "klu-active-set"}) {
        const Json rows = run(solver);
        ASSERT_EQ(rows.size(), 3u);
        EXPECT_EQ(rows[0]["name"], "a-file");
        EXPECT_EQ(rows[1]["name"], "c-either");
        EXPECT_EQ(rows[2]["name"], "deeper/b-list");
        for (const Json& row : rows) {
            EXPECT_EQ(row["outcome"], "converged");
            EXPECT_TRUE(row["agrees"].get<bool>()) << row;
            EXPECT_NEAR(row["objective"].get<double>(), right_objective, 1e-12);
            EXPECT_NEAR(row["u"][1].get<double>(), 2.5, 1e-12);
            EXPECT_EQ(row["kkt"].size(), 4u);
            for (const Json& residual : row["kkt"]) EXPECT_LT(residual.get<double>(), 1e-10);
            EXPECT_GE(row["seconds"].get<double>(), 0);
        }
        EXPECT_TRUE(qp_agrees(rows));
    }
}

TEST_F(Qp, AWrongExpectedAnswerDisagrees) {
    const std::vector<std::pair<std::string, std::string>> wrong{
        {R"({"outcome": "infeasible"})", "outcome"},
        {R"({"outcome": "converged", "objective": -2.26, "tolerance": 1e-6})", "objective"},
        {R"({"outcome": "converged", "u": [2, 2.6], "tolerance_u": 1e-6})", "u is"},
        {R"({"outcome": "converged", "u": [2], "tolerance_u": 1e-6})", "entries"},
        {R"({"objective": -2.25})", "outcome"},
        {R"({"outcome": )", "expected.json"},
        {R"({"outcome": "converged", "u": "absent.txt"})", "absent.txt"},
    };
    write_problem("good", R"({"outcome": "converged", "objective": -2.25})");
    for (const auto& [expected, word] : wrong) {
        write_problem("wrong", expected);
        const Json rows = run();
        ASSERT_EQ(rows.size(), 2u);
        EXPECT_TRUE(rows[0]["agrees"].get<bool>()) << "one bad problem does not end the run";
        EXPECT_FALSE(rows[1]["agrees"].get<bool>()) << expected;
        EXPECT_TRUE(says(rows[1], word)) << rows[1];
        EXPECT_FALSE(qp_agrees(rows));
        EXPECT_NE(qp_table(rows).find("NO"), std::string::npos);
    }
}

TEST_F(Qp, InfeasibleConstraintsAreAnOutcome) {
    write_problem("infeasible", R"({"outcome": "infeasible", "objective": null, "u": null, "tolerance": 1e-9})");
    write_file(root_ / "infeasible" / "B.mtx",
               "%%MatrixMarket matrix coordinate real general\n2 2 2\n1 1 1\n2 1 -1\n");
    write_file(root_ / "infeasible" / "c.txt", "1\n1\n");
    const Json row = run()[0];
    EXPECT_EQ(row["outcome"], "infeasible");
    EXPECT_TRUE(row["agrees"].get<bool>());
    EXPECT_TRUE(row["u"].is_null());
    EXPECT_TRUE(row["objective"].is_null());
    EXPECT_EQ(row["kkt"].size(), 4u);
}

/// (u - 2)^2 scaled to 1e-16: objectives agree by the size of their own terms and not by 1.
TEST_F(Qp, ComparesObjectivesOnTheProblemsOwnScale) {
    const auto write = [&](const std::string& name, const std::string& expected) {
        write_problem(name, expected);
        write_file(root_ / name / "A.mtx",
                   "%%MatrixMarket matrix coordinate real symmetric\n2 2 2\n1 1 1e-16\n2 2 1e-16\n");
        write_file(root_ / name / "b.txt", "0\n3e-16\n");
    };
    write("right", R"({"outcome": "converged", "objective": -2.5e-16, "tolerance": 1e-9})");
    write("wrong", R"({"outcome": "converged", "objective": -2.6e-16, "tolerance": 1e-3})");
    write("zero", R"({"outcome": "converged", "objective": 0, "tolerance": 1e-3})");
    const Json rows = run();
    EXPECT_TRUE(rows[0]["agrees"].get<bool>()) << rows[0];
    EXPECT_FALSE(rows[1]["agrees"].get<bool>()) << rows[1];
    EXPECT_FALSE(rows[2]["agrees"].get<bool>()) << rows[2];
}

/// Whoever reads the file can check each answer, and each proof that there is none, without us.
TEST_F(Qp, WritesMultipliersAndCertificates) {
    write_problem("solved");
    const Json solved = run()[0];
    // A u - b = B'lambda at u = (2, 2.5): 2 * 2 - 2.5 = 1.5 on the bound, nothing on the row that is off.
    EXPECT_NEAR(solved["lambda"][0].get<double>(), 1.5, 1e-12);
    EXPECT_EQ(solved["lambda"][1], 0);
    EXPECT_TRUE(solved["infeasibility"].is_null() && solved["ray"].is_null() && solved["certificate"].is_null());

    fs::remove_all(root_ / "solved");
    write_problem("excluded");
    write_file(root_ / "excluded" / "B.mtx", "%%MatrixMarket matrix coordinate real general\n2 2 2\n1 1 1\n2 1 -1\n");
    write_file(root_ / "excluded" / "c.txt", "1\n1\n");
    const Json excluded = run()[0];
    ASSERT_EQ(excluded["outcome"], "infeasible");
    const auto y = excluded["infeasibility"].get<std::vector<double>>();
    ASSERT_EQ(y.size(), 2u);
    EXPECT_TRUE(y[0] >= 0 && y[1] >= 0);
    EXPECT_NEAR(y[0] - y[1], 0, 1e-12);
    EXPECT_GT(y[0] + y[1], 0);
    EXPECT_NEAR(excluded["certificate"]["c'y"].get<double>(), y[0] + y[1], 1e-12);
    EXPECT_LE(excluded["certificate"]["B'y"].get<double>(), 1e-12);

    fs::remove_all(root_ / "excluded");
    write_problem("falling");
    write_file(root_ / "falling" / "A.mtx", "%%MatrixMarket matrix coordinate real symmetric\n2 2 1\n1 1 2\n");
    const Json falling = run()[0];  // b pulls u_2 up and nothing holds it
    ASSERT_EQ(falling["outcome"], "unbounded");
    const auto d = falling["ray"].get<std::vector<double>>();
    EXPECT_NEAR(d[0], 0, 1e-12);
    EXPECT_GT(d[1], 0);
    EXPECT_NEAR(falling["certificate"]["b'd"].get<double>(), 3 * d[1], 1e-9);
    EXPECT_LE(falling["certificate"]["A d"].get<double>(), 1e-12);
    EXPECT_GE(falling["certificate"]["least B d"].get<double>(), 0);

    fs::remove_all(root_ / "falling");
    write_problem("empty-row");
    write_file(root_ / "empty-row" / "B.mtx", "%%MatrixMarket matrix coordinate real general\n2 2 1\n2 2 1\n");
    write_file(root_ / "empty-row" / "c.txt", "0.001\n-inf\n");
    const Json empty = run()[0];
    EXPECT_EQ(empty["outcome"], "infeasible");
    EXPECT_TRUE(says(empty, "row 0 of B has no entries and c_0 is 0.001")) << empty;
}

TEST_F(Qp, WithoutAnExpectedAnswerNothingIsCompared) {
    write_problem("mine");
    const Json rows = run_qp(root_ / "mine", *contact_solver("chooser"));
    ASSERT_EQ(rows.size(), 1u);
    EXPECT_EQ(rows[0]["name"], "mine");
    EXPECT_EQ(rows[0]["outcome"], "converged");
    EXPECT_TRUE(rows[0]["agrees"].is_null());
    EXPECT_TRUE(qp_agrees(rows));
}

TEST_F(Qp, NoRowsIsAPlainLinearSolve) {
    write_problem("free", R"({"outcome": "converged", "u": [1, 2]})");
    write_file(root_ / "free" / "B.mtx", "%%MatrixMarket matrix coordinate real general\n0 2 0\n");
    write_file(root_ / "free" / "c.txt", "");
    const Json rows = run();
    EXPECT_TRUE(rows[0]["agrees"].get<bool>()) << rows;
}

TEST_F(Qp, UnsupportedAndMalformedProblemsSayWhy) {
    const std::string general = "%%MatrixMarket matrix coordinate real general\n";
    write_problem("unsymmetric", R"({"outcome": "unsupported"})");
    write_file(root_ / "unsymmetric" / "A.mtx", general + "2 2 3\n1 1 2\n2 1 -1\n2 2 2\n");
    Json rows = run();
    EXPECT_EQ(rows[0]["outcome"], "unsupported");
    EXPECT_TRUE(rows[0]["agrees"].get<bool>());
    EXPECT_TRUE(says(rows[0], "not symmetric")) << rows[0];

    const std::vector<std::array<std::string, 3>> malformed{
        {"A.mtx", general + "2 3 0\n", "square"},
        {"B.mtx", general + "2 3 0\n", "B.mtx"},
        {"B.mtx", general + "2 2 1\n3 1 1\n", "row"},
        {"b.txt", "1\n", "b.txt"},
        {"b.txt", "1\ninf\n", "b.txt"},
        {"b.txt", "1\nnan\n", "b.txt"},
        {"c.txt", "1\n2\n3\n", "c.txt"},
        {"c.txt", "1\ninf\n", "c.txt"},
    };
    for (const auto& [file, text, word] : malformed) {
        write_problem("unsymmetric");
        write_problem("bad");
        write_file(root_ / "bad" / file, text);
        rows = run();
        EXPECT_EQ(rows[0]["name"], "bad");
        EXPECT_EQ(rows[0]["outcome"], "invalid input");
        EXPECT_TRUE(says(rows[0], word)) << rows[0];
        EXPECT_FALSE(qp_agrees(rows)) << "a malformed problem is not passed over";
    }
    fs::remove(root_ / "bad" / "A.mtx");
    EXPECT_EQ(run()[0]["outcome"], "invalid input");
}

/// Throws what no solver should.
class Throws final : public ContactSolver {
public:
    std::unique_ptr<PreparedContact> prepare(const Matrix&, const Matrix&) const override { throw std::bad_alloc(); }
};

TEST_F(Qp, AnExceptionInOneProblemIsReportedAndTheRunGoesOn) {
    write_problem("one");
    write_problem("two");
    const Json rows = run_qp(root_, Throws());
    ASSERT_EQ(rows.size(), 2u);
    EXPECT_EQ(rows[1]["outcome"], "failed");
    EXPECT_FALSE(qp_agrees(rows));
}

TEST_F(Qp, RejectsFoldersWithoutProblemsAndUnknownSolvers) {
    EXPECT_THROW(run(), InputError);
    EXPECT_THROW(run_qp(root_ / "absent", *contact_solver("chooser")), InputError);
    EXPECT_THROW(contact_solver("simplex"), InputError);
}

}  // namespace
}  // namespace tact::bench
