// Which program this is.
#pragma once

#include <string>

namespace forceshade {

/// Release and commit, "0.1.0+0123456789ab"; with ".sources-" and a digest where the sources are not the commit's.
std::string version();

} // namespace forceshade
