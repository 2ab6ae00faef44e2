// Data of a study that do not hold what they should.
#pragma once

#include "host/error.h"

namespace forceshade::study {

/// "points has no column error_rms_deg; it has ...".
class DataError : public Error {
public:
    explicit DataError(const std::string& message) : Error(ExitCode::failed, message) {}
};

} // namespace forceshade::study
