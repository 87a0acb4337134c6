#include "engine/state.h"

#include "engine/error.h"
#include "engine/units.h"

#include <algorithm>
#include <cmath>
#include <string>

namespace sigmaflow {

double volume_fraction(const State& state)
{
    double cubes = 0;
    for (double a : state.radius) cubes += a * a * a;
    return 4 * pi / 3 * cubes / state.box.volume();
}

void check_stored_state(const State& s)
{
    const auto refuse = [](const std::string& problem) {
        throw Error(ErrorKind::input, "", problem);
    };
    if (s.radius.empty() || s.radius.size() != s.position.size())
        refuse("needs a radius and a position for every particle, at least one");
    const auto positive = [](double x) { return x > 0 && std::isfinite(x); };
    if (!std::all_of(s.radius.begin(), s.radius.end(), positive) ||
        !std::all_of(s.box.length.begin(), s.box.length.end(), positive))
        refuse("radii and box lengths must be positive");
    bool finite = std::isfinite(s.box.offset) && std::isfinite(s.strain) && std::isfinite(s.time) &&
                  std::isfinite(s.time_step);
    for (const Vec3& x : s.position) finite = finite && x.allFinite();
    for (const Contact& c : s.contacts)
        finite = finite && c.spring.allFinite() && c.rolling.allFinite();
    if (!finite) refuse("has numbers that are not finite");
    constexpr double farthest = 1e9;  // boxes; beyond, nearest images lose their digits
    for (const Vec3& x : s.position)
        for (int k = 0; k < 3; ++k)
            if (std::abs(x[k]) > farthest * s.box.length[k])
                refuse("positions must lie within 1e9 boxes");
    if (std::abs(s.box.offset) > farthest * s.box.length.x())
        refuse("the box offset must be less than 1e9 boxes");
    if (2 * *std::max_element(s.radius.begin(), s.radius.end()) > s.box.length.minCoeff())
        refuse("particles must fit into the box");
    std::pair before{-1, -1};
    for (const Contact& c : s.contacts) {
        const std::pair pair{c.i, c.j};
        if (pair <= before || c.i < 0 || c.i >= c.j || c.j >= s.size())
            refuse("contacts must be sorted pairs i < j < " + std::to_string(s.size()));
        before = pair;
    }
}

State mirrored(State state)
{
    state.box.offset = -state.box.offset;
    for (Vec3& position : state.position) position.x() = -position.x();
    // stretches are no axial vectors
    for (Contact& contact : state.contacts)
        for (Vec3* stretch : {&contact.spring, &contact.rolling}) stretch->x() = -stretch->x();
    state.time_step = 0;
    return state;
}

std::vector<int> species(const State& state)
{
    std::vector<double> distinct = state.radius;
    std::sort(distinct.begin(), distinct.end());
    distinct.erase(std::unique(distinct.begin(), distinct.end()), distinct.end());
    std::vector<int> result;
    result.reserve(state.radius.size());
    for (double a : state.radius)
        result.push_back(static_cast<int>(std::lower_bound(distinct.begin(), distinct.end(), a) -
                                          distinct.begin()));
    return result;
}

}
