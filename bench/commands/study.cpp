#include "study.hpp"

#include <CLI/CLI.hpp>
#include <iostream>
#include <memory>

#include "../harness/report.hpp"

namespace tact::bench {
namespace {

void add(CLI::App& command, const StudyOption& option, StudyArguments& arguments) {
    const std::string dashed = "--" + option.name;
    auto& given = arguments.given;
    switch (option.kind) {
        case StudyOption::Kind::flag:
            command.add_flag_callback(
                dashed, [&given, name = option.name] { given[name] = {}; }, option.about);
            return;
        case StudyOption::Kind::choice:
            command
                .add_option_function<std::string>(
                    dashed, [&given, name = option.name](const std::string& chosen) { given[name] = {chosen}; },
                    option.about)
                ->check(CLI::IsMember(option.choices))
                ->default_str(option.choices.front());
            return;
        case StudyOption::Kind::list:
            CLI::Option* list = command.add_option_function<std::vector<std::string>>(
                dashed, [&given, name = option.name](const std::vector<std::string>& names) { given[name] = names; },
                option.about);
            if (option.delimiter != 0) list->delimiter(option.delimiter);
            return;
    }
}

}  // namespace

Command study_command(const Study& study) {
    return {study.name, study.about, [study](CLI::App& command) -> std::function<int()> {
                struct Asked {
                    StudyArguments arguments;
                    std::string out = "results";
                };
                const auto asked = std::make_shared<Asked>();
                add_size_option(command, study.sizes, asked->arguments.small);
                if (study.takes_repeats) add_repeats_option(command, asked->arguments.repeats);
                for (const StudyOption& option : study.options) add(command, option, asked->arguments);
                add_out_option(command, asked->out);
                return [study, asked] {
                    const Json json = study.run(asked->arguments);
                    std::cout << study.table(json) << std::flush;
                    write_study(asked->out, study.name, json, study.markdown(json));
                    std::cout << "written: " << study.name << ".json, .md and .svg in " << asked->out << "\n";
                    return 0;
                };
            }};
}

}  // namespace tact::bench
