// io/paraview_view.h -- the script that shows a series in ParaView: spheres at their true radii,
// coloured by nonaffine_speed, in their box.
//
// It lies beside particles.pvd as view.py and knows no path, so folders can be moved: it takes the
// particles.pvd that is open in ParaView, or the one beside it, or the one in the working folder.
// The same bytes for every run.
#pragma once
#include <string_view>

namespace sigmaflow::io {

inline constexpr const char* view_script_name = "view.py";

std::string_view view_script();

}
