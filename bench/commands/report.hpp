// `tact-bench report`: one page of the studies in a folder.
#pragma once

#include <filesystem>

#include "command.hpp"

namespace tact::bench {

/// index.html from the studies in a folder: one page, figures and tables inline. NumericalError if it cannot be made.
void write_page(const std::filesystem::path& results);

/// NAME.md and NAME.svg again of every study whose NAME.json is in the folder: what is said of the numbers may have changed.
void write_pages_of_studies(const std::filesystem::path& results);

/// Where this was built from: bench of the project.
std::filesystem::path bench_folder();

Command report_command();

}  // namespace tact::bench
