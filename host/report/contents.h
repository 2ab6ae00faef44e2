// The contents of a results folder: sweeps and studies, and the parts that cannot be understood.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "host/output/record.h"
#include "host/study/data/study_data.h"

namespace forceshade::report {

struct Sweep {
    std::string folder; /* below the report's: "", "NAME" or "NAME/NAME" */
    std::string program, device, driver, cpu;
    unsigned cores = 0;
    double seconds = 0; /* of the last run that computed something */
    std::size_t cases_of_study = 0;
    std::vector<CaseRecord> cases;
    std::vector<study::Finding> findings;
};

struct StudyPart {
    std::string folder; /* below the report's */
    study::StudyData data;
};

struct Contents {
    std::vector<Sweep> sweeps;
    std::vector<StudyPart> studies;    /* with their findings computed anew */
    std::vector<std::string> troubles; /* a sentence each, beginning with the file */
};

/// Looks into the folder, the folders below it, and those below folders that hold no results themselves. \throws
/// IoError if the folder does not exist.
Contents read_contents(const std::filesystem::path& folder);

/// "sub/name", or "name" right in the report's folder.
std::string below(const std::string& folder, const std::string& name);

} // namespace forceshade::report
