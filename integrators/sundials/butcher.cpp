#include "butcher.hpp"

#include <arkode/arkode_butcher_dirk.h>

#include <string>

#include "../../lib/errors.hpp"

namespace tact::sundials {

ButcherTable load_dirk(const char* name, const char* id) {
    ARKodeButcherTable loaded = ARKodeButcherTable_LoadDIRKByName(id);
    if (!loaded) throw NumericalError(std::string("SUNDIALS: no Butcher table ") + name);
    ButcherTable table;
    table.name = name;
    table.order = loaded->q;
    table.embedded_order = loaded->p;
    const Index s = loaded->stages;
    table.A.resize(s, s);
    for (Index i = 0; i < s; ++i)
        for (Index j = 0; j < s; ++j) table.A(i, j) = loaded->A[i][j];
    table.b = Eigen::Map<Vector>(loaded->b, s);
    table.c = Eigen::Map<Vector>(loaded->c, s);
    table.b_embedded = Eigen::Map<Vector>(loaded->d, s);
    ARKodeButcherTable_Free(loaded);
    return table;
}

}  // namespace tact::sundials
