#include "engine/motion.h"

#include "engine/checks.h"
#include "engine/lean_resize.h"

#include <algorithm>
#include <array>

namespace sigmaflow {

namespace {

/// Walks along contacts sorted by (i, j), with sorted queries from a pair on.
class ContactFinder {
public:
    ContactFinder(const std::vector<ContactLoad>& contacts, const Pair& from) : contacts_(contacts)
    {
        const auto earlier = [](const ContactLoad& c, const Pair& pair) {
            return std::pair(c.memory.i, c.memory.j) < std::pair(pair.i, pair.j);
        };
        at_ = std::lower_bound(contacts.begin(), contacts.end(), from, earlier) - contacts.begin();
    }

    /// Index of the contact, or -1.
    int find(const Pair& pair)
    {
        for (; at_ < contacts_.size(); ++at_) {
            const Contact& c = contacts_[at_].memory;
            if (c.i > pair.i || (c.i == pair.i && c.j >= pair.j))
                return c.i == pair.i && c.j == pair.j ? static_cast<int>(at_) : -1;
        }
        return -1;
    }

private:
    const std::vector<ContactLoad>& contacts_;
    std::size_t at_;
};

}

void shift(const State& start, std::span<const Stage> stages, int threads, State& result)
{
    result = start;
    for (const Stage& stage : stages) {
        const double strain = stage.shear_rate * stage.dt;
        for_each(threads, start.position.size(), [&](int i) {
            result.position[i] += stage.dt * stage.nonaffine[i].head<3>();
            result.position[i].x() += strain * stage.state.position[i].y();
        });
        result.box.offset += strain * start.box.length.y();
        result.strain += strain;
        result.time += stage.dt;
    }
}

void move_contacts(std::span<const Stage> stages, const Model& model, const Control& control,
                   State& moved, Workspace::Buffers& b, Evaluation* mean)
{
    locate(moved, model, b);
    const Stiffness stiff = stiffness(model, control);
    const std::size_t count = b.touching_pairs.size();
    lean_resize(moved.contacts, count);
    lean_resize(b.friction_share, count);
    if (mean) {
        lean_resize(mean->contacts, count);
        lean_resize(mean->motion, count);
    }
    double time = 0;
    for (const Stage& stage : stages) time += stage.dt;
    bool finite = true;
    with_team(b.threads, [&](const Team& team) {
        const Range own = team.share(0, static_cast<int>(count));
        if (own.begin == own.end) return;
        const Pair& from = b.touching_pairs[own.begin];
        std::array finders{ContactFinder(stages.front().contacts, from),
                           ContactFinder(stages.back().contacts, from)};
        for (int k = own.begin; k < own.end; ++k) {
            const Pair& pair = b.touching_pairs[k];
            Contact memory{pair.i, pair.j};
            ContactMotion total{Vec3::Zero(), Vec3::Zero()};
            for (std::size_t s = 0; s < stages.size(); ++s) {
                const Stage& stage = stages[s];
                const int c = finders[s].find(pair);
                if (c < 0) continue;
                const ContactLoad& contact = stage.contacts[c];
                const Vec3& normal = contact.pair.normal;
                total.slip += stage.dt * carried(stage.motion[c].slip, normal, pair.normal);
                total.roll += stage.dt * carried(stage.motion[c].roll, normal, pair.normal);
                if (s > 0) continue;
                memory.spring = carried(contact.memory.spring, normal, pair.normal);
                memory.rolling = carried(contact.memory.rolling, normal, pair.normal);
                memory.sliding = contact.memory.sliding;
            }
            memory.spring += total.slip;
            memory.rolling += total.roll;
            const ContactLoad load = contact_load(pair, moved.radius[pair.i], moved.radius[pair.j],
                                                  memory, model, stiff);
            moved.contacts[k] = load.memory;
            if (!is_finite(load.memory)) {
#pragma omp atomic write
                finite = false;
            }
            const double stretch = memory.spring.norm();
            b.friction_share[k] =
                load.memory.sliding && stretch > 0 ? load.memory.spring.norm() / stretch : 1;
            if (!mean) continue;
            mean->contacts[k] = load;
            mean->motion[k] = {total.slip / time, total.roll / time};
        }
    });
    if (!finite) refuse_springs(moved.contacts);
}

}
