// A program that asks a static reduced model held in memory: core, contact_dense and rom.
#include <cstdio>

#include "../../lib/time/stage.hpp"
#include "reduced_chain.hpp"

int main() {
    tact::ContactWorkspace workspace(std::make_shared<tact::DenseContact>());
    const tact::StaticSolution s = tact::solve_static(tact::bench::reduced_chain(false), workspace);
    std::printf("%d rows in contact, KKT residual %.0e\n", static_cast<int>(s.report.active), s.report.kkt.largest());
    return s.report.outcome == tact::Outcome::converged && s.report.active == 1 ? 0 : 1;
}
