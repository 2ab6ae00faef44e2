// The end of a run as a picture: how many samples took how long to compute, and how late they were.
#pragma once

#include "device/report/report.h"
#include "host/picture/picture.h"

namespace forceshade::device {

/// The share of the samples that took longer, over time, both logarithmic: p50, p99, p99.9 and the largest are marked
/// on each line. As fast as possible only that of computing. The same outcome gives the same bytes.
picture::Picture draw_live_report(const LiveOutcome& outcome);

} // namespace forceshade::device
