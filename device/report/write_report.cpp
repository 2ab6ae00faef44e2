#include "device/report/write_report.h"

#include <span>

#include <nlohmann/json.hpp>

#include "device/report/live_picture.h"
#include "device/report/report_json.h"
#include "device/report/report_text.h"
#include "host/output/files.h"

namespace forceshade::device {

void write_live_report(const LiveOutcome& outcome, const std::filesystem::path& stem) {
    const auto named = [&](const char* ending) { return std::filesystem::path(stem) += ending; };
    write_file_atomically(named(".txt"), report_text(outcome));
    write_file_atomically(named(".json"), report_json(outcome).dump(2) + "\n");
    const picture::Picture picture = draw_live_report(outcome);
    write_file_atomically(named(".png"), std::as_bytes(std::span(picture.png)));
}

} // namespace forceshade::device
