// A march from beginning to end, and all that it was.
#pragma once

#include <iosfwd>
#include <vector>

#include "../lib/time/scheme.hpp"

namespace tact {

/// One row a state, rows in one piece; memory as that of a DenseMatrix (lib/types.hpp).
using History = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor | memory>;

/// Which states of a march are kept, and what of them. Memory is that of what is kept: for n unknowns and m rows
/// 8 (2n + m) bytes a state with everything.
struct Keep {
    long stride = 1;               ///< every stride-th accepted step; 0: none by the stride
    std::vector<long> steps = {};  ///< and these, in any order
    bool initial = true;           ///< and the state before the first step
    bool u = true, v = true, lambda = true;
};

struct MarchSettings {
    Keep keep = {};
    /// Told the initial state and every accepted one, kept or not.
    std::vector<Observer> observers = {};
    InitialPenetration initial_penetration = InitialPenetration::reject;
};

/// The states kept and the report; nothing in it refers to what it was made from.
struct [[nodiscard]] March {
    MarchReport report;       ///< with the last accepted state, kept or not
    Vector times;             ///< of the states kept
    std::vector<long> steps;  ///< their numbers; 0 is the initial state
    History u;                ///< states kept x n
    History v;                ///< states kept x n; without columns unless the problem is second order
    History lambda;           ///< states kept x m; see the integrator for what it means
};

/// Steps the problem through the scheme's grid. An empty integrator is Trapezoid{} (QuasiStatic{} where there is neither M nor
/// D), an empty contact solver AutomaticContact. InputError as validate, and as the integrator says; what ended a march
/// before its end is in the report, together with the states up to there.
March march(const ContactProblem& problem, const Scheme& scheme, const MarchSettings& settings = {});

/// One line where all is well; else also what failed, what was tried and what to try.
std::ostream& operator<<(std::ostream& out, const March& march);

}  // namespace tact
