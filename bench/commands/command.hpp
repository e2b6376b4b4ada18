// What main.cpp puts together: subcommands of tact-bench, each with options of its own.
#pragma once

#include <functional>
#include <string>

namespace CLI {
class App;
}

namespace tact::bench {

struct Command {
    std::string name;
    std::string about;
    /// Adds the options to `command`. What it returns runs it with what they were given and returns the exit code.
    std::function<std::function<int()>(CLI::App& command)> declare;
};

/// --out DIR. The folder is tried before the command begins, not when hours have gone into it; `out` has to outlive the parsing.
void add_out_option(CLI::App& command, std::string& out);

/// --size, described by `sizes`; true in `small` once parsed.
void add_size_option(CLI::App& command, const std::string& sizes, bool& small);

/// --repeats.
void add_repeats_option(CLI::App& command, int& repeats);

}  // namespace tact::bench
