#include "command.hpp"

#include <CLI/CLI.hpp>

#include "../harness/report.hpp"

namespace tact::bench {

void add_out_option(CLI::App& command, std::string& out) {
    command.add_option("--out", out, "Folder of the results")->capture_default_str();
    command.parse_complete_callback([&out] { check_out_folder(out); });
}

void add_size_option(CLI::App& command, const std::string& sizes, bool& small) {
    command
        .add_option_function<std::string>(
            "--size", [&small](const std::string& size) { small = size == "small"; }, sizes)
        ->check(CLI::IsMember({"full", "small"}))
        ->default_str("full");
}

void add_repeats_option(CLI::App& command, int& repeats) {
    command.add_option("--repeats", repeats, "Runs a time is the median of")
        ->check(CLI::PositiveNumber)
        ->capture_default_str();
}

}  // namespace tact::bench
