#include "engine/checks.h"

#include "engine/error.h"
#include "engine/lanes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <limits>
#include <string>

namespace sigmaflow {

namespace {

constexpr double farthest = 1e6;  // from the box [box lengths]
constexpr double largest = std::numeric_limits<double>::max();

std::string text(double value)
{
    char digits[32];
    std::snprintf(digits, sizeof digits, "%.6g", value);
    return digits;
}

[[noreturn]] void refuse(const std::string& what, const std::string& problem)
{
    throw Error(ErrorKind::numerics, "", what + " " + problem);
}

std::string of_particle(const char* quantity, std::size_t i)
{
    return std::string(quantity) + " of particle " + std::to_string(i);
}

[[noreturn]] void refuse_position(const State& s, double limit)
{
    std::size_t i = 0;
    while (all_within(s.position[i].data(), 3, limit)) ++i;
    if (s.position[i].allFinite())
        refuse(of_particle("the position", i),
               "lies more than " + text(farthest) + " box lengths from the box");
    refuse(of_particle("the position", i), "is not finite");
}

[[noreturn]] void refuse_radius(const State& s)
{
    std::size_t i = 0;
    while ((s.radius[i] > 0 && s.radius[i] <= largest)) ++i;
    refuse(of_particle("the radius", i), "is " + text(s.radius[i]) + ", must be finite and > 0");
}

}

bool is_finite(const Contact& c)
{
    return std::isfinite(c.spring.sum() + c.rolling.sum());
}

void refuse_springs(const std::vector<Contact>& contacts)
{
    const Contact& c = *std::find_if_not(contacts.begin(), contacts.end(), is_finite);
    refuse("the spring of the contact of particles " + std::to_string(c.i) + " and " +
               std::to_string(c.j),
           "is not finite");
}

void check_scalar(double value, const char* name)
{
    if (!std::isfinite(value)) refuse(name, "is not finite");
}

SIGMAFLOW_HOT bool all_within(const double* values, std::size_t count, double limit)
{
    // what is larger overflows, and the difference of infinities is not a number
    const double scale = largest / limit;
    d8 sum{};
    std::size_t k = 0;
    for (; k + lanes <= count; k += lanes) {
        d8 v;
        std::memcpy(&v, values + k, sizeof v);
        v *= scale;
        sum += v - v;
    }
    double rest = 0;
    for (; k < count; ++k) rest += values[k] * scale - values[k] * scale;
    return total(sum) + rest == 0;
}

bool all_finite(const double* values, std::size_t count)
{
    return all_within(values, count, largest);
}

void check_geometry(const State& s)
{
    if (s.position.size() != s.radius.size())
        refuse("the state", "has " + std::to_string(s.position.size()) + " positions and " +
                                std::to_string(s.radius.size()) + " radii");
    const Box& box = s.box;
    if (!box.length.allFinite() || !(box.length.minCoeff() > 0))
        refuse("the box lengths " + text(box.length.x()) + ", " + text(box.length.y()) + ", " +
                   text(box.length.z()),
               "are not all finite and > 0");
    check_scalar(box.offset, "the box offset");
    const double limit = farthest * box.length.minCoeff();
    if (std::abs(box.offset) > limit)
        refuse("the box offset", "is more than " + text(farthest) + " box lengths");
    if (s.position.empty()) return;
    if (!all_within(s.position.front().data(), 3 * s.position.size(), limit))
        refuse_position(s, limit);
    bool positive = true;
    for (double a : s.radius) positive &= a > 0;
    if (!positive || !all_finite(s.radius.data(), s.radius.size())) refuse_radius(s);
}

void check_clock(const State& s)
{
    check_scalar(s.strain, "the strain");
    check_scalar(s.time, "the time");
    check_scalar(s.time_step, "the time step");
}

void check_state(const State& s)
{
    check_geometry(s);
    check_clock(s);
    bool finite = true, sorted = true;
    int i = -1, j = -1;
    for (const Contact& c : s.contacts) {
        finite = finite && is_finite(c);
        sorted =
            sorted && c.i >= 0 && c.i < c.j && c.j < s.size() && (c.i > i || (c.i == i && c.j > j));
        i = c.i;
        j = c.j;
    }
    if (!finite) refuse_springs(s.contacts);
    if (!sorted)
        refuse("the contacts", "are not pairs i < j < " + std::to_string(s.size()) + " in order");
}

void check_forces(const std::vector<ContactLoad>& contacts)
{
    for (const ContactLoad& c : contacts)
        if (!std::isfinite(c.load + c.force_on_i.sum() + c.torque_on_i.sum() + c.torque_on_j.sum()))
            refuse("the force of the contact of particles " + std::to_string(c.pair.i) + " and " +
                       std::to_string(c.pair.j),
                   "is not finite");
}

void check_model(const Model& m, const Control& control)
{
    struct Number {
        const char* name;
        double value;
    };
    const std::array numbers{Number{"lubrication_delta", m.lubrication_delta},
                             Number{"lubrication_range", m.lubrication_range},
                             Number{"contact_relaxation_time", m.contact_relaxation_time},
                             Number{"normal_stiffness", m.normal_stiffness},
                             Number{"tangential_stiffness", m.tangential_stiffness},
                             Number{"friction_static", m.friction_static},
                             Number{"friction_dynamic", m.friction_dynamic},
                             Number{"critical_load", m.critical_load},
                             Number{"rolling_stiffness", m.rolling_stiffness},
                             Number{"rolling_friction", m.rolling_friction},
                             Number{"repulsion", m.repulsion},
                             Number{"debye_length", m.debye_length},
                             Number{"repulsion_range", m.repulsion_range},
                             Number{"drag_factor", m.drag_factor}};
    for (const Number& number : numbers) check_scalar(number.value, number.name);
    if (const auto* stress = std::get_if<ImposedStress>(&control))
        check_scalar(stress->value, "the imposed stress");
    else
        check_scalar(std::get<ImposedRate>(control).value, "the imposed rate");
}

void check_overlaps(const std::vector<Pair>& pairs)
{
    const auto deeper = [](const Pair& p, const Pair& q) { return p.xi < q.xi; };
    const auto worst = std::min_element(pairs.begin(), pairs.end(), deeper);
    if (worst == pairs.end() || worst->xi >= deepest_overlap) return;
    refuse("particles " + std::to_string(worst->i) + " and " + std::to_string(worst->j),
           "overlap by " + text(-worst->xi) + " of their mean radius, the limit is " +
               text(-deepest_overlap));
}

}
