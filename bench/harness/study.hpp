// What a study is: its name, its own options, its run, and the table and page made of what the run leaves.
#pragma once

#include <functional>
#include <map>
#include <string>
#include <vector>

#include "machine.hpp"

namespace tact::bench {

/// What a study's numbers are, and so what may go on beside it.
enum class Measured {
    errors,        ///< no times: it may run beside those that measure CPU time
    cpu_time,      ///< of one thread: it shares its core with nothing
    elapsed_time,  ///< it has all processors to itself
};

/// An option of one study, beside --size, --repeats and --out, which are the harness's.
struct StudyOption {
    enum class Kind {
        list,    ///< names; none given: all
        choice,  ///< one of `choices`; the first where none is given
        flag,
    };
    std::string name;  ///< without dashes
    std::string about;
    Kind kind = Kind::list;
    char delimiter = ',';                   ///< between the names of a list; 0: blanks
    std::vector<std::string> choices = {};  ///< of a choice
};

/// What one run of a study is asked for.
struct StudyArguments {
    bool small = false;
    int repeats = 5;      ///< runs a time is the median of
    bool by_all = false;  ///< asked for by `all`, which gives no options of a study
    std::map<std::string, std::vector<std::string>> given = {};  ///< by the name of the option

    bool flag(const std::string& option) const { return given.contains(option); }
    /// The names given; empty: none, which means all.
    std::vector<std::string> list(const std::string& option) const;
    /// The one given, or `otherwise`.
    std::string choice(const std::string& option, const std::string& otherwise) const;
};

/// One folder of bench/studies. `tact-bench NAME` leaves NAME.json, NAME.md and NAME.svg.
struct Study {
    std::string name;  ///< its folder's, with - for _
    std::string about;
    Measured measured = Measured::errors;
    bool takes_repeats = false;
    std::string sizes = "full: the paper's grids; small: minutes become seconds";  ///< what --size says
    std::vector<StudyOption> options = {};
    std::function<Json(const StudyArguments&)> run = {};
    std::function<std::string(const Json&)> table = {};     ///< for the terminal
    std::function<std::string(const Json&)> markdown = {};  ///< NAME.md
};

}  // namespace tact::bench
