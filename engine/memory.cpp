#include "engine/memory.h"

#include "engine/workspace.h"

#include <algorithm>
#include <cmath>

namespace sigmaflow {

namespace {

bool is_located(const State& s, const Workspace::Buffers& b)
{
    return b.located && b.box.offset == s.box.offset && b.box.length == s.box.length &&
           b.position == s.position && b.radius == s.radius;
}

/// The implicit step that led to the state, if one did.
const PastStep* step_before(const State& s, const Workspace::Buffers& b)
{
    for (const PastStep& past : b.past)
        if (past.time == s.time && past.mean.contacts.size() == s.contacts.size() &&
            past.mean.nonaffine.size() == s.position.size())
            return &past;
    return nullptr;
}

bool is_finite(const Velocities& v)
{
    return std::all_of(v.begin(), v.end(), [](const Vec6& one) { return one.allFinite(); });
}

void check(bool good)
{
    if (!good) throw Error(ErrorKind::input, "", "has a memory that no run can have");
}

void check_history(const SolutionHistory& h, std::size_t particles)
{
    check(h.known >= 0 && h.known <= 2);
    for (int k = 0; k < 2; ++k)
        check((h.solution[k].size() == particles || (k >= h.known && h.solution[k].empty())) &&
              std::isfinite(h.time[k]) && std::isfinite(h.rate[k]) && is_finite(h.solution[k]));
}

void check_past(const PastStep& past, const State& s)
{
    check(past.time == s.time && past.dt >= 0 && std::isfinite(past.dt) &&
          std::isfinite(past.mean.shear_rate) && is_finite(past.mean.nonaffine) &&
          past.mean.nonaffine.size() == s.position.size());
    const auto& contacts = past.mean.contacts;
    check(contacts.size() == s.contacts.size() && past.mean.motion.size() == contacts.size());
    for (std::size_t k = 0; k < contacts.size(); ++k) {
        const Contact &own = contacts[k].memory, &contact = s.contacts[k];
        const Pair& pair = contacts[k].pair;
        check(own.i == contact.i && own.j == contact.j && pair.i == contact.i &&
              pair.j == contact.j);
    }
}

}

void save_memory(const State& state, Workspace& workspace, ArchiveWriter& a)
{
    Workspace::Buffers& b = workspace.buffers();
    const bool known = !b.neighbours.empty();
    a(known);
    if (known) {
        a(b.neighbours, is_located(state, b));
        b.solver.save(a);
    }
    std::optional<PastStep> past;
    if (const PastStep* found = step_before(state, b)) past = *found;
    a(b.history, past, b.hydrodynamic, b.solution, b.other_solution);
}

void restore_memory(const State& state, const Model& model, Workspace& workspace, ArchiveReader& a)
{
    check_stored_state(state);
    Workspace::Buffers& b = workspace.buffers();
    bool known = false;
    a(known);
    if (known) {
        bool located = false;
        a(b.neighbours, located);
        b.neighbours.find_again(state, b.threads);
        make_pattern(b.neighbours.reference(), b);
        const NeighbourList::Use use = b.neighbours.use();
        if (located) locate(state, model, b);
        b.neighbours.set_use(use);  // the list was used for this state before
        b.solver.restore(a);
    }
    std::optional<PastStep> past;
    a(b.history, past, b.hydrodynamic, b.solution, b.other_solution);
    check_history(b.history, state.position.size());
    check(is_finite(b.hydrodynamic));
    if (past) {
        check_past(*past, state);
        b.past[0] = std::move(*past);
    }
}

}
