// workflows/curve_report.h -- flow curves as a table, two pictures and a verdict on each shape.
#pragma once
#include "workflows/measured_curves.h"
#include "workflows/pictures.h"

namespace sigmaflow::workflows {

/// <step>.csv, <step>.png (rate against stress) and <step>_viscosity.png (viscosity against rate),
/// and in the results the shape of every curve. `confidence`: of all statements on one curve.
void report_curves(Context& context, const Curves& curves, double confidence,
                   const PictureSize& size);

}
