// A program that marches a reduced model held in memory: core, contact_dense, rom and integrators.
#include <cstdio>

#include "../../integrators/sundials/bdf2.hpp"
#include "reduced_chain.hpp"

int main() {
    tact::ContactWorkspace workspace(std::make_shared<tact::DenseContact>());
    const tact::MarchReport march =
        tact::integrate(tact::Bdf2(), tact::bench::reduced_chain(true), tact::TimeGrid::until(40, 0.1), workspace);
    std::printf("first contact in step %ld, KKT residual %.0e\n", march.first_contact_step,
                march.worst_kkt.largest());
    return march.outcome == tact::Outcome::converged && march.first_contact_step > 0 ? 0 : 1;
}
