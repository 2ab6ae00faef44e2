// SIGINT, SIGTERM and SIGHUP as a flag that long work asks for, so that it can leave nothing half done.
#pragma once

#include "host/error.h"

namespace forceshade {

class Interrupted : public Error {
public:
    Interrupted() : Error(ExitCode::interrupted, "interrupted") {}
};

/// From now on the first SIGINT, SIGTERM or SIGHUP (unless it is ignored, as under nohup) raises the flag; a second one
/// ends the process at once.
void catch_interrupts();

/// Whether the flag is raised.
bool is_interrupted() noexcept;

/// \throws Interrupted once the flag is raised.
void check_interrupt();

} // namespace forceshade
