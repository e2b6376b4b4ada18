#include "butcher_table.hpp"

#include <cmath>

#include "../../lib/errors.hpp"
#include "butcher.hpp"

namespace tact {
namespace {

constexpr double rounding = 1e-12;

std::string shape(const DenseMatrix& A) { return std::to_string(A.rows()) + "x" + std::to_string(A.cols()); }

}  // namespace

bool ButcherTable::stiffly_accurate() const {
    return stages() > 0 && (A.row(stages() - 1).transpose() - b).cwiseAbs().maxCoeff() <= rounding;
}

void validate(const ButcherTable& table) {
    const auto reject = [&](const std::string& what) {
        throw InputError("ButcherTable " + table.name + ": " + what);
    };
    const Index s = table.stages();
    if (s == 0) reject("b is empty, expected at least one stage");
    if (table.A.rows() != s || table.A.cols() != s)
        reject("A is " + shape(table.A) + ", expected " + std::to_string(s) + "x" + std::to_string(s));
    if (table.c.size() != s)
        reject("c is " + std::to_string(table.c.size()) + "x1, expected " + std::to_string(s) + "x1");
    if (table.b_embedded.size() != 0 && table.b_embedded.size() != s)
        reject("b_embedded is " + std::to_string(table.b_embedded.size()) + "x1, expected empty or " +
               std::to_string(s) + "x1");
    if (!table.A.allFinite() || !table.b.allFinite() || !table.c.allFinite() || !table.b_embedded.allFinite())
        reject("it has a NaN or infinite entry, expected finite ones");
    if (table.order < 1) reject("order is " + std::to_string(table.order) + ", expected at least 1");
    for (Index i = 0; i < s; ++i) {
        for (Index j = i + 1; j < s; ++j)
            if (table.A(i, j) != 0)
                reject("A(" + std::to_string(i) + "," + std::to_string(j) + ") is " + shown(table.A(i, j)) +
                       ", expected 0: diagonally implicit");
        if (!(table.A(i, i) > 0) && !(i == 0 && table.A(i, i) == 0))
            reject("A(" + std::to_string(i) + "," + std::to_string(i) + ") is " + shown(table.A(i, i)) +
                   ", expected positive (or zero in the first stage)");
        if (std::abs(table.A.row(i).sum() - table.c[i]) > rounding)
            reject("c[" + std::to_string(i) + "] is " + shown(table.c[i]) + ", expected the sum of A's row, " +
                   shown(table.A.row(i).sum()));
    }
    if (std::abs(table.b.sum() - 1) > rounding) reject("the sum of b is " + shown(table.b.sum()) + ", expected 1");
    if (table.b_embedded.size() > 0 && std::abs(table.b_embedded.sum() - 1) > rounding)
        reject("the sum of b_embedded is " + shown(table.b_embedded.sum()) + ", expected 1");
}

ButcherTable sdirk2() {
    const double gamma = 1 - 1 / std::sqrt(2.0);
    ButcherTable table;
    table.name = "sdirk2";
    table.order = 2;
    table.embedded_order = 1;
    table.A = DenseMatrix{{gamma, 0}, {1 - gamma, gamma}};
    table.b = Vector{{1 - gamma, gamma}};
    table.c = Vector{{gamma, 1}};
    // Both sums are one; far enough from b to see the second-order term.
    table.b_embedded = Vector{{1, 0}};
    return table;
}

ButcherTable tr_bdf2() { return sundials::load_dirk("tr-bdf2", "ARKODE_TRBDF2_3_3_2"); }
ButcherTable esdirk32() { return sundials::load_dirk("esdirk32", "ARKODE_ARK324L2SA_DIRK_4_2_3"); }
ButcherTable sdirk54() { return sundials::load_dirk("sdirk54", "ARKODE_SDIRK_5_3_4"); }

}  // namespace tact
