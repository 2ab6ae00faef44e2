// What leaving things out saves, as tables, figures and findings.
#pragma once

#include "host/study/data/study_data.h"
#include "host/study/omission/measurement.h"
#include "host/study/run/sampling.h"

namespace forceshade::study {

/// A comparison with what was measured of it.
struct OmissionRow {
    Comparison comparison;
    Measurement measured;

    /// Time with it over the time without it, in the same rounds.
    Interval kernel_ratio() const;
    Interval whole_ratio() const;
    /// Whether every force was the same on both sides.
    bool same_forces() const {
        return comparison.same != Same::metrics && measured.agreement.compared > 0 && measured.agreement.differing == 0;
    }
};

/// Adds tables, figures and findings.
void add_omissions(StudyData& data, const std::vector<BaseScene>& scenes, const std::vector<OmissionRow>& rows);

} // namespace forceshade::study
