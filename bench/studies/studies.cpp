#include "studies.hpp"

#include "bases/bases.hpp"
#include "downsampling/downsampling.hpp"
#include "greedy/greedy_study.hpp"
#include "growth/growth_study.hpp"
#include "histories/histories.hpp"
#include "omission/omission.hpp"
#include "online/online.hpp"
#include "solvers/solvers.hpp"
#include "speedup/speedup.hpp"
#include "stability/stability.hpp"
#include "tradeoff/tradeoff.hpp"
#include "training/training_study.hpp"
#include "work_precision/work_precision.hpp"

namespace tact::bench {

const std::vector<Study>& studies() {
    static const std::vector<Study> all{
        speedup_study(),   solvers_study(),  work_precision_study(), stability_study(), bases_study(),
        tradeoff_study(),  online_study(),   omission_study(),       growth_study(),    greedy_study(),
        histories_study(), training_study(), downsampling_study(),
    };
    return all;
}

}  // namespace tact::bench
