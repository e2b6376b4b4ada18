// The scenes of the work-precision study: problems, sweeps, output times and what the answers are compared with.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "../../../lib/contact_solver.hpp"
#include "../../../lib/problem/contact_problem.hpp"

namespace tact::bench {

/// The motion at a scene's output times.
struct Reference {
    std::string how;         ///< in words
    DenseMatrix u;           ///< n x times
    Vector impulse;          ///< of the sum of all contact forces, from the beginning up to each time
    double own_error_u = 0;  ///< its own accuracy in the study's norms; 0: exact
    double own_error_lambda = 0;
};

struct PrecisionMethod;

struct PrecisionScene {
    std::string name, what;
    ContactProblem problem;
    std::shared_ptr<const ContactSolver> contact;
    double t_end = 0;
    std::vector<long> steps;         ///< of the grids of fixed-step methods, coarsest first
    std::vector<double> tolerances;  ///< rtol of the adaptive ones, loosest first
    long outputs = 0;                ///< output times k t_end / outputs, k from 1; divides all `steps`
    /// What this method is compared with, made when it is first asked for.
    std::function<std::shared_ptr<const Reference>(const PrecisionMethod&)> reference;
    bool gsl = false;      ///< GSL's integrators take part
    bool siconos = false;  ///< Siconos' time stepping takes part
    bool impacts = true;   ///< something closes while it approaches

    double output(long k) const { return t_end * static_cast<double>(k) / static_cast<double>(outputs); }
};

/// held-bar, free-membrane, bar-impact, bar-impact-redistributed, bouncing-bar, bouncing-bar-redistributed,
/// dynamic-obstacle, two-plates.
std::vector<std::string> precision_scene_names();
/// One of them. InputError that lists the names for another one.
PrecisionScene precision_scene(const std::string& name, bool small);

}  // namespace tact::bench
