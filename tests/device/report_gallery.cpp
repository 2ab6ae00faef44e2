// report_gallery FOLDER: the reports of every case, for a person to look at.
#include "device/report/report.h"
#include "tests/device/report_cases.h"

int main(int argc, char** argv) {
    if (argc != 2)
        return 2;
    for (const auto& [file, outcome] : forceshade::device::test::cases())
        forceshade::device::write_live_report(outcome, std::filesystem::path(argv[1]) / file);
}
