// Every study, listed once.
#pragma once

#include <vector>

#include "../harness/study.hpp"

namespace tact::bench {

/// In the order they are run in, which is about that of the page.
const std::vector<Study>& studies();

}  // namespace tact::bench
