// Which accuracy is kept in which range.
#pragma once

#include "host/study/data/study_data.h"

namespace forceshade::study {

/// Table `promises`, from `number`: for each surface, axis, precision and accuracy the tried values about the plain one
/// over which the error stays within it, without a gap.
Table promises_table(const Table& number);

/// Table `promised`, from `promises`: a row a surface, precision and accuracy, a column an axis, in words; for readers.
Table promised_table(const Table& promises);

} // namespace forceshade::study
