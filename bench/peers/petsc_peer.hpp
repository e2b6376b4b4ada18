// PETSc's solvers for bound-constrained problems, through a program of its own (tact-peer-petsc).
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "../studies/solvers/solver_timing.hpp"

namespace tact::bench {

struct PetscMethod {
    std::string name, family, options;  ///< family: snes or tao
    double accuracy = 1e-12;            ///< of the residual, relative to |b|
};
/// Semismooth Newton on the reduced space (SNES VINEWTONRSLS) and TAO's GPCG and TRON, each with the preconditioners that
/// serve it best on one of the problems.
const std::vector<PetscMethod>& petsc_methods();

/// The program lies beside this one where PETSc was found when it was built.
std::optional<std::string> petsc_program();

/// The row of time_solver, by the program on the same matrices: rows of B must not overlap. They become bounds: unknown j of
/// row i is replaced by B_i u, exactly, before the clock starts. The multipliers of the certificate are read off Au - b.
Json time_petsc(const SolverProblem& problem, const PetscMethod& method, const std::string& program,
                const TimingOptions& options);

}  // namespace tact::bench
