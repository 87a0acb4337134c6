#include "workflows/particle_picture.h"

#include "io/particles_vtp.h"
#include "render/particle_series.h"

#include <vtkPolyData.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>

namespace sigmaflow::workflows {

namespace {

constexpr const char* chains = "normal_force";

struct NamedView {
    std::string_view name;
    render::ViewDirection direction;
};

const std::array<NamedView, 5> views{{
    {"oblique", {}},
    {"front", {0, 0}},
    {"top", {0, 90}},
    {"side", {90, 0}},
    {"iso", {45, 35.264389682754654}},
}};

std::string without_spaces(std::string text)
{
    std::erase(text, ' ');
    return text;
}

}

void ParticlePicture::describe(io::Fields& f)
{
    f("colour_by", colour_by,
      std::vector<std::string_view>{"nonaffine_speed", "contact_number", "radius", "species",
                                    "velocity", "angular_velocity", "stress", chains},
      "what the colours show; nonaffine_speed is |U - U_inf|/(shear rate a), vectors and stresses "
      "by their magnitude; normal_force [F*]: the chains of contacts above the mean force, between "
      "small spheres");
    f("colour_map", colour_map, std::vector<std::string_view>{"inferno", "viridis", "paper"},
      "paper: dark grey to yellow");
    f("colour_maximum", colour_maximum, io::above(0), "-",
      "value of the last colour; default: from the data");
    std::vector<std::string_view> names;
    for (const NamedView& named : views) names.push_back(named.name);
    f("view", viewed_from, names,
      "oblique: from the front, a little from the right and above; front: flow to the right, "
      "gradient up; top: flow and vorticity; side: gradient and vorticity; iso: along the diagonal "
      "of the box");
    f("azimuth", azimuth, io::between(-360, 360), "degrees",
      "of the viewer about the gradient axis: 0 front, 90 right; default: that of the view");
    f("elevation", elevation, io::between(-90, 90), "degrees",
      "of the viewer above the plane of flow and vorticity; default: that of the view");
    f("zoom", zoom, io::between(0.1, 100), "-",
      "enlarges the middle; what lies outside is cut off");
    f("clip", clip, 64,
      "hides particles whose centres lie beyond a plane: \"z=5\" or \"z=5:above\" those above, "
      "\"z=5:below\" those below [a]; also x and y; default: none");
    size.describe(f);
}

void ParticlePicture::validate(const io::JsonNode& node) const
{
    if (!clip.empty() && !clip_plane(clip))
        throw node.member("clip").wrong(
            "must be x, y or z = a number [a], then nothing, :above or :below, as \"z=5:above\", "
            "got \"" +
            clip + "\"");
}

std::optional<render::ClipPlane> clip_plane(const std::string& text)
{
    std::string rest = without_spaces(text);
    render::ClipPlane plane;
    if (rest.ends_with(":above"))
        rest.erase(rest.size() - 6);
    else if (rest.ends_with(":below")) {
        rest.erase(rest.size() - 6);
        plane.hides_above = false;
    }
    if (rest.size() < 3 || rest[1] != '=' || rest[0] < 'x' || rest[0] > 'z') return std::nullopt;
    plane.axis = rest[0] - 'x';
    const std::string number = rest.substr(2);
    if (number.find_first_not_of("0123456789.+-eE") != std::string::npos) return std::nullopt;
    char* end = nullptr;
    plane.value = std::strtod(number.c_str(), &end);
    if (*end != '\0' || !std::isfinite(plane.value)) return std::nullopt;
    return plane;
}

bool hides_all(const render::ClipPlane& plane, const Frame& frame)
{
    const auto& centres = frame.state.position;
    return std::all_of(centres.begin(), centres.end(), [&](const Vec3& p) {
        return plane.hides({p.x(), p.y(), p.z()});
    });
}

render::ParticleView ParticlePicture::particle_view(const Frame& frame, std::string title) const
{
    render::ParticleView result;
    result.width = size.width;
    result.height = size.height;
    const Vec3& box = frame.state.box.length;
    result.box_length = {box.x(), box.y(), box.z()};
    result.colour_by = colour_by;
    result.colour_map = colour_map;
    result.colour_maximum = colour_maximum;
    const auto named = std::find_if(views.begin(), views.end(),
                                    [&](const NamedView& v) { return v.name == viewed_from; });
    result.direction = named->direction;
    if (azimuth) result.direction.azimuth = *azimuth;
    if (elevation) result.direction.elevation = *elevation;
    result.zoom = zoom;
    result.clip = clip_plane(clip);
    if (result.clip)
        title += std::string(", $") + "xyz"[result.clip->axis] +
                 (result.clip->hides_above ? "$ ≤ " : "$ ≥ ") + short_number(result.clip->value);
    result.title = std::move(title);
    return result;
}

render::ParticleView ParticlePicture::common_view(const std::vector<Frame>& frames) const
{
    render::ParticleSeries series(particle_view(frames.front(), ""));
    for (const Frame& frame : frames)
        series.add(io::particles_polydata(frame),
                   colour_by == chains ? io::contacts_polydata(frame) : nullptr);
    return series.view();
}

render::Image ParticlePicture::draw(const Frame& frame, const render::ParticleView& view,
                                    render::KeptWindow* window) const
{
    const auto particles = io::particles_polydata(frame);
    return colour_by == chains
               ? render::render_chains(particles, io::contacts_polydata(frame), view, window)
               : render::render_particles(particles, view, window);
}

std::string frame_title(const Frame& frame, double volume_fraction, const Control& control)
{
    return title_text(volume_fraction, control, frame.state.size()) +
           ", $γ$ = " + short_number(frame.state.strain);
}

std::size_t nearest_frame(const std::vector<Frame>& frames, double strain)
{
    const auto distance = [&](const Frame& f) { return std::abs(f.state.strain - strain); };
    return static_cast<std::size_t>(std::min_element(frames.begin(), frames.end(),
                                                     [&](const Frame& a, const Frame& b) {
                                                         return distance(a) < distance(b);
                                                     }) -
                                    frames.begin());
}

}
