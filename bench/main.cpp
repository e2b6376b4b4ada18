// tact-bench: the studies, single cases, problems from files. Exit code 0: done; 1: bad input, a solve that did not
// converge or an answer that is not the expected one, said on standard error or in the table; 130: interrupted.
#include <CLI/CLI.hpp>
#include <iostream>

#include "commands/all.hpp"
#include "commands/case.hpp"
#include "commands/qp.hpp"
#include "commands/report.hpp"
#include "commands/study.hpp"
#include "harness/interrupt.hpp"
#include "studies/studies.hpp"

namespace tact::bench {
namespace {

constexpr int interrupted_code = 130;

int run(int argc, char** argv) {
    CLI::App app("Full and reduced contact problems, measured");
    app.require_subcommand(1);
    int code = 0;
    const auto add = [&](const Command& command) {
        CLI::App* subcommand = app.add_subcommand(command.name, command.about);
        subcommand->callback([run = command.declare(*subcommand), &code] { code = run(); });
    };
    for (const Study& study : studies()) add(study_command(study));
    for (const Command& command : {all_command(), report_command(), case_command(), qp_command()}) add(command);
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        return app.exit(error);
    }
    return code;
}

}  // namespace
}  // namespace tact::bench

int main(int argc, char** argv) {
    using namespace tact::bench;
    use_one_thread(argv);
    catch_interrupts();
    try {
        return run(argc, argv);
    } catch (const Interrupted&) {
        std::cerr << "tact-bench: interrupted\n";
        return interrupted_code;
    } catch (const std::exception& error) {
        std::cerr << "tact-bench: " << error.what() << "\n";
        return 1;
    }
}
