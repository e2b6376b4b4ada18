// Full runs at test parameters, marched once and compared with many reduced models.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "measure.hpp"

namespace tact::bench {

/// Errors of one reduced model at the test parameters.
struct ReducedErrors {
    std::vector<double> squared_percent;  ///< eq. 16 or 17 as printed, one a parameter
    double penetration = 0;               ///< largest, in units of the gap scale max |c|
    double worst_kkt = 0;
    Outcome outcome = Outcome::converged;  ///< of the first run that failed; the numbers are then those before it
    Parameter failed;

    double worst() const;
    double median() const;
};

/// A dual basis of either sign closes rows that are open: its initial penetration is accepted.
MarchOptions march_options(const ReducedBasis& basis);

/// Holds the full states at every step, in single precision: errors are good to 1e-12 % of |u|^2 and penetrations to 1e-7 of
/// |u|; n x (steps + 1) x 4 bytes a parameter.
class ReferenceRuns {
public:
    /// Marches, or solves, at every gamma. InputError for a gap that varies in time; NumericalError if a run fails;
    /// Interrupted.
    ReferenceRuns(const StudyScene& scene, const Scheme& scheme, std::vector<Parameter> gammas);

    /// Runs the reduced model at the same parameters, in two threads; the same numbers on one core.
    ReducedErrors errors(const ReducedBasis& basis, const ContactFamily& reduced,
                         std::shared_ptr<const ContactSolver> contact) const;
    const std::vector<Parameter>& parameters() const { return gammas_; }

private:
    using Single = Eigen::MatrixXf;
    struct Run {
        Single u;  // n x times
        double squared_norm = 0;
        Eigen::VectorXf gap;
        double gap_scale = 0;
    };
    struct Images {
        Single U, B_U;
        bool nodal = false;  // both are the same
    };
    void add_error(std::size_t k, const ReducedBasis& basis, const ContactFamily& reduced, const Images& images,
                   ContactWorkspace& workspace, ReducedErrors& result) const;

    StudyScene scene_;
    Scheme scheme_;
    std::vector<Parameter> gammas_;
    std::vector<Run> runs_;
};

}  // namespace tact::bench
