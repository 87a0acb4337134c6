#include "io/state_check.h"

#include "engine/checks.h"
#include "engine/pairs.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace sigmaflow::io {
namespace {

/// Two centres in one cell so small that spheres there overlap too deeply. Finding them first
/// bounds the number of pairs that any later search can meet.
std::vector<Candidate> crowded_pair(const State& state)
{
    Box box = state.box;
    std::vector<Vec3> position = state.position;
    wrap(box, position);
    // its diagonal is sqrt(3)/2 of the smallest distance that is allowed
    const double smallest = *std::min_element(state.radius.begin(), state.radius.end());
    const double edge = smallest * (1 + deepest_overlap / 2);
    struct Place {
        std::array<std::int64_t, 3> cell;
        int particle;
    };
    std::vector<Place> places;
    places.reserve(position.size());
    for (const Vec3& x : position)
        places.push_back(
            {{static_cast<std::int64_t>(x.x() / edge), static_cast<std::int64_t>(x.y() / edge),
              static_cast<std::int64_t>(x.z() / edge)},
             static_cast<int>(places.size())});
    std::sort(places.begin(), places.end(), [](const Place& a, const Place& b) {
        return a.cell != b.cell ? a.cell < b.cell : a.particle < b.particle;
    });
    const auto same = std::adjacent_find(places.begin(), places.end(),
                                         [](auto& a, auto& b) { return a.cell == b.cell; });
    if (same == places.end()) return {};
    return {{same->particle, (same + 1)->particle}};
}

double reduced_gap(const State& state, const Candidate& pair)
{
    const auto [i, j] = pair;
    const double sum = state.radius[i] + state.radius[j];
    const double distance = separation(state.box, state.position[i], state.position[j]).d.norm();
    return 2 * (distance - sum) / sum;
}

[[noreturn]] void refuse_overlap(const State& state, const Candidate& pair, const JsonNode& node)
{
    const auto [i, j] = pair;
    const double xi = reduced_gap(state, pair);
    const std::string spheres = "spheres " + std::to_string(i) + " and " + std::to_string(j);
    throw node.member("positions")
        .element(static_cast<std::size_t>(j))
        .error(xi == -2 ? "the centres of " + spheres + " coincide"
                        : spheres + " overlap: their reduced gap xi must be >= " +
                              number_text(deepest_overlap) + ", got " + number_text(xi));
}

}

void check_state(const State& state, double range, const JsonNode& node)
{
    const double solid = volume_fraction(state);
    if (!(solid < 1))
        throw node.member("box").error(
            "the spheres must fill less than the whole box, got a volume fraction of " +
            number_text(solid));
    const double reach = *std::max_element(state.radius.begin(), state.radius.end()) * (2 + range);
    for (int axis = 0; axis < 3; ++axis)
        if (state.box.length[axis] < reach)
            throw node.member("box")
                .element(static_cast<std::size_t>(axis))
                .wrong("must be >= " + number_text(reach) +
                       " [a], the distance up to which two of the largest spheres interact");
    std::vector<Candidate> pairs = crowded_pair(state);
    if (pairs.empty()) pairs = close_pairs(state, deepest_overlap, 0);
    if (pairs.empty()) return;
    const auto gap = [&](const Candidate& pair) { return reduced_gap(state, pair); };
    refuse_overlap(state, *std::ranges::min_element(pairs, {}, gap), node);
}

}
