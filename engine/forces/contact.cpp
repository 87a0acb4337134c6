#include "engine/forces/contact.h"

#include <algorithm>

namespace sigmaflow {

namespace {

constexpr double slip_tolerance = 1e-10;

struct Limited {
    Vec3 stretch, force;
    bool slips;
};

// Force of a tangential spring, rescaled to `target` if it exceeds `limit`.
inline Limited limited(const Vec3& stretch, const Vec3& normal, double stiffness, double limit,
                double target)
{
    const Vec3 t = stretch - stretch.dot(normal) * normal;
    const Vec3 force = stiffness * t;
    const double size = force.norm();
    if (size <= (1 - slip_tolerance) * limit) return {t, force, false};
    const double scale = size > 0 ? target / size : 1;
    return {scale * t, scale * force, true};
}

}

ContactLoad contact_load(const Pair& pair, double a, double b, const Contact& memory,
                         const Model& m, const Stiffness& k)
{
    const double mean = (a + b) / 2, harmonic = 2 * a * b / (a + b);
    const Vec3& n = pair.normal;
    ContactLoad c;
    c.pair = pair;
    c.load = -reference_force * k.normal * mean * mean * pair.xi;
    const double load = std::max(c.load - reference_force * m.critical_load, 0.);
    c.frictional = load > 0 && m.friction_static > 0;

    const double mu = memory.sliding ? m.friction_dynamic : m.friction_static;
    const Limited t = limited(memory.spring, n, reference_force * k.tangential * mean, mu * load,
                              m.friction_dynamic * load);
    c.memory = {pair.i, pair.j, t.stretch, Vec3::Zero(), t.slips};
    c.friction = t.force;
    c.force_on_i = t.force - c.load * n;
    const Vec3 lever = n.cross(t.force);
    c.torque_on_i = a * lever;
    c.torque_on_j = b * lever;
    if (k.rolling > 0) {
        const double rolling_limit = m.rolling_friction * load;
        const Limited rho = limited(memory.rolling, n, reference_force * k.rolling * mean,
                                    rolling_limit, rolling_limit);
        const Vec3 roll = harmonic * n.cross(rho.force);
        c.memory.rolling = rho.stretch;
        c.torque_on_i += roll;
        c.torque_on_j -= roll;
    }
    return c;
}

}
