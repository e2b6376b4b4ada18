// The solvers study: every contact strategy and the peers on the paper's problems, growth, numbering.
#pragma once

#include <string>
#include <vector>

#include "../../../lib/types.hpp"
#include "../../harness/study.hpp"

namespace tact::bench {

struct SolversOptions {
    bool small = false;  ///< membrane 60 x 60, plates 40 x 40; growth to 200 and 50 a side
    int repeats = 5;
    bool peers = false;                           ///< IPOPT and PETSc, those that are there
    std::vector<std::string> scenes = {};         ///< wanted; empty: all three
    Index side = 0;                               ///< nodes a side instead of the size's, for tests
    std::vector<std::vector<Index>> growth = {};  ///< sides of membrane and plates instead of the size's
};

/// {"study", "size", "repeats", "machine", "peers": {name: version or null}, "problems": [...], "rows": [one a problem and
/// solver], "numbering": [{"problem", "solver", "seconds", "permuted_seconds", "ratio"}], "growth": [see run_growth]}.
/// A row: {"problem", "solver", "seconds_median", "seconds_min", "iterations", "kkt_residual", "solution_error", "peer", ...};
/// solvers that do not take a problem have none. CPU time of one thread. InputError for a bad option; Interrupted.
Json run_solvers(const SolversOptions& options);

/// What --peers asked for and is not there, in words; empty if nothing is missing.
std::string missing_peers(const Json& json);

/// Its tables for the terminal, and the page with them.
std::string solvers_table(const Json& json);
std::string solvers_markdown(const Json& json);

const Study& solvers_study();

}  // namespace tact::bench
