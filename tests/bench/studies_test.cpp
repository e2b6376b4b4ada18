#include "../../bench/commands/all.hpp"

#include <gtest/gtest.h>
#include <sched.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <fstream>
#include <iterator>
#include <set>
#include <stdexcept>
#include <thread>

#include "../../bench/commands/report.hpp"
#include "../../bench/harness/beside.hpp"
#include "../../bench/harness/interrupt.hpp"
#include "../../bench/harness/isolated.hpp"
#include "../../bench/harness/report.hpp"
#include "../../lib/errors.hpp"
#include "../../lib/io/write_file.hpp"

namespace tact::bench {
namespace {

constexpr std::chrono::milliseconds a_moment(20);

class Studies : public testing::Test {
protected:
    Studies() {
        // Tests run side by side, each in a process of its own.
        folder_ = std::filesystem::path(testing::TempDir()) / ("tact_studies_test_" + std::to_string(getpid()));
        std::filesystem::create_directories(folder_);
    }
    ~Studies() override { std::filesystem::remove_all(folder_); }
    std::string read(const std::string& name) const {
        std::ifstream file(folder_ / name);
        return {std::istreambuf_iterator<char>(file), {}};
    }
    bool there(const std::string& name) const { return std::filesystem::exists(folder_ / name); }
    AllOptions options(std::vector<std::string> only = {}) const {
        return {.small = true, .repeats = 1, .out = folder_, .only = std::move(only)};
    }
    /// Never written: what it does is all there is of it.
    static Study acting(std::string name, Measured measured, std::function<void()> act) {
        return {.name = std::move(name),
                .about = "acts",
                .measured = measured,
                .run = [act = std::move(act)](const StudyArguments&) -> Json {
                    act();
                    throw std::runtime_error("it only acts");
                }};
    }
    std::filesystem::path folder_;
};

TEST_F(Studies, FinishedOnesAreKeptAndThePageShowsWhatTheirJsonSays) {
    testing::internal::CaptureStdout();
    ASSERT_EQ(run_all(options({"speedup"})), 0);
    Json json = Json::parse(read("speedup.json"));
    EXPECT_GT(json["study_seconds"], 0);
    json["rows"][0]["speedup"] = 123456.0;
    write_file(folder_ / "speedup.json", json.dump());
    EXPECT_EQ(run_all(options({"speedup"})), 0);
    EXPECT_NE(testing::internal::GetCapturedStdout().find("speedup: kept"), std::string::npos);
    write_page(folder_);
    const std::string page = read("index.html");
    EXPECT_NE(page.find("120\u2009000"), std::string::npos) << "two digits of the number put into the json";
    EXPECT_NE(page.find("<svg"), std::string::npos);
    EXPECT_EQ(page.find("http://localhost"), std::string::npos);
    EXPECT_NE(page.find("tact-bench all --only stability"), std::string::npos) << "what was not run is said";
}

/// Each is told apart by its name, which is that of its folder and its files, and can be run, shown and drawn.
TEST_F(Studies, EachIsRegisteredOnceWithAllItsParts) {
    std::set<std::string> names;
    const std::filesystem::path folders = bench_folder() / "studies";
    for (const Study& study : studies()) {
        EXPECT_TRUE(names.insert(study.name).second) << study.name;
        EXPECT_FALSE(study.about.empty()) << study.name;
        EXPECT_TRUE(study.run && study.table && study.markdown) << study.name;
        std::string folder = study.name;
        std::ranges::replace(folder, '-', '_');
        EXPECT_TRUE(std::filesystem::exists(folders / folder / "figure.py")) << study.name;
        for (const StudyOption& option : study.options)
            EXPECT_EQ(option.kind == StudyOption::Kind::choice, !option.choices.empty()) << option.name;
    }
    const auto rooms = std::ranges::count_if(std::filesystem::directory_iterator(folders),
                                             [](const auto& entry) { return entry.is_directory(); });
    EXPECT_EQ(names.size(), static_cast<std::size_t>(rooms)) << "a folder that is not registered";
}

/// The published pages are what the code makes of the published numbers.
TEST_F(Studies, PublishedPagesFollowFromTheirJson) {
    const std::filesystem::path results = bench_folder() / "../docs/results";
    for (const Study& study : studies()) {
        const Json json = Json::parse(read_file(results / (study.name + ".json")));
        EXPECT_EQ(study.markdown(json), read_file(results / (study.name + ".md")))
            << "tact-bench report --studies --out docs/results";
    }
}

TEST_F(Studies, OtherNamesAreRejected) {
    EXPECT_THROW(run_all({.out = folder_, .only = {"speedup", "speeddown"}}), InputError);
    std::filesystem::remove_all(folder_);
    EXPECT_THROW(write_page(folder_), NumericalError) << "nothing to make a page of";
}

TEST_F(Studies, ResultsBesideAnotherStudyAreThoseAlone) {
    std::vector<Study> all;
    for (const Study& study : studies())
        if (study.name == "downsampling") all.push_back(study);
    ASSERT_EQ(all.size(), 1u);
    const auto result = [&] {
        Json json = Json::parse(read("downsampling.json"));
        json.erase("study_seconds");
        json["machine"].erase("date");
        return json;
    };
    testing::internal::CaptureStdout();
    testing::internal::CaptureStderr();
    ASSERT_EQ(run_all(options(), all), 0);
    const Json alone = result();
    std::filesystem::remove(folder_ / "downsampling.json");
    all.push_back(acting("timed", Measured::cpu_time, [this] {
        while (Beside::possible() && !there("downsampling.svg")) std::this_thread::sleep_for(a_moment);
    }));
    std::filesystem::remove(folder_ / "downsampling.svg");
    EXPECT_EQ(run_all(options(), all), 1) << "the other one only acts";
    EXPECT_NE(testing::internal::GetCapturedStdout().find("downsampling: "), std::string::npos);
    EXPECT_NE(testing::internal::GetCapturedStderr().find("timed: it only acts"), std::string::npos);
    EXPECT_EQ(result(), alone);
}

TEST_F(Studies, AFailureOnEitherSideStopsNothing) {
    const auto leaves = [&](const std::string& name) { return [&, name] { write_file(folder_ / name, ""); }; };
    testing::internal::CaptureStderr();
    EXPECT_EQ(run_all(options(),
                      {acting("a", Measured::errors, leaves("a")), acting("b", Measured::cpu_time, leaves("b")),
                       acting("c", Measured::errors, leaves("c")), acting("d", Measured::elapsed_time, leaves("d"))}),
              4);
    const std::string said = testing::internal::GetCapturedStderr();
    for (const std::string name : {"a", "b", "c", "d"}) {
        EXPECT_TRUE(there(name));
        EXPECT_NE(said.find("tact-bench: " + name + ": it only acts"), std::string::npos) << said;
    }
}

TEST_F(Studies, AStudyThatCrashesBesideIsSaid) {
    if (!Beside::possible()) GTEST_SKIP() << "one core";
    testing::internal::CaptureStderr();
    EXPECT_EQ(run_all(options(), {acting("a", Measured::errors, [] { raise(SIGKILL); }),
                                  acting("b", Measured::cpu_time, [] {})}),
              2);
    EXPECT_NE(testing::internal::GetCapturedStderr().find("a: ended by signal 9"), std::string::npos);
}

/// Processors, nice value, and whether the one beside still runs, of each of three kinds.
TEST_F(Studies, WhatIsTimedSharesNoProcessor) {
    if (!Beside::possible()) GTEST_SKIP() << "one core";
    cpu_set_t before, beside, timed, elapsed;
    ASSERT_EQ(sched_getaffinity(0, sizeof before, &before), 0);
    testing::internal::CaptureStderr();
    (void)run_all(
        options(),
        {acting("errors", Measured::errors,
                [&] {
                    (void)sched_getaffinity(0, sizeof beside, &beside);
                    std::ofstream(folder_ / "beside").write(reinterpret_cast<char*>(&beside), sizeof beside);
                    std::ofstream(folder_ / "nice") << getpriority(PRIO_PROCESS, 0);
                    while (!there("timed")) std::this_thread::sleep_for(a_moment);
                    write_file(folder_ / "ended", "");
                }),
         acting("timed", Measured::cpu_time,
                [&] {
                    (void)sched_getaffinity(0, sizeof timed, &timed);
                    write_file(folder_ / "timed", "");
                }),
         acting("elapsed", Measured::elapsed_time, [&] {
             EXPECT_TRUE(there("ended")) << "elapsed times want the whole machine";
             (void)sched_getaffinity(0, sizeof elapsed, &elapsed);
         })});
    (void)testing::internal::GetCapturedStderr();
    std::ifstream(folder_ / "beside").read(reinterpret_cast<char*>(&beside), sizeof beside);
    cpu_set_t both;
    CPU_AND(&both, &beside, &timed);
    EXPECT_EQ(CPU_COUNT(&both), 0);
    EXPECT_EQ(CPU_COUNT(&beside), 1);
    EXPECT_GT(CPU_COUNT(&timed), 0);
    EXPECT_TRUE(CPU_EQUAL(&elapsed, &before)) << "given back";
    EXPECT_EQ(read("nice"), "19");
}

/// The signal goes to this process alone, as from `kill`; Ctrl-C reaches both.
TEST_F(Studies, AnInterruptEndsBothSides) {
    const auto endless = [&](const std::string& name) {
        return [this, name] {
            write_file(folder_ / name, std::to_string(getpid()));
            for (;; std::this_thread::sleep_for(a_moment)) throw_if_interrupted();
        };
    };
    const Json found = isolated(
        [&]() -> Json {
            catch_interrupts();
            std::thread signals([this] {
                while (!there("timed") || (Beside::possible() && !there("beside")))
                    std::this_thread::sleep_for(a_moment);
                kill(getpid(), SIGINT);
            });
            bool thrown = false;
            try {
                (void)run_all(options(), {acting("beside", Measured::errors, endless("beside")),
                                          acting("timed", Measured::cpu_time, endless("timed"))});
            } catch (const Interrupted&) {
                thrown = true;
            }
            signals.join();
            return {{"thrown", thrown}, {"no_child", waitpid(-1, nullptr, 0) < 0 && errno == ECHILD}};
        },
        60);
    EXPECT_TRUE(found.value("thrown", false)) << found;
    EXPECT_TRUE(found.value("no_child", false)) << found;
}

}  // namespace
}  // namespace tact::bench
