// Our side of the comparison with ParaView (view_in_paraview.sh).
//
//   paraview_picture draw FOLDER      from run.h5: ours.png of the last frame without anything
//                                     around it, and expected.json: times, ranges, camera
//   paraview_picture compare FOLDER   ours.png with theirs.png; exit code 1 and the reasons if they
//                                     differ
#include "engine/error.h"
#include "io/atomic_file.h"
#include "io/run_file.h"
#include "render/colour_map.h"
#include "render/framing.h"
#include "render/particle_overlay.h"
#include "tests/support/similarity.h"
#include "workflows/particle_picture.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iostream>
#include <nlohmann/json.hpp>

namespace {

using namespace sigmaflow;
using Json = nlohmann::ordered_json;
using render::Image;
namespace fs = std::filesystem;

constexpr int width = 480, height = 400;
constexpr double least_similarity = 0.75, least_overlap = 0.975, most_tint = 6;  // [degrees]

template <class List, class Value>
Json range_of(const List& list, const Value& value)
{
    double low = 1e300, high = -1e300;
    for (const auto& one : list) {
        low = std::min<double>(low, value(one));
        high = std::max<double>(high, value(one));
    }
    return {low, high};
}

Json ranges(const Frame& frame)
{
    const auto itself = [](const auto& value) { return value; };
    const auto x = [](const Vec3& v) { return v.x(); };
    return {{"nonaffine_speed", range_of(frame.nonaffine_speed, itself)},
            {"radius", range_of(frame.state.radius, itself)},
            {"contact_number", range_of(frame.contact_number, itself)},
            {"species", range_of(frame.species, itself)},
            {"velocity", range_of(frame.velocity, x)},
            {"nonaffine_velocity", range_of(frame.nonaffine_velocity, x)},
            {"angular_velocity", range_of(frame.angular_velocity, x)}};
}

/// The camera of our picture.
render::Camera camera_of(const Frame& frame)
{
    std::vector<render::Sphere> seen;
    for (std::size_t i = 0; i < frame.state.radius.size(); ++i) {
        const Vec3& p = frame.state.position[i];
        seen.push_back({{p.x(), p.y(), p.z()}, frame.state.radius[i]});
    }
    const Vec3& box = frame.state.box.length;
    for (int corner = 0; corner < 8; ++corner)
        seen.push_back(
            {{corner & 1 ? box.x() : 0, corner & 2 ? box.y() : 0, corner & 4 ? box.z() : 0}, 0});
    const render::Rectangle room =
        render::particle_layout(width, height, false, false, false).particles;
    return render::frame_spheres(seen, static_cast<int>(room.width()),
                                 static_cast<int>(room.height()));
}

void draw(const fs::path& folder)
{
    const io::StoredRun stored = io::read_run(folder / "run.h5");
    const Frame& frame = stored.frames.back();
    workflows::ParticlePicture picture;
    picture.size = {width, height};
    render::ParticleView view = picture.particle_view(frame, "");
    view.triad = view.colour_bar = view.ambient_occlusion = false;
    const Image whole = picture.draw(frame, view);
    const render::Camera camera = camera_of(frame);
    Image cut(camera.width, camera.height);
    render::paste(cut, whole, -static_cast<int>(std::lround((width - camera.width) / 2.)),
                  -static_cast<int>(std::lround((height - camera.height) / 2.)));
    io::write_file(folder / "ours.png", render::png_bytes(cut));

    Json expected = {{"particles", frame.state.size()},
                     {"colour_maximum", *picture.common_view({frame}).colour_maximum},
                     {"camera",
                      {{"position", camera.position()},
                       {"focus", camera.focus},
                       {"up", camera.axes.up},
                       {"view_angle", camera.view_angle()},
                       {"size", {camera.width, camera.height}}}},
                     {"frames", Json::array()}};
    for (const Frame& f : stored.frames)
        expected["frames"].push_back({{"time", f.state.strain}, {"ranges", ranges(f)}});
    io::write_file(folder / "expected.json", expected.dump(1));
}

bool is_white(const std::uint8_t* pixel)
{
    return pixel[0] + pixel[1] + pixel[2] >= 3 * 250;
}

/// Shared pixels that are not white over those of either picture.
double overlap(const Image& a, const Image& b)
{
    double both = 0, either = 0;
    for (int y = 0; y < a.height; ++y)
        for (int x = 0; x < a.width; ++x) {
            const bool one = !is_white(a.pixel(x, y)), other = !is_white(b.pixel(x, y));
            both += one && other;
            either += one || other;
        }
    return both / std::max(1., either);
}

double tint_difference(const std::uint8_t* pixel, const render::Colour& colour)
{
    double dot = 0, a = 0, b = 0;
    for (std::size_t c = 0; c < 3; ++c) {
        dot += double(pixel[c]) * colour[c];
        a += double(pixel[c]) * pixel[c];
        b += double(colour[c]) * colour[c];
    }
    return std::acos(std::min(1., dot / std::sqrt(std::max(1., a * b)))) * 180 / M_PI;
}

/// Particles of which nothing hides the middle, with their pixels.
std::vector<std::pair<std::size_t, render::Point>> unhidden(const Frame& frame,
                                                            const render::Camera& camera)
{
    std::vector<std::pair<std::size_t, render::Point>> result;
    const auto place = [&](std::size_t i) {
        const Vec3& p = frame.state.position[i];
        return render::Position{p.x(), p.y(), p.z()};
    };
    for (std::size_t i = 0; i < frame.state.radius.size(); ++i) {
        const render::Point at = camera.project(place(i));
        bool hidden = false;
        for (std::size_t j = 0; j < frame.state.radius.size(); ++j) {
            if (i == j || camera.depth(place(j)) > camera.depth(place(i)) + 1) continue;
            const render::Point other = camera.project(place(j));
            const double pixels =
                0.5 * camera.height / (camera.half_height * camera.depth(place(j)));
            hidden = hidden || std::hypot(at.x - other.x, at.y - other.y) <
                                   pixels * frame.state.radius[j] + 3;
        }
        if (!hidden) result.emplace_back(i, at);
    }
    return result;
}

int compare(const fs::path& folder)
{
    const Image ours = render::read_png(folder / "ours.png");
    const Image theirs = render::read_png(folder / "theirs.png");
    const Frame frame = io::read_run(folder / "run.h5").frames.back();
    if (ours.width != theirs.width || ours.height != theirs.height) {
        std::cerr << "wrong: sizes " << ours.width << " x " << ours.height << " and "
                  << theirs.width << " x " << theirs.height << "\n";
        return 1;
    }
    const double found = test::similarity(ours, theirs), shared = overlap(ours, theirs);
    std::cout << "similarity " << found << " (at least " << least_similarity << "), outlines "
              << shared << " (at least " << least_overlap << ")\n";
    int wrong = found < least_similarity || shared < least_overlap, checked = 0;
    const double largest = *workflows::ParticlePicture{}.common_view({frame}).colour_maximum;
    double worst = 0;
    for (const auto& [i, at] : unhidden(frame, camera_of(frame))) {
        const render::Colour colour =
            render::map_colour("inferno", frame.nonaffine_speed[i] / largest);
        if (colour[0] + colour[1] + colour[2] < 120) continue;  // nearly black: no tint
        ++checked;
        const int x = static_cast<int>(at.x), y = static_cast<int>(at.y);
        for (const Image* image : {&ours, &theirs}) {
            const double tint = tint_difference(image->pixel(x, y), colour);
            worst = std::max(worst, tint);
            if (tint < most_tint) continue;
            std::cerr << "wrong: particle " << i << " differs from its colour by " << tint
                      << " degrees in " << (image == &ours ? "our" : "ParaView's") << " picture\n";
            wrong = 1;
        }
    }
    std::cout << "colours of " << checked << " particles within " << worst << " degrees (at most "
              << most_tint << ")\n";
    return wrong || checked < 10;
}

}

int main(int count, char** arguments)
{
    const std::string what = count == 3 ? arguments[1] : "";
    try {
        if (what == "compare") return compare(arguments[2]);
        if (what != "draw") return 64;
        draw(arguments[2]);
        return 0;
    } catch (const Error& error) {
        std::cerr << error.what() << "\n";
        return 1;
    }
}
