// Which program this is.
#pragma once

#include <string>

namespace forceshade {

/// Release and commit, "0.1.0+0123456789ab"; with ".changed-" and a digest where the sources differ from the commit.
std::string version();

} // namespace forceshade
