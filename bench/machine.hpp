// What a measurement was made on.
#pragma once

#include <nlohmann/json.hpp>

namespace tact::bench {

using Json = nlohmann::ordered_json;

/// Processor, cores, compiler and its flags, versions of the libraries, date.
Json machine();

/// One thread in the BLAS and in OpenMP, unless the environment says otherwise.
void use_one_thread();

}  // namespace tact::bench
