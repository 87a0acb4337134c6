// workflows/gap_flow_report.h -- tables and pictures of a disturbance that develops in a gap.
#pragma once
#include "engine/flow_development.h"
#include "render/line_plot.h"

#include <string>

namespace sigmaflow::workflows {

/// A row for each moment: rates and stresses at three heights, amplitude.
std::string series_text(const Development& development);

/// Space and time: a row for a strain, a column for a height.
std::string field_text(const Development& development);

/// These fill in an empty plot: the rates at three heights in time,
render::Plot rates_plot(render::Plot plot, const Development& d);
/// the amplitude beside the linear theory,
render::Plot growth_plot(render::Plot plot, const Development& d, double disturbance);
/// the rate across the gap at six moments of the last oscillation.
render::Plot profiles_plot(render::Plot plot, const Development& d);

}
