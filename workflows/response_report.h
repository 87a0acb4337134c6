// workflows/response_report.h -- the mean response of many starts to a step in stress: table,
// pictures, fits of exponentials and the memory kernel that they stand for.
#pragma once
#include "workflows/pictures.h"

#include <string>
#include <string_view>
#include <vector>

namespace sigmaflow::workflows {

/// One start.
struct Response {
    std::uint64_t seed = 0;
    bool packed = true;   // there is a packing without overlaps
    bool jammed = false;  // before or after the step, or out of time
    std::vector<Sample> before, after;
};

template <class Archive>
void archive(Archive& a, Response& r)
{
    a(r.seed, r.packed, r.jammed, r.before, r.after);
}

/// flowing, jammed or not packed
std::string_view response_outcome(const Response& response);

/// "_shear_rate" and so on: the endings of its pictures.
std::vector<std::string> response_pictures();

struct StressStep {
    double stress_before = 0, stress_after = 0;  // [sigma0]
    double strain_before = 0;                    // [-]
};

/// <step>.csv, <step>_<scalar>.png of stress, contact number, viscosity and shear rate, and the
/// numbers in the results. All responses flow, at equal strains.
void report_response(Context& context, const StressStep& step,
                     const std::vector<Response>& responses, const PictureSize& size);

}
