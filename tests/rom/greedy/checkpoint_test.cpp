#include "../../../rom/greedy/checkpoint.hpp"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>

#include "../../../contact/automatic.hpp"
#include "../../../contact/dense/dense_contact.hpp"
#include "../../../integrators/sundials/bdf2.hpp"
#include "../../../lib/io/write_file.hpp"
#include "../../../lib/scenes/membrane.hpp"
#include "../../../rom/greedy/sampling.hpp"
#include "../chain.hpp"

namespace tact {
namespace {

using testing::ChainFamily;

const TrainingMethod marching{std::make_shared<Bdf2>(), TimeGrid{0.1, 60, 0}};
const TrainingContact contact{std::make_shared<AutomaticContact>(), std::make_shared<DenseContact>()};

TrainingOptions over_grid(const ContactFamily& family, int iterations) {
    TrainingOptions options;
    options.candidates = tensor_grid(family.lower(), family.upper(), {4, 4});
    options.max_iterations = iterations;
    options.sizes = [](int samples) { return BasisSizes{4 * samples, 3 * samples}; };
    return options;
}

std::filesystem::path fresh_file(const std::string& name) {
    const auto path = std::filesystem::path(::testing::TempDir()) / ("tact_" + name + std::to_string(getpid()));
    std::filesystem::remove(path);
    return path;
}

bool same(double a, double b) { return a == b || (std::isnan(a) && std::isnan(b)); }

void expect_same(const TrainingResult& a, const TrainingResult& b) {
    EXPECT_EQ(a.outcome, b.outcome);
    EXPECT_EQ(a.reason, b.reason);
    EXPECT_EQ(a.basis.U, b.basis.U);
    EXPECT_EQ(a.basis.U_lambda, b.basis.U_lambda);
    ASSERT_EQ(a.history.size(), b.history.size());
    for (std::size_t k = 0; k < a.history.size(); ++k) {
        const TrainingIteration &x = a.history[k], &y = b.history[k];
        EXPECT_EQ(x.gamma, y.gamma);
        EXPECT_EQ(x.p, y.p);
        EXPECT_EQ(x.p_lambda, y.p_lambda);
        EXPECT_EQ(x.snapshots, y.snapshots);
        EXPECT_EQ(x.dual_snapshots, y.dual_snapshots);
        EXPECT_EQ(x.residuals, y.residuals);
        EXPECT_EQ(x.warning, y.warning);
        EXPECT_EQ(x.full.accepted_steps, y.full.accepted_steps);
        EXPECT_EQ(x.full.worst_kkt.largest(), y.full.worst_kkt.largest());
        EXPECT_EQ(x.max_indicator, y.max_indicator);
        EXPECT_TRUE(std::ranges::equal(x.indicators, y.indicators, same)) << k;
    }
    const Parameter gamma = a.history[0].gamma;
    EXPECT_EQ(a.reduced->at(gamma).B.to_dense(), b.reduced->at(gamma).B.to_dense());
}

TEST(Train, IsTheSameToTheLastBitForAnyNumberOfThreads) {
    const ChainFamily moving(41), still(41, {.mass = false, .moving_load = false});
    for (const bool dynamic : {false, true}) {
        const ChainFamily& family = dynamic ? moving : still;
        TrainingOptions options = over_grid(family, 4);
        options.weights = {1, 1, 1};
        const TrainingResult one = train(family, dynamic ? marching : TrainingMethod{}, contact, options);
        ASSERT_EQ(one.outcome, Outcome::converged);
        for (const int threads : {2, 5}) {
            options.threads = threads;
            expect_same(train(family, dynamic ? marching : TrainingMethod{}, contact, options), one);
        }
    }
}

TEST(Train, KilledAnywhereGoesOnToTheSameResult) {
    const MembraneFamily membrane(24, Motion::dynamic);
    const TrainingMethod method{marching.integrator, TimeGrid::until(2, 0.02)};
    TrainingOptions options = over_grid(membrane, 4);
    const TrainingResult uninterrupted = train(membrane, method, contact, options);
    ASSERT_EQ(uninterrupted.outcome, Outcome::converged);
    options.checkpoint = fresh_file("killed");
    struct Kill {
        int iteration;
        std::string stage;
        double fraction;
    };
    const std::vector<Kill> kills{
        {1, "POD", 0}, {2, "full run", 0.5}, {2, "dual basis", 0}, {3, "candidates", 0.4}, {4, "full run", 0.9}};
    for (const Kill& kill : kills) {
        const pid_t child = fork();
        if (child == 0) {
            TrainingOptions killed = options;
            killed.observer = [&](const TrainingProgress& at) {
                if (at.iteration == kill.iteration && at.stage == kill.stage && at.fraction >= kill.fraction)
                    (void)raise(SIGKILL);
                return Flow::proceed;
            };
            (void)train(membrane, method, contact, killed);
            _exit(0);
        }
        int status = 0;
        ASSERT_EQ(waitpid(child, &status, 0), child);
        EXPECT_TRUE(WIFSIGNALED(status)) << kill.iteration << " " << kill.stage;
    }
    int first_seen = 0;
    options.observer = [&](const TrainingProgress& at) {
        if (first_seen == 0) first_seen = at.iteration;
        return Flow::proceed;
    };
    expect_same(train(membrane, method, contact, options), uninterrupted);
    EXPECT_EQ(first_seen, 4) << "only the iteration under way when it was killed is done again";
    // The whole training is in the file: no run is needed to have it.
    first_seen = 0;
    expect_same(train(membrane, method, contact, options), uninterrupted);
    EXPECT_EQ(first_seen, 0);
    std::filesystem::remove(options.checkpoint);
}

TEST(Train, GoesOnFromACheckpointWithMoreIterationsOrAnotherEpsilon) {
    const ChainFamily still(41, {.mass = false, .moving_load = false});
    TrainingOptions options = over_grid(still, 6);
    const TrainingResult whole = train(still, {}, contact, options);
    options.checkpoint = fresh_file("more");
    for (const int iterations : {2, 3, 6}) {
        options.max_iterations = iterations;
        const TrainingResult part = train(still, {}, contact, options);
        EXPECT_EQ(part.reason, StopReason::iterations);
        if (iterations == 6) expect_same(part, whole);
    }
    options.max_iterations = 5;
    EXPECT_THROW((void)train(still, {}, contact, options), InputError);
    std::filesystem::remove(options.checkpoint);
}

std::string refusal(const Shared<ContactFamily>& family, const TrainingMethod& method,
                    const TrainingOptions& options) {
    try {
        (void)train(family, method, contact, options);
    } catch (const InputError& error) {
        return error.what();
    }
    return "nothing refused";
}

TEST(Checkpoint, OfAnotherTrainingIsRefusedByName) {
    const ChainFamily moving(41), longer(43), damped(41, {.damping = true});
    TrainingOptions options = over_grid(moving, 1);
    options.checkpoint = fresh_file("other");
    ASSERT_EQ(train(moving, marching, contact, options).outcome, Outcome::converged);
    const auto expect_named = [&](const std::string& message, const std::string& name) {
        EXPECT_NE(message.find("is of another training: " + name + " is "), std::string::npos) << message;
        EXPECT_NE(message.find(options.checkpoint.string()), std::string::npos) << message;
    };
    expect_named(refusal(longer, marching, options), "unknowns");
    expect_named(refusal(damped, marching, options), "problem");
    expect_named(refusal(moving, {marching.integrator, TimeGrid{0.1, 61, 0}}, options), "grid");
    TrainingOptions other = options;
    other.candidates.pop_back();
    expect_named(refusal(moving, marching, other), "candidates");
    other = options;
    other.weights.negativity = 1;
    expect_named(refusal(moving, marching, other), "weights");
    other = options;
    other.snapshots.dual = 2;
    expect_named(refusal(moving, marching, other), "snapshots");
    other = options;
    other.pod_tolerance = 1e-3;
    expect_named(refusal(moving, marching, other), "pod");
    other = options;
    other.primal.body_of.assign(static_cast<std::size_t>(moving.at(moving.lower()).size()), 0);
    expect_named(refusal(moving, marching, other), "primal");
    std::filesystem::remove(options.checkpoint);
}

TEST(Checkpoint, CutShortOrDamagedIsRefused) {
    const ChainFamily still(41, {.mass = false, .moving_load = false});
    TrainingOptions options = over_grid(still, 2);
    options.checkpoint = fresh_file("damaged");
    ASSERT_EQ(train(still, {}, contact, options).outcome, Outcome::converged);
    const std::string whole = read_file(options.checkpoint);
    for (std::size_t k = 0; k < 40; ++k) {
        write_file(options.checkpoint, whole.substr(0, whole.size() * k / 40));
        EXPECT_NE(refusal(still, {}, options), "nothing refused") << k;
        std::string damaged = whole;
        damaged[whole.size() * k / 40] = static_cast<char>(damaged[whole.size() * k / 40] ^ 0x10);
        write_file(options.checkpoint, damaged);
        EXPECT_NE(refusal(still, {}, options), "nothing refused") << k;
    }
    write_file(options.checkpoint, whole);
    EXPECT_EQ(refusal(still, {}, options), "nothing refused");
    std::filesystem::remove(options.checkpoint);
}

}  // namespace
}  // namespace tact
