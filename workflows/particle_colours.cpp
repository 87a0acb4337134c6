#include "workflows/particle_colours.h"

#include "io/particles_vtp.h"

#include <vtkPolyData.h>

namespace sigmaflow::workflows {

void ParticleColours::describe(io::Fields& f)
{
    f("colour_by", colour_by,
      std::vector<std::string_view>{"nonaffine_speed", "contact_number", "radius", "species",
                                    "normal_force"},
      "what the colours show; nonaffine_speed is |U - U_inf|/(shear rate a); normal_force "
      "[F*]: the chains of contacts above the mean force, between small spheres");
    f("colour_map", colour_map, std::vector<std::string_view>{"inferno", "viridis", "paper"},
      "paper: dark grey to yellow");
    f("colour_maximum", colour_maximum, io::above(0), "-",
      "value of the last colour; default: from the data");
}

render::ParticleView ParticleColours::view(const Run& run, const Frame& frame,
                                           const PictureSize& size) const
{
    render::ParticleView view;
    view.width = size.width;
    view.height = size.height;
    const Vec3& box = frame.state.box.length;
    view.box_length = {box.x(), box.y(), box.z()};
    view.colour_by = colour_by;
    view.colour_map = colour_map;
    view.colour_maximum = colour_maximum;
    view.title = title_text(run.volume_fraction, run.control, frame.state.size()) +
                 ", $γ$ = " + short_number(frame.state.strain);
    return view;
}

render::Image ParticleColours::draw(const Frame& frame, const render::ParticleView& view,
                                    render::KeptWindow* window) const
{
    const auto particles = io::particles_polydata(frame);
    return shows_chains()
               ? render::render_chains(particles, io::contacts_polydata(frame), view, window)
               : render::render_particles(particles, view, window);
}

}
