// Studies with every kind of figure, made up.
#pragma once

#include "host/study/study_data.h"

namespace forceshade::testing {

/// Scatters (logarithmic with labels, spreads, joined series and a curve; linear), maps of numbers, of numbers of both
/// signs and of words, bars (grouped, logarithmic, with long words).
study::StudyData sample_study();

} // namespace forceshade::testing
