// What this process and its machine are, for accounts of runs.
#pragma once

#include <cstdint>
#include <string>

namespace forceshade {

/// The processor's name, "unknown" where the system does not tell.
std::string cpu_name();
/// Seconds of processor time that this process took, all threads.
double cpu_seconds();
/// Most bytes that this process had resident.
std::uint64_t peak_memory();

} // namespace forceshade
