// What commands that draw pictures have in common.
#pragma once

#include <string>

#include "host/cli/command.h"
#include "host/picture/picture.h"
#include "host/picture/values.h"

namespace forceshade {

/// --title and --size.
void describe_look(Options& options, picture::Look& look);

/// \throws UsageError if options of pictures are given without --also.
void refuse_unused(const picture::Endings& endings, bool as_by_default);

/// "magnitude". \throws UsageError with the names that there are.
picture::Quantity quantity_named(const std::string& name);

/// "y=2 mm", or "y" for the middle. \throws UsageError for other text and for a plane outside of the grid.
void read_slice(const std::string& text, const GridSpec& grid, picture::SliceChoice& slice);

} // namespace forceshade
