// ARKODE's own Butcher tables as data.
#pragma once

#include "butcher_table.hpp"

namespace tact::sundials {

/// The table of that identifier (ARKODE_...), under a name of ours. NumericalError if there is none.
ButcherTable load_dirk(const char* name, const char* id);

}  // namespace tact::sundials
