#include "../../door/registry.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "../../integrators/quasi_static.hpp"
#include "../../integrators/sundials/ida.hpp"
#include "../../integrators/trapezoid.hpp"

namespace tact {
namespace {

std::string refusal(const std::function<void()>& call) {
    try {
        call();
    } catch (const InputError& error) {
        return error.what();
    }
    return "nothing was refused";
}

bool holds(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

/// The march of one mass that falls on a stop and swings back, or its first-order or static likeness: what tells two
/// integrators apart.
Vector fingerprint(const Integrator& method) {
    const bool is_static = dynamic_cast<const QuasiStatic*>(&method) != nullptr;
    ContactProblem p;
    p.K = Matrix(DenseMatrix{{3.0, -1.0}, {-1.0, 2.0}});
    p.B = Matrix(DenseMatrix{{1.0, 0.0}});
    p.c = Vector(Vector::Constant(1, -0.05));
    p.f = {DenseMatrix{{-1.0}, {0.5}}, [](double t, Side, VectorRef out) { out[0] = 1 + t; }};
    if (!is_static) {
        p.M = Matrix::identity(2);
        p.u0 = Vector::Zero(2);
        p.v0 = Vector::Zero(2);
    }
    const MarchReport march = integrate(method, p, TimeGrid{0.05, 40}, ContactWorkspace(registry().contact("dense")));
    Vector all(march.final_state.y.size() + 2);
    all << march.final_state.y, static_cast<double>(march.accepted_steps), march.final_state.lambda.sum();
    return all;
}

// Every name, alone and with each option that it lists, off its default.
std::vector<std::string> texts() {
    std::vector<std::string> all = registry().integrators();
    for (const char* text : {"bdf2-without-jump:e=0.5",
                             "central-difference:e=0.3333333333333333",
                             "moreau-jean:theta=0.75",
                             "moreau-jean:theta=1,e=1",
                             "trapezoid:rho=0.1",
                             "trapezoid:e=0.1",
                             "trapezoid:rho=0.7,e=1e-3",
                             "ida:rtol=1e-5",
                             "ida:rtol=1e-5,atol=1.2345678901234567e-09",
                             "ida:order=1",
                             "ida:e=0.25",
                             "ida:first_step=1e-4,max_step=0.02",
                             "ida:most_steps=7",
                             "sdirk2:e=0",
                             "sdirk2:e=0.5",
                             "sdirk2:rtol=1e-3",
                             "tr-bdf2:rtol=1e-5,atol=1e-6",
                             "esdirk32:atol=1e-5,e=0",
                             "sdirk54:rtol=1e-4,max_step=0.01",
                             "sdirk54:most_steps=9",
                             "esdirk32:first_step=1e-5"})
        all.emplace_back(text);
    return all;
}

TEST(Registry, NamesReadBackAsTheSameIntegrator) {
    for (const std::string& text : texts()) {
        const Shared<Integrator> made = registry().integrator(text);
        const Shared<Integrator> again = registry().integrator(made->name());
        EXPECT_EQ(again->name(), made->name()) << text;
        EXPECT_EQ(again->adaptive(), made->adaptive()) << text;
        const Vector first = fingerprint(*made), second = fingerprint(*again);
        EXPECT_TRUE(first == second) << text << " is read back as " << made->name();
    }
}

TEST(Registry, NamesTellIntegratorsApart) {
    std::vector<std::string> names;
    for (const std::string& text : texts()) names.push_back(registry().integrator(text)->name());
    std::sort(names.begin(), names.end());
    EXPECT_EQ(std::adjacent_find(names.begin(), names.end()), names.end());
    EXPECT_EQ(registry().integrator("ida:newton=1")->name(), "ida:rtol=1e-04,atol=1e-07,newton=1");
    EXPECT_EQ(registry().integrator("trapezoid")->name(), "trapezoid:e=0");
    EXPECT_EQ(registry().integrator("ida")->name(), Ida().name());
    EXPECT_EQ(registry().integrator("ida-fixed")->name(), Ida::fixed_step().name());
    EXPECT_EQ(Trapezoid().name(), "trapezoid:e=0");
}

TEST(Registry, MakesEveryContactSolver) {
    const Matrix A = Matrix::diagonal(Vector{{2.0, 4.0}});
    const Matrix B(SparseMatrix(DenseMatrix{{1.0, 0.0}, {0.0, 1.0}}.sparseView()));
    const Vector b{{-2.0, 4.0}}, c{{-0.5, -0.5}};
    for (const std::string& name : registry().contacts()) {
        if (name == "refined") continue;  // around another
        Vector u = Vector::Zero(2), lambda = Vector::Zero(2);
        const Matrix& given = A;
        const ContactReport report = registry().contact(name)->prepare(given, B)->solve(b, c, {u, lambda});
        ASSERT_EQ(report.outcome, Outcome::converged) << name;
        EXPECT_NEAR(u[0], -0.5, 1e-12) << name;
        EXPECT_NEAR(u[1], 1, 1e-12) << name;
        EXPECT_NEAR(lambda[0], 1, 1e-12) << name;
    }
}

TEST(Registry, UnknownNamesAreAnsweredWithTheNearestAndAll) {
    const auto integrator = [](const char* text) { return refusal([&] { (void)registry().integrator(text); }); };
    for (const auto& [wrong, right] :
         {std::pair("trapezoi", "trapezoid"), std::pair("trapzeoid:e=0", "trapezoid"), std::pair("BDF2", "bdf2"),
          std::pair("bdf-2", "bdf2"), std::pair("central-differences", "central-difference"),
          std::pair("moreau_jean", "moreau-jean"), std::pair("sdirk45", "sdirk54"),
          std::pair("quasistatic", "quasi-static")})
        EXPECT_TRUE(holds(integrator(wrong), std::string("did you mean ") + right + "?")) << integrator(wrong);
    for (const std::string& name : registry().integrators()) EXPECT_TRUE(holds(integrator("x"), name));
    EXPECT_FALSE(holds(integrator("newmark-beta-method"), "did you mean"));
    EXPECT_TRUE(holds(refusal([] { (void)registry().contact("shur"); }), "did you mean schur?"));
    EXPECT_TRUE(holds(integrator(""), "expected one of"));
}

TEST(Registry, OptionsAreReadStrictly) {
    const auto refused = [](const char* text, const char* part) {
        const std::string said = refusal([&] { (void)registry().integrator(text); });
        EXPECT_TRUE(holds(said, part)) << text << ": " << said;
    };
    refused("trapezoid:roh=0.5", "did you mean rho?");
    refused("trapezoid:E=0", "expected one of rho, e");
    refused("bdf2:e=0", "expected none");
    refused("sdirk2:rto=1e-3", "did you mean rtol?");
    for (const char* text :
         {"trapezoid:", "trapezoid:e", "trapezoid:e=", "trapezoid:e=0,", "trapezoid:,e=0", "trapezoid:e=0x1",
          "trapezoid:e=0.5 ", "trapezoid:e= 0.5", "trapezoid:e=+1", "trapezoid:e=0;rho=1", "trapezoid:e=0.1.2",
          "trapezoid:e=nan", "trapezoid:=0", "trapezoid:e=1e999", "trapezoid:e=0,5"})
        refused(text, "expected NAME=NUMBER");
    refused("trapezoid:e=0,e=0", "comes twice");
    refused("ida:order=2.5", "no whole number");
    refused("ida:order=1e10", "order");
    refused("ida:most_steps=1e300", "no whole number");
    refused("ida:newton=2", "expected 0 or 1");
    refused("trapezoid:e=2", "restitution");
    refused("trapezoid:rho=-1", "rho");
    refused("ida:rtol=0", "rtol");
    refused("ida:rtol=inf", "rtol");
    EXPECT_TRUE(
        holds(refusal([] {
                  (void)registry().contact("dense:compliance=-1")->prepare(Matrix::identity(1), Matrix::identity(1));
              }),
              "compliance"));
}

TEST(Registry, ACopyTakesAUsersOwn) {
    Registry mine = registry();
    mine.add_integrator("mine", [](NamedOptions& given) { return Trapezoid({given.number("damping", 1), 0}); });
    mine.add_contact("mine", [](NamedOptions&) { return registry().contact("dense"); });
    EXPECT_EQ(mine.integrator("mine:damping=0.5")->name(), "trapezoid:rho=0.5,e=0");
    EXPECT_NE(mine.contact("mine"), nullptr);
    EXPECT_THROW((void)registry().integrator("mine"), InputError);
    const auto make = [](NamedOptions&) { return Trapezoid(); };
    EXPECT_THROW(mine.add_integrator("mine", make), InputError);
    EXPECT_THROW(mine.add_integrator("", make), InputError);
    EXPECT_THROW(mine.add_integrator("a:b", make), InputError);
    EXPECT_THROW(mine.add_integrator("other", nullptr), InputError);
}

TEST(Registry, TheNearestNameIsByTheFewestEdits) {
    const std::vector<std::string> names{"alpha", "alphabet", "beta"};
    EXPECT_EQ(nearest_name("alpah", names), "alpha");  // a swap is one edit
    EXPECT_EQ(nearest_name("alphabte", names), "alphabet");
    EXPECT_EQ(nearest_name("bta", names), "beta");
    EXPECT_EQ(nearest_name("gamma", {"omega"}), "");
    EXPECT_EQ(nearest_name("", names), "");
}

}  // namespace
}  // namespace tact
