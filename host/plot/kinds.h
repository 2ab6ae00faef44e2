// The three kinds of figures. Each draws below `top` and returns where it ends. \throws study::DataError.
#pragma once

#include "host/plot/axes.h"
#include "host/study/data/study_data.h"

namespace forceshade::plot {

double draw_scatter(Sheet& sheet, const study::Figure& figure, const study::StudyData& data, double top);
double draw_map(Sheet& sheet, const study::Figure& figure, const study::StudyData& data, double top);
double draw_bars(Sheet& sheet, const study::Figure& figure, const study::StudyData& data, double top);

} // namespace forceshade::plot
