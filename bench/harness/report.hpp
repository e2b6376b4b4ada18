// The three files every study leaves, and its table on the terminal.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "machine.hpp"

namespace tact::bench {

/// Three significant digits: "0.0123", "1.31e-05", "2230"; "-" for null.
std::string digits(const Json& number, int significant = 3);
/// A duration with its unit: "1.31 ms"; "-" for null.
std::string with_unit(const Json& seconds);

/// 100 |e| / |u| from 100 |e|^2 / |u|^2, which is what eqs. 16 and 17 print; null from null.
Json norm_percent(const Json& squared_percent);
/// What the errors of reduced models are, in words: of what, against what, in which norm. Items of a markdown list.
extern const char* const what_the_errors_are;

/// Columns of equal width under a header; reads as text and as markdown.
std::string table(const std::vector<std::vector<std::string>>& rows);

/// One line: processor, compiler, flags, date.
std::string machine_line(const Json& machine);

/// Makes the folder if it is missing and tries a file in it. InputError that names it if it cannot be written.
void check_out_folder(const std::filesystem::path& out);

/// OUT/NAME.json and .md, then .svg by bench/studies/NAME/figure.py, which reads nothing but the json; each whole or not at all.
/// NumericalError that says what to do if the figure cannot be drawn (json and md are then there).
void write_study(const std::filesystem::path& out, const std::string& name, const Json& json,
                 const std::string& markdown);

/// bench/SCRIPT.py run on an input to make a file, whole or not at all. NumericalError, which says `hint`, if it fails.
void draw(const std::string& script, const std::filesystem::path& input, const std::filesystem::path& file,
          const std::string& hint);

}  // namespace tact::bench
