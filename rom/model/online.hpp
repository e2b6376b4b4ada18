// Queries of a reduced model, one or many at once.
#pragma once

#include <memory>
#include <span>

#include "../../lib/time/registry.hpp"
#include "build_reduced_model.hpp"
#include "error_check.hpp"

namespace tact {

/// What the model's ReducedMethod describes, made by the caller. No integrator: static.
struct OnlineMethod {
    std::shared_ptr<const ContactSolver> contact;
    std::shared_ptr<const Integrator> integrator;
};

/// What the model names, made by the caller's registry (the one of component tact, or one with a user's own methods).
/// InputError if the registry does not know the integrator.
OnlineMethod online_method(const ReducedModel& model, const Registry& registry);

/// Answers where the reduced model is not to be trusted or fails.
struct FullModel {
    std::shared_ptr<const ContactFamily> family;
    std::shared_ptr<const ContactSolver> contact;
    std::vector<QuantityOfInterest> quantities;  ///< the model's, in the same order
};

struct OnlineOptions {
    long stride = 1;  ///< of the steps at which quantities and states are kept; the first and the last always
    bool keep_states = false;  ///< q and s at these steps, for lifting
    std::optional<FullModel> fall_back = {};
};

/// How far an answer can be trusted.
struct Trust {
    bool outside_box = false;
    double penetration = 0, residual = 0;  ///< P and R of ErrorChecks
    std::optional<double> estimate;  ///< of the relative error; empty without calibration, infinite outside the box
    bool doubtful = false;           ///< outside the box, or the estimate exceeds the model's tolerance
};

/// The answer at one gamma.
struct [[nodiscard]] Answer {
    Outcome outcome = Outcome::converged;
    std::string
        failure;  ///< the message where a library refused or the gap was not finite (the outcome is `inaccurate`)
    long failed_step = 0;       ///< of a march that did not converge
    KktResiduals kkt;           ///< the worst of all steps
    State state;                ///< the last: q, its rate and s
    std::vector<double> times;  ///< statics: 0
    DenseMatrix quantities;     ///< one row a quantity, one column a time
    DenseMatrix q, s;           ///< one column a time, if states are kept
    Trust trust;                ///< of the reduced answer
    std::optional<State>
        full;  ///< where the full model answered: its last state; outcome, kkt and quantities are its as well
};

/// Answers queries from a model. Each answer starts cold, so it depends on its gamma alone: the same bits in any order and
/// for any number of threads.
class Online {
public:
    /// InputError unless the integrator's name is the one the model was trained with, and the fall-back fits it.
    Online(std::shared_ptr<const ReducedModel> model, OnlineMethod method, OnlineOptions options = {});
    ~Online();

    /// InputError unless gamma holds one finite number a parameter. One thread at a time.
    Answer query(const Parameter& gamma);
    /// As query at each of them, on so many threads (1 or more). Answers that fail say so and stop no other. The model's
    /// ExactFunctions and the fall-back's family are then called by all threads at once.
    std::vector<Answer> solve_many(std::span<const Parameter> gammas, int threads = 1) const;

private:
    class Worker;
    void check(const Parameter& gamma, const std::string& name) const;
    std::shared_ptr<const ReducedModel> model_;
    OnlineMethod method_;
    OnlineOptions options_;
    std::unique_ptr<Worker> worker_;
};

}  // namespace tact
