// What a measurement was made on.
#pragma once

#include <nlohmann/json.hpp>

namespace tact::bench {

using Json = nlohmann::ordered_json;

/// Processor, cores, compiler and its flags, versions of the libraries, date.
Json machine();

/// One thread in the BLAS and in OpenMP, unless the environment says otherwise. CHOLMOD asks OpenMP for four whatever the
/// default is, and only OMP_THREAD_LIMIT, read when a program starts, keeps it to one: the program is started again with it.
void use_one_thread(char** arguments);

}  // namespace tact::bench
