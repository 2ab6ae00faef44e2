// The end of a run as a picture: how often computing took how long, and how late samples were.
#pragma once

#include "device/report/report.h"
#include "host/picture/picture.h"

namespace forceshade::device {

/// Histograms on one logarithmic axis of time, with p50, p99, p99.9, the largest and the period marked. As fast as
/// possible only that of computing. The same outcome gives the same bytes.
picture::Picture draw_live_report(const LiveOutcome& outcome);

} // namespace forceshade::device
