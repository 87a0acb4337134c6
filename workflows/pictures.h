// workflows/pictures.h -- drawing for the steps that make pictures.
//
// A picture that cannot be drawn here costs nothing but itself: it is noted in context.problems,
// the workflow goes on, and the program ends with the exit code of a rendering failure after
// everything else is written.
#pragma once
#include "render/line_plot.h"
#include "workflows/step.h"

#include <functional>

namespace sigmaflow::workflows {

/// Runs `draw` and notes a rendering failure.
void draw_or_note(Context& context, const std::function<void()>& draw);

/// Notes for a picture made of those of other steps, which of them could not be drawn: the step
/// runs again with them.
void note_undrawn(Context& context, const std::vector<std::string>& steps);

/// <name>.svg, which needs no graphics, and <name>.png.
void write_plot(Context& context, const std::string& name, const render::Plot& plot);

struct PictureSize {
    int width = 1920, height = 1080;

    void describe(io::Fields& f);
    double pixels() const { return static_cast<double>(width) * height; }
    /// An empty plot of this size.
    render::Plot plot() const;
};

/// Rich text for titles: "$phi$ = 0.56, $sigma$/$sigma$_{0} = 2, $n$ = 200" in Greek letters.
std::string title_text(double volume_fraction, const Control& control, int particles);

/// Rich text of a scalar of the time series with its unit, e.g. for an axis.
std::string axis_text(const SampleField& field);

/// A number with at most four significant digits.
std::string short_number(double value);

}
