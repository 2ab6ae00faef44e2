// Runs of the live loop to report on: ordinary ones, and the odd ones that a report must survive.
#pragma once

#include <string>
#include <vector>

#include "device/run_report/report.h"

namespace forceshade::device::test {

/// 60 s of `sim` at so many Hz, where the clock wakes a sample some tens of microseconds late.
LiveOutcome usual(double rate);
LiveOutcome as_fast_as_possible();
LiveOutcome one_sample();
LiveOutcome no_sample();
/// Texts of others that are long, or no UTF-8, and every remark and event there is.
LiveOutcome talkative();
/// Times beyond any that a clock gives, and numbers that are none.
LiveOutcome beyond();

struct Case {
    std::string file;
    LiveOutcome outcome;
};
std::vector<Case> cases();

} // namespace forceshade::device::test
