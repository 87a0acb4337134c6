#include "engine/state.h"

#include "engine/units.h"

#include <algorithm>

namespace sigmaflow {

double volume_fraction(const State& state)
{
    double cubes = 0;
    for (double a : state.radius) cubes += a * a * a;
    return 4 * pi / 3 * cubes / state.box.volume();
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
