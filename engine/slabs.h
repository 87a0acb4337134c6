// engine/slabs.h -- spheres shared between equal slabs across one axis of the periodic box.
//
// Slab k of `count` along a length L holds [k, k + 1) L/count. A sphere counts in every slab that
// it overlaps, with the volume of the overlap; one that sticks out over the end goes on in the
// first slab. The overlaps of a sphere add up to its volume.
#pragma once
#include "engine/units.h"

#include <algorithm>
#include <cmath>

namespace sigmaflow {

/// Volume of a sphere below the height s over its centre.
inline double volume_below(double radius, double s)
{
    s = std::clamp(s, -radius, radius);
    return pi * (radius * radius * s - s * s * s / 3 + 2 * radius * radius * radius / 3);
}

/// The slab of a place that is measured in slabs and may lie outside the box.
inline int folded_slab(double slab, int count)
{
    const double k = slab - count * std::floor(slab / count);
    return std::min(static_cast<int>(k), count - 1);
}

/// Calls visit(slab, volume of the overlap [a^3]) for every slab that the sphere overlaps.
template <class Visit>
void for_each_slab(double centre, double radius, double length, int count, const Visit& visit)
{
    const double thickness = length / count;
    const double lowest = std::floor((centre - radius) / thickness);
    const double highest = std::floor((centre + radius) / thickness);
    for (double slab = lowest; slab <= highest; ++slab)
        visit(folded_slab(slab, count), volume_below(radius, (slab + 1) * thickness - centre) -
                                            volume_below(radius, slab * thickness - centre));
}

}
