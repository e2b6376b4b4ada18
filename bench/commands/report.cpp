#include "report.hpp"

#include <CLI/CLI.hpp>
#include <iostream>
#include <memory>

#include "../../lib/io/write_file.hpp"
#include "../harness/report.hpp"
#include "../studies/studies.hpp"

namespace tact::bench {

void write_page(const std::filesystem::path& results) {
    draw("harness/index", results, results / "index.html", "needs python3; the studies are complete");
}

void write_pages_of_studies(const std::filesystem::path& results) {
    for (const Study& study : studies()) {
        const std::filesystem::path data = results / (study.name + ".json");
        if (!std::filesystem::exists(data)) continue;
        const Json json = Json::parse(read_file(data));
        write_study(results, study.name, json, study.markdown(json));
    }
}

std::filesystem::path bench_folder() { return TACT_BENCH_FOLDER; }

Command report_command() {
    return {"report", "index.html: one page of the studies in a folder",
            [](CLI::App& command) -> std::function<int()> {
                struct Asked {
                    std::string out = "results";
                    bool studies = false;
                };
                const auto asked = std::make_shared<Asked>();
                add_out_option(command, asked->out);
                command.add_flag("--studies", asked->studies, "NAME.md and NAME.svg of the json files there as well");
                return [asked] {
                    if (asked->studies) write_pages_of_studies(asked->out);
                    write_page(asked->out);
                    std::cout << "written: " << asked->out << "/index.html\n";
                    return 0;
                };
            }};
}

}  // namespace tact::bench
