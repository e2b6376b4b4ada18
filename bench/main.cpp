// tact-bench: the studies, single cases, problems from files. Exit code 0: done; 1: bad input, a solve that did not
// converge or an answer that is not the expected one, said on standard error or in the table; 130: interrupted.
#include <CLI/CLI.hpp>
#include <iostream>

#include "../lib/errors.hpp"
#include "../lib/io/write_file.hpp"
#include "commands/case.hpp"
#include "commands/qp.hpp"
#include "harness/basis_recipes.hpp"
#include "harness/contact_solvers.hpp"
#include "harness/interrupt.hpp"
#include "harness/report.hpp"
#include "harness/scenes.hpp"
#include "harness/studies.hpp"
#include "studies/bases/bases.hpp"
#include "studies/downsampling/downsampling.hpp"
#include "studies/greedy/greedy_study.hpp"
#include "studies/growth/growth_study.hpp"
#include "studies/histories/histories.hpp"
#include "studies/omission/omission.hpp"
#include "studies/online/online.hpp"
#include "studies/solvers/solvers.hpp"
#include "studies/speedup/speedup.hpp"
#include "studies/stability/stability.hpp"
#include "studies/tradeoff/tradeoff.hpp"
#include "studies/training/training_study.hpp"
#include "studies/work_precision/work_precision.hpp"
#include "studies/work_precision/work_precision_scenes.hpp"

namespace tact::bench {
namespace {

constexpr int interrupted_code = 130;

void add_case(CLI::App& app, int& code) {
    struct Arguments {
        CaseOptions options;
        std::string points, out;
    };
    const auto arguments = std::make_shared<Arguments>();
    CaseOptions& options = arguments->options;
    CLI::App* command =
        app.add_subcommand("case", "One full run: values at points and times, energies, KKT residuals");
    std::string scenes;
    for (const std::string& name : study_scene_names()) scenes += (scenes.empty() ? "" : ", ") + name;
    command->add_option("scene", options.scene, scenes)->required();
    command->add_option("--n", options.n, "Nodes a side or elements (the paper's 200, plates 100; else as usual)");
    command->add_option("--gamma", options.gamma, "Parameters of the obstacle: G1,G2")->delimiter(',');
    command->add_option("--dt", options.dt, "Time step (the paper's: .005, plates 2e-4; else the usual)");
    command->add_option("--t-end", options.t_end, "End time (the paper's: 2, plates .4; else the usual)");
    command->add_option(
        "--integrator", options.integrator,
        "bdf2, bdf2-without-jump, central-difference, trapezoid, moreau-jean, ida, ida-fixed, sdirk2, tr-bdf2, "
        "esdirk32, "
        "sdirk54, quasi-static; options after a colon: trapezoid:rho=0.3,e=0, ida:rtol=1e-5 (bdf2; without M "
        "and D the equilibria at the times asked for)");
    command->add_option("--at", options.at, "Times to report: T1,T2,... (the end)")->delimiter(',');
    command->add_option("--points", arguments->points,
                        "Points to report: X1,Y1;X2,Y2;... (the centre); on the line X1;X2;...");
    command->add_option("--out", arguments->out, "json file (standard output)");
    command->callback([arguments, &code] {
        arguments->options.points = parse_points(arguments->points);
        const Json json = run_case(arguments->options);
        const std::string text = json.dump(2) + "\n";
        if (arguments->out.empty())
            std::cout << text;
        else
            write_file(arguments->out, text);
        if (!json.contains("message")) return;
        std::cerr << "tact-bench: " << json["message"].get<std::string>() << "\n";
        code = 1;
    });
}

void add_qp(CLI::App& app, int& code) {
    struct Arguments {
        std::string folder, out, solver = "chooser";
    };
    const auto arguments = std::make_shared<Arguments>();
    CLI::App* command = app.add_subcommand(
        "qp", "Quadratic programmes from files (A.mtx, B.mtx, b.txt, c.txt), compared with expected.json");
    command->add_option("folder", arguments->folder, "Folder of problem folders, or one of them")->required();
    command->add_option("--out", arguments->out, "json file of the answers");
    std::vector<std::string> names;
    for (const NamedSolver& each : contact_solvers()) names.push_back(each.name);
    command->add_option("--solver", arguments->solver, "What solves them")
        ->check(CLI::IsMember(names))
        ->capture_default_str();
    command->callback([arguments, &code] {
        const Json problems = run_qp(arguments->folder, *contact_solver(arguments->solver));
        std::cout << qp_table(problems) << std::flush;
        if (!arguments->out.empty()) write_file(arguments->out, problems.dump(1) + "\n");
        if (!qp_agrees(problems)) code = 1;
    });
}

/// What every study takes.
struct StudyArguments {
    std::string size = "full";
    int repeats = 5;
    std::string out = "results";
};

/// The folder is tried before the study begins, not when hours have gone into it.
void add_out_option(CLI::App& command, std::string& out) {
    command.add_option("--out", out, "Folder of the results")->capture_default_str();
    command.parse_complete_callback([&out] { check_out_folder(out); });
}

void add_study_options(CLI::App& command, StudyArguments& arguments) {
    command.add_option("--size", arguments.size, "full: the paper's grids; small: minutes become seconds")
        ->check(CLI::IsMember({"full", "small"}))
        ->capture_default_str();
    command.add_option("--repeats", arguments.repeats, "Runs a time is the median of")
        ->check(CLI::PositiveNumber)
        ->capture_default_str();
    add_out_option(command, arguments.out);
}

void add_speedup(CLI::App& app) {
    struct Arguments : StudyArguments {
        std::string bases = "default";
        std::vector<std::string> scenes;
    };
    CLI::App* command = app.add_subcommand("speedup", "Table I: online speed-ups of the three contact problems");
    const auto arguments = std::make_shared<Arguments>();
    add_study_options(*command, *arguments);
    command->add_option("--bases", arguments->bases, "default: contact at selected rows; paper: the paper's method")
        ->check(CLI::IsMember({"default", "paper"}))
        ->capture_default_str();
    command
        ->add_option("--scenes", arguments->scenes, "Rows wanted: static-obstacle,dynamic-obstacle,two-plates (all)")
        ->delimiter(',');
    command->callback([arguments] {
        const Json json =
            run_speedup({arguments->size == "small", arguments->repeats, arguments->bases, arguments->scenes});
        std::cout << speedup_table(json) << "* extrapolated from a sample of steps\n" << std::flush;
        write_study(arguments->out, "speedup", json, speedup_markdown(json));
        std::cout << "written: speedup.json, speedup.md and speedup.svg in " << arguments->out << "\n";
    });
}

void add_solvers(CLI::App& app) {
    struct Arguments : StudyArguments {
        bool peers = false;
        std::vector<std::string> scenes;
    };
    CLI::App* command =
        app.add_subcommand("solvers", "Every contact strategy, and peers, on the three contact problems");
    const auto arguments = std::make_shared<Arguments>();
    add_study_options(*command, *arguments);
    command->add_flag("--peers", arguments->peers, "Compare with IPOPT and PETSc, those that are there");
    command->add_option("--scenes", arguments->scenes, "static-obstacle,dynamic-obstacle,two-plates (all)")
        ->delimiter(',');
    command->callback([arguments] {
        const Json json = run_solvers({.small = arguments->size == "small",
                                       .repeats = arguments->repeats,
                                       .peers = arguments->peers,
                                       .scenes = arguments->scenes});
        std::cout << solvers_table(json) << std::flush;
        write_study(arguments->out, "solvers", json, solvers_markdown(json));
        std::cout << "written: solvers.json, solvers.md and solvers.svg in " << arguments->out << "\n";
    });
}

void add_stability(CLI::App& app) {
    struct Arguments {
        std::string size = "full", out = "results";
        std::vector<std::string> groups, integrators;
    };
    const auto arguments = std::make_shared<Arguments>();
    CLI::App* command = app.add_subcommand("stability", "Every integrator on hard cases: ended right, or honestly");
    command->add_option("--size", arguments->size, "full: a million steps, plates 100 x 100; small: seconds")
        ->check(CLI::IsMember({"full", "small"}))
        ->capture_default_str();
    command->add_option("--groups", arguments->groups, "step,stiffness,ratio,gap,speed,... (all)")->delimiter(',');
    command->add_option("--integrators", arguments->integrators, "As case takes them, with blanks between (all)");
    add_out_option(*command, arguments->out);
    command->callback([arguments] {
        const Json json = run_stability({arguments->size == "small", arguments->groups, arguments->integrators});
        std::cout << stability_table(json) << std::flush;
        write_study(arguments->out, "stability", json, stability_markdown(json));
        std::cout << "written: stability.json, stability.md and stability.svg in " << arguments->out << "\n";
    });
}

void add_work_precision(CLI::App& app) {
    struct Arguments : StudyArguments {
        std::vector<std::string> scenes;
        bool no_answers = false;
    };
    CLI::App* command =
        app.add_subcommand("work-precision", "Error against run time of every integrator, with its closing table");
    const auto arguments = std::make_shared<Arguments>();
    add_study_options(*command, *arguments);
    std::string names;
    for (const std::string& name : precision_scene_names()) names += (names.empty() ? "" : ",") + name;
    command->add_option("--scenes", arguments->scenes, names + " (all)")->delimiter(',');
    command->add_flag("--no-answers", arguments->no_answers, "The curves only");
    command->callback([arguments] {
        const Json json = run_work_precision({.small = arguments->size == "small",
                                              .repeats = arguments->repeats,
                                              .scenes = arguments->scenes,
                                              .answers = !arguments->no_answers});
        std::cout << work_precision_table(json) << std::flush;
        write_study(arguments->out, "work-precision", json, work_precision_markdown(json));
        std::cout << "written: work-precision.json, .md and .svg in " << arguments->out << "\n";
    });
}

void add_bases(CLI::App& app) {
    struct Arguments : StudyArguments {
        std::vector<std::string> scenes, recipes, integrators;
    };
    CLI::App* command = app.add_subcommand("bases", "Reduced bases: error against online time of every dual basis");
    const auto arguments = std::make_shared<Arguments>();
    add_study_options(*command, *arguments);
    command->add_option("--scenes", arguments->scenes, "static-obstacle,dynamic-obstacle,two-plates (all)")
        ->delimiter(',');
    command->add_option("--integrators", arguments->integrators, "bdf2,trapezoid,bdf2-without-jump (all)")
        ->delimiter(',');
    std::string names;
    for (const std::string& name : basis_recipe_names()) names += (names.empty() ? "" : "; ") + name;
    command->add_option("--recipes", arguments->recipes, names + " (all but bodies, static modes and swaps)")
        ->delimiter(';');
    command->callback([arguments] {
        const Json json = run_bases({arguments->size == "small", arguments->repeats, arguments->scenes,
                                     arguments->recipes, arguments->integrators});
        std::cout << bases_table(json) << std::flush;
        write_study(arguments->out, "bases", json, bases_markdown(json));
        std::cout << "written: bases.json, bases.md and bases.svg in " << arguments->out << "\n";
    });
}

/// A study with nothing to choose but its size and scenes.
struct PlainStudy {
    const char* name;
    const char* about;
    Json (*run)(const StudyOptions& options);
    std::string (*table)(const Json& json);
    std::string (*markdown)(const Json& json);
};

void add_plain_study(CLI::App& app, const PlainStudy& study) {
    struct Arguments {
        std::string size = "full", out = "results";
        std::vector<std::string> scenes;
    };
    const auto arguments = std::make_shared<Arguments>();
    CLI::App* command = app.add_subcommand(study.name, study.about);
    command->add_option("--size", arguments->size, "full: the paper's grids; small: minutes become seconds")
        ->check(CLI::IsMember({"full", "small"}))
        ->capture_default_str();
    command->add_option("--scenes", arguments->scenes, "Those wanted of the study's scenes (all)")->delimiter(',');
    add_out_option(*command, arguments->out);
    command->callback([arguments, study] {
        const Json json = study.run({arguments->size == "small", arguments->scenes});
        std::cout << study.table(json) << std::flush;
        write_study(arguments->out, study.name, json, study.markdown(json));
        std::cout << "written: " << study.name << ".json, .md and .svg in " << arguments->out << "\n";
    });
}

void add_all(CLI::App& app, int& code) {
    struct Arguments : StudyArguments {
        bool force = false;
        std::vector<std::string> only;
    };
    CLI::App* command = app.add_subcommand("all", "Every study in turn, those that are there kept, and their page");
    const auto arguments = std::make_shared<Arguments>();
    add_study_options(*command, *arguments);
    command->add_flag("--force", arguments->force, "Run finished studies again");
    std::string names;
    for (const Study& study : studies()) names += (names.empty() ? "" : ",") + study.name;
    command->add_option("--only", arguments->only, names + " (all)")->delimiter(',');
    command->callback([arguments, &code] {
        const AllOptions options{
            {arguments->size == "small", arguments->repeats}, arguments->out, arguments->force, arguments->only};
        if (run_all(options) > 0) code = 1;
        write_page(options.out);
        std::cout << "written: " << (options.out / "index.html").string() << "\n";
    });
}

void add_report(CLI::App& app) {
    const auto results = std::make_shared<std::string>("results");
    CLI::App* command = app.add_subcommand("report", "index.html: one page of the studies in a folder");
    add_out_option(*command, *results);
    command->callback([results] {
        write_page(*results);
        std::cout << "written: " << *results << "/index.html\n";
    });
}

int run(int argc, char** argv) {
    CLI::App app("Full and reduced contact problems, measured");
    app.require_subcommand(1);
    int code = 0;
    add_speedup(app);
    add_bases(app);
    add_solvers(app);
    add_stability(app);
    add_work_precision(app);
    add_plain_study(app, {"greedy", "Figures 3 and 6: convergence of the greedy search, by every indicator",
                          run_greedy, greedy_table, greedy_markdown});
    add_plain_study(app, {"histories", "Figures 4, 5, 7, 8, 9, 11, 12: slices, time histories, surfaces",
                          run_histories, histories_table, histories_markdown});
    add_plain_study(app, {"downsampling", "Figure 13: reduced plates from fewer snapshots in time", run_downsampling,
                          downsampling_table, downsampling_markdown});
    add_plain_study(app, {"online", "Stored models: what a query costs, how far it can be trusted", run_online,
                          online_table, online_markdown});
    add_plain_study(app, {"omission", "What each scene leaves out, and what that saves", run_omission, omission_table,
                          omission_markdown});
    add_plain_study(app, {"training", "What training costs by part, and when it has paid", run_training,
                          training_table, training_markdown});
    add_plain_study(app, {"tradeoff", "Full and reduced models in one diagram: error against run time", run_tradeoff,
                          tradeoff_table, tradeoff_markdown});
    add_plain_study(app, {"growth", "Time and memory against size, contact, bases, steps, queries and threads",
                          run_growth_study, growth_table, growth_markdown});
    add_all(app, code);
    add_report(app);
    add_case(app, code);
    add_qp(app, code);
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
