#include "../../bench/commands/command.hpp"

#include <gtest/gtest.h>

#include <CLI/CLI.hpp>
#include <algorithm>

#include "../../bench/commands/study.hpp"
#include "../../lib/errors.hpp"

namespace tact::bench {
namespace {

/// A study that says what it was asked for, run with a command line.
Json asked(const std::vector<std::string>& words) {
    Json seen;
    const Study study{.name = "asked",
                      .about = "says what it is asked",
                      .takes_repeats = true,
                      .options = {{.name = "scenes", .about = "names"},
                                  {.name = "methods", .about = "with blanks between", .delimiter = 0},
                                  {.name = "bases",
                                   .about = "one of two",
                                   .kind = StudyOption::Kind::choice,
                                   .choices = {"both", "one"}},
                                  {.name = "peers", .about = "yes or no", .kind = StudyOption::Kind::flag}},
                      .run = [&](const StudyArguments& arguments) -> Json {
                          seen = {{"small", arguments.small},
                                  {"repeats", arguments.repeats},
                                  {"by_all", arguments.by_all},
                                  {"scenes", arguments.list("scenes")},
                                  {"methods", arguments.list("methods")},
                                  {"bases", arguments.choice("bases", "both")},
                                  {"peers", arguments.flag("peers")}};
                          throw InputError("seen");
                      }};
    CLI::App app;
    const Command command = study_command(study);
    CLI::App* subcommand = app.add_subcommand(command.name, command.about);
    subcommand->callback([run = command.declare(*subcommand)] { (void)run(); });
    std::vector<std::string> line{"asked", "--out", testing::TempDir()};
    line.insert(line.end(), words.begin(), words.end());
    std::ranges::reverse(line);  // as CLI11 takes them
    try {
        app.parse(line);
    } catch (const InputError&) {}
    return seen;
}

TEST(StudyCommand, WithoutOptionsAsksForAllAtFullSize) {
    EXPECT_EQ(asked({}), Json::parse(R"({"small": false, "repeats": 5, "by_all": false, "scenes": [], "methods": [],
                                         "bases": "both", "peers": false})"));
}

TEST(StudyCommand, HandsOverWhatItsOptionsWereGiven) {
    EXPECT_EQ(asked({"--size", "small", "--repeats", "2", "--scenes", "a,b", "--methods", "c:d=1,e=2", "f", "--bases",
                     "one", "--peers"}),
              Json::parse(R"({"small": true, "repeats": 2, "by_all": false, "scenes": ["a", "b"],
                              "methods": ["c:d=1,e=2", "f"], "bases": "one", "peers": true})"));
}

TEST(StudyCommand, RefusesWhatIsNoneOfTheChoices) {
    EXPECT_THROW((void)asked({"--bases", "three"}), CLI::ValidationError);
    EXPECT_THROW((void)asked({"--size", "large"}), CLI::ValidationError);
    EXPECT_THROW((void)asked({"--repeats", "0"}), CLI::ValidationError);
}

}  // namespace
}  // namespace tact::bench
