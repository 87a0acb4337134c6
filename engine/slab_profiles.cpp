#include "engine/slab_profiles.h"

#include "engine/error.h"
#include "engine/slabs.h"

#include <string>

namespace sigmaflow {

namespace {

void check(const Frame& frame, int slabs)
{
    const auto refuse = [](const std::string& problem) {
        throw Error(ErrorKind::input, "slab profiles", problem);
    };
    if (slabs < 1) refuse("slabs must be at least 1, got " + std::to_string(slabs));
    const std::size_t n = frame.state.radius.size();
    if (n == 0) refuse("at least one particle is needed, got 0");
    if (frame.nonaffine_velocity.size() != n || frame.particle_stress.size() != n)
        refuse("velocities and stresses of " + std::to_string(n) + " particles are needed");
}

std::vector<double> frictional_contacts(const Frame& frame)
{
    std::vector<double> number(frame.state.radius.size());
    for (const ContactForce& contact : frame.contacts) {
        if (!contact.frictional) continue;
        ++number[static_cast<std::size_t>(contact.i)];
        ++number[static_cast<std::size_t>(contact.j)];
    }
    return number;
}

/// Divides by the volumes; where there is none, the value lies on the line between the neighbours.
std::vector<double> divided(const std::vector<double>& sum, const std::vector<double>& volume)
{
    const std::size_t slabs = sum.size();
    std::vector<double> result(slabs);
    for (std::size_t k = 0; k < slabs; ++k) {
        std::size_t down = 0, up = 0;
        while (!(volume[(k + slabs - down) % slabs] > 0)) ++down;
        while (!(volume[(k + up) % slabs] > 0)) ++up;
        const std::size_t below = (k + slabs - down) % slabs, above = (k + up) % slabs;
        const double share =
            down + up > 0 ? static_cast<double>(down) / static_cast<double>(down + up) : 0;
        result[k] = (1 - share) * sum[below] / volume[below] + share * sum[above] / volume[above];
    }
    return result;
}

}

SlabProfiles slab_profiles(const Frame& frame, Axis axis, int slabs)
{
    check(frame, slabs);
    const State& state = frame.state;
    const std::vector<double> contacts = frictional_contacts(frame);
    const double slab_volume = state.box.volume() / slabs;
    std::vector<double> volume(static_cast<std::size_t>(slabs));
    std::vector<double> flux = volume, touching = volume;
    SlabProfiles result;
    result.shear_stress.assign(volume.size(), frame.sample.shear_rate);
    for (std::size_t i = 0; i < state.radius.size(); ++i) {
        const double radius = state.radius[i], sphere = 4 * pi / 3 * radius * radius * radius;
        const double stress = frame.particle_stress[i](flow, gradient) / sphere / slab_volume;
        for_each_slab(state.position[i](axis), radius, state.box.length(axis), slabs,
                      [&](int slab, double weight) {
                          const auto k = static_cast<std::size_t>(slab);
                          volume[k] += weight;
                          flux[k] += weight * frame.nonaffine_velocity[i].x();
                          touching[k] += weight * contacts[i];
                          result.shear_stress[k] += weight * stress;
                      });
    }
    for (int k = 0; k < slabs; ++k) result.position.push_back((k + 0.5) / slabs);
    for (double v : volume) result.volume_fraction.push_back(v / slab_volume);
    result.nonaffine_velocity = divided(flux, volume);
    result.frictional_contact_number = divided(touching, volume);
    return result;
}

std::vector<double> local_shear_rate(const std::vector<double>& nonaffine_velocity,
                                     double shear_rate, double height)
{
    if (!std::isfinite(shear_rate) || shear_rate == 0)
        throw Error(
            ErrorKind::numerics, "local shear rate",
            "the shear rate must be finite and not zero, got " + std::to_string(shear_rate));
    const std::size_t slabs = nonaffine_velocity.size();
    std::vector<double> rate(slabs);
    for (std::size_t k = 0; k < slabs; ++k)
        rate[k] = 1 + static_cast<double>(slabs) *
                          (nonaffine_velocity[(k + 1) % slabs] - nonaffine_velocity[k]) /
                          (shear_rate * height);
    return rate;
}

}
