// Which accuracy is kept in which range.
#pragma once

#include "host/study/data/study_data.h"

namespace forceshade::study {

/// Table `promises`, from `number`: for each surface, axis, precision and accuracy the tried values about the plain one
/// over which the error stays within it, without a gap.
Table promises_table(const Table& number);

/// Table `promised`, from `promises`: a row a surface, precision and accuracy, a column an axis, in words; for readers.
Table promised_table(const Table& promises);

/// Table `number_failures`, from `number`: where going away from the plain value the error of forces first passes 1e-4,
/// what is measured and predicted there, and the condition that explains it.
Table failures_table(const Table& number);

/// Table `number_expected`, from `number`: the largest prediction of meshes and of all other surfaces, by axis,
/// precision and value.
Table expected_table(const Table& number);

} // namespace forceshade::study
