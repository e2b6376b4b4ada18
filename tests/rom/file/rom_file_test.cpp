#include "../../../rom/file/rom_file.hpp"

#include <gtest/gtest.h>

#include "../../../contact/dense/dense_contact.hpp"
#include "../../../integrators/sundials/bdf2.hpp"
#include "../../../lib/io/hdf5_image.hpp"
#include "../../../lib/io/write_file.hpp"
#include "../../../lib/scenes/membrane.hpp"
#include "../../../rom/greedy/greedy.hpp"
#include "../../../rom/greedy/sampling.hpp"
#include "../../../rom/model/build_reduced_model.hpp"
#include "../chain.hpp"

namespace tact {
namespace {

/// Tests run side by side: each has files of its own.
std::filesystem::path somewhere(const std::string& name) {
    const auto* test = ::testing::UnitTest::GetInstance()->current_test_info();
    return std::filesystem::path(::testing::TempDir()) / ("tact_" + std::string(test->name()) + "_" + name);
}

/// The static membrane at small size, trained at six parameters.
const ReducedModelData& membrane_model() {
    static const ReducedModelData data = [] {
        const MembraneFamily family(20);
        TrainingOptions options;
        options.max_iterations = 6;
        options.candidates = tensor_grid(family.lower(), family.upper(), {5, 4});
        const TrainingResult result =
            train(family, {}, {std::make_shared<DenseContact>(), std::make_shared<DenseContact>()}, options);
        ReducedModelOptions model;
        QuantityOfInterest centre{"u(.5,.5)", Vector::Zero(400), {}};
        centre.displacement[210] = 1;
        model.quantities = {centre, {"contact force", {}, Vector::Ones(400)}};
        model.check_rows = {150, 210, 230};
        model.check_unknowns = {100, 210};
        for (const TrainingIteration& iteration : result.history) {
            model.training.samples.push_back(iteration.gamma);
            model.training.max_indicators.push_back(iteration.max_indicator);
        }
        model.training.stop_reason = to_string(result.reason);
        return build_reduced_model(family, result.basis, model);
    }();
    return data;
}

TEST(RomFile, LoadedStaticModelAnswersToTheSameBits) {
    const auto path = somewhere("membrane.rom");
    save_reduced_model(path, membrane_model());
    const ReducedModel saved(membrane_model()), loaded(load_reduced_model(path));
    ContactWorkspace a(std::make_shared<DenseContact>()), b(std::make_shared<DenseContact>());
    Index touched = 0;
    for (const Parameter& gamma : spread_points(saved.lower(), saved.upper(), 40)) {
        const StaticSolution x = solve_static(saved.at(gamma), a), y = solve_static(loaded.at(gamma), b);
        ASSERT_EQ(x.report.outcome, Outcome::converged);
        EXPECT_EQ(x.u, y.u);
        EXPECT_EQ(x.lambda, y.lambda);
        touched += x.report.active > 0;
    }
    EXPECT_GT(touched, 20);
    EXPECT_EQ(loaded.data().basis.U, membrane_model().basis.U);
    EXPECT_EQ(loaded.data().training.samples, membrane_model().training.samples);
    EXPECT_EQ(loaded.data().quantities.names, membrane_model().quantities.names);
    // What is saved again is the same file.
    save_reduced_model(somewhere("again.rom"), loaded.data());
    EXPECT_EQ(read_file(path), read_file(somewhere("again.rom")));
}

TEST(RomFile, LoadedMarchAnswersToTheSameBits) {
    const ContactProblem full = testing::chain(24, -0.02, {.damping = true});
    const ReducedBasis basis = modal_basis(full, {testing::scattered(24, 6), testing::scattered(12, 4).cwiseAbs()});
    ReducedModelOptions options;
    options.method = {Bdf2().name(), TimeGrid::until(6, 0.05), 0.3, false};
    const ReducedModelData data = build_reduced_model(SingleProblem(full), basis, options);
    const auto path = somewhere("chain.rom");
    save_reduced_model(path, data);
    const ReducedModel loaded(load_reduced_model(path));
    const ReducedMethod& method = loaded.data().method;
    EXPECT_EQ(method.integrator, "bdf2");
    EXPECT_EQ(method.compliance, 0.3);
    ContactWorkspace contact(std::make_shared<DenseContact>());
    const MarchReport a = integrate(Bdf2(), loaded.at({}), method.grid, contact);
    const MarchReport b = integrate(Bdf2(), ReducedModel(data).at({}), options.method.grid, contact);
    ASSERT_EQ(a.outcome, Outcome::converged);
    EXPECT_GT(a.most_active, 0);
    EXPECT_EQ(a.final_state.y, b.final_state.y);
}

TEST(RomFile, RefusesDamagedFiles) {
    const auto path = somewhere("damaged.rom");
    save_reduced_model(path, membrane_model());
    const std::string whole = read_file(path);
    for (std::size_t k = 0; k < whole.size(); k += 1 + whole.size() / 40) {
        std::string damaged = whole;
        damaged[k] = static_cast<char>(damaged[k] ^ 1);
        write_file(path, damaged);
        EXPECT_THROW((void)load_reduced_model(path), InputError) << k;
        write_file(path, whole.substr(0, k));
        EXPECT_THROW((void)load_reduced_model(path), InputError) << k;
    }
}

TEST(RomFile, RefusesForeignFilesAndOtherVersions) {
    const auto path = somewhere("foreign.rom");
    EXPECT_THROW((void)load_reduced_model(somewhere("no such file")), InputError);
    write_file(path, "some text");
    EXPECT_THROW((void)load_reduced_model(path), InputError);
    std::string image;
    {
        Hdf5Writer writer;
        writer.write("x", Vector(Vector::Ones(3)));
        image = writer.image();
    }
    write_file(path, image);
    EXPECT_THROW((void)load_reduced_model(path), InputError);
    write_sealed_file(path, reduced_model_file, "somebody", image);
    EXPECT_THROW((void)load_reduced_model(path), InputError);
    write_sealed_file(path, {reduced_model_file.name, reduced_model_file.version + 1}, "tact", image);
    EXPECT_THROW((void)load_reduced_model(path), InputError);
}

TEST(RomFile, WithABrokenModelLeavesTheOldFile) {
    const auto path = somewhere("kept.rom");
    save_reduced_model(path, membrane_model());
    const std::string before = read_file(path);
    EXPECT_THROW(save_reduced_model(path / "below a file", membrane_model()), InputError);
    EXPECT_EQ(read_file(path), before);
}

}  // namespace
}  // namespace tact
