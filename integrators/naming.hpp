// Numbers in the names of integrators.
#pragma once

#include <sstream>
#include <string>

namespace tact {

inline std::string short_number(double x) {
    std::ostringstream out;
    out << x;
    return out.str();
}

}  // namespace tact
