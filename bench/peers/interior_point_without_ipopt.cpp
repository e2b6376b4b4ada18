#include "interior_point.hpp"

namespace tact::bench {

std::shared_ptr<const ContactSolver> interior_point() { return nullptr; }
std::string interior_point_version() { return {}; }

}  // namespace tact::bench
