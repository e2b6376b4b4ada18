// Every contact strategy with what it takes: what the laws, the generated programmes and the fuzzer run over.
#pragma once

#include <memory>
#include <ostream>
#include <vector>

#include "../../contact/automatic.hpp"
#include "../../contact/dense/dense_contact.hpp"
#include "../../contact/dense/orthogonal_contact.hpp"
#include "../../contact/strategies/colour_sor.hpp"
#include "../../contact/strategies/interior_point.hpp"
#include "../../contact/strategies/klu_active_set.hpp"
#include "../../contact/strategies/multigrid_active_set.hpp"
#include "../../contact/strategies/principal_pivoting.hpp"
#include "../../contact/strategies/projected_cg.hpp"
#include "../../contact/strategies/refined_contact.hpp"
#include "../../contact/strategies/schur_contact.hpp"
#include "quadratic_programs.hpp"

namespace tact::laws {

struct Strategy {
    const char* name;
    std::shared_ptr<const ContactSolver> solver;
    std::vector<Rows> takes;
    bool always_ends;  // a plain active set may come back to a set, and then says so
    bool unsymmetric = false;
    friend void PrintTo(const Strategy& strategy, std::ostream* out) { *out << strategy.name; }
};

inline std::vector<Strategy> strategies() {
    const std::vector<Rows> all{Rows::bounds, Rows::pairs, Rows::general};
    return {
        {"KluActiveSet", std::make_shared<KluActiveSet>(), all, false, true},
        {"SchurContact", std::make_shared<SchurContact>(), all, true},
        {"DenseContact", std::make_shared<DenseContact>(), all, true},
        {"OrthogonalContact", std::make_shared<OrthogonalContact>(), all, true},
        {"InteriorPoint", std::make_shared<InteriorPoint>(std::make_shared<OrthogonalContact>()), all, true},
        {"ProjectedCg", std::make_shared<ProjectedCg>(), {Rows::bounds, Rows::pairs}, false},
        {"ColourSor", std::make_shared<ColourSor>(), {Rows::bounds}, true},
        {"MultigridActiveSet", std::make_shared<MultigridActiveSet>(), {Rows::bounds}, false},
        {"PrincipalPivoting", std::make_shared<PrincipalPivoting>(), all, true, true},
        {"AutomaticContact", std::make_shared<AutomaticContact>(), all, true, true},
        {"RefinedContact", std::make_shared<RefinedContact>(std::make_shared<AutomaticContact>()), all, true, true}};
}

struct Solved {
    ContactReport report;
    Vector u, lambda;
};

/// From u = 0 and this guess of lambda.
inline Solved solve(const ContactSolver& solver, const Matrix& A, const Matrix& B, const Vector& b, const Vector& c,
                    const Vector& guess) {
    Solved s{{}, Vector::Zero(A.rows()), guess};
    s.report = solver.prepare(A, B)->solve(b, c, {s.u, s.lambda});
    return s;
}

}  // namespace tact::laws
