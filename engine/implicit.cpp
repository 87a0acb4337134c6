// evaluate_implicitly: contact springs and repulsion at the positions that the stage itself
// reaches.
//
// A spring of stiffness k that follows a relative motion v for the time `ahead` changes its force
// by
// - ahead k v: the structure of a pair resistance with XA = ahead kn, YA = ahead kt, YB11 = - a YA,
// YB21 = - b YA, YC11 = a^2 YA, YC12 = a b YA, YC22 = b^2 YA. So the matrix, the load of the affine
// flow and the stress change only by other coefficients for touching pairs, and stay symmetric.
#include "engine/ambient.h"
#include "engine/error.h"
#include "engine/evaluation.h"
#include "engine/workspace.h"

namespace sigmaflow {

namespace {

// Horizon of the secant stiffness of sliding contacts, in steps. Less brakes the sliding (it is the
// first-order error of the scheme in the friction), more leaves the springs too stiff for the step.
constexpr double secant_steps = 2;

// A sliding contact resists further sliding by its limit, not by its stiffness: the slope of the
// secant of its force over the coming steps relative to the stiffness.
double sliding_factor(const ContactLoad& c, const Vec3& slip, double horizon)
{
    const double stretch = c.memory.spring.norm();
    const double later = (c.memory.spring + horizon * slip).norm();
    return later > stretch ? stretch / later : 1;
}

BlockCoefficients spring_resistance(const State& s, const Pair& pair, const Stiffness& k,
                                    double ahead, double factor)
{
    const double a = s.radius[pair.i], b = s.radius[pair.j];
    const double scale = reference_force * ahead * (a + b) / 2;
    const double shear = scale * k.tangential * factor;
    const double harmonic = 2 * a * b / (a + b);
    const double roll = scale * k.rolling * harmonic * harmonic;
    return {scale * k.normal,     shear,
            -a * shear,           -b * shear,
            a * a * shear + roll, a * b * shear - roll,
            b * b * shear + roll};
}

// Twice the added resistance times the motion of the first stage, with exactly the matrix of this
// stage: then the scheme is of second order whatever the matrix leaves out.
void add_earlier(const Evaluation& first, const Pair& pair, const BlockCoefficients& c,
                 const AffineLoad& affine, Workspace::Buffers& b, Loads& loads)
{
    lubrication::PairResistance r;
    r.xa = c.xa;
    r.ya = c.ya;
    r.yb11 = c.yb11;
    r.yb21 = c.yb21;
    r.yc11 = c.yc11;
    r.yc12 = c.yc12;
    r.yc22 = c.yc22;
    const Vec6 &vi = first.nonaffine[pair.i], &vj = first.nonaffine[pair.j];
    const lubrication::PairLoad own = lubrication::resistance_times(r, pair.normal, vi, vj);
    const double rate = first.shear_rate;
    const auto twice = [rate](const Vec3& resisted, const Vec3& driven) -> Vec3 {
        return 2 * (resisted - rate * driven);
    };
    const lubrication::PairLoad& flow_load = affine.load;
    add(b.fixed_load, pair,
        {twice(own.force_i, flow_load.force_i), twice(own.torque_i, flow_load.torque_i),
         twice(own.force_j, flow_load.force_j), twice(own.torque_j, flow_load.torque_j)});
    const double work = flow_load.force_i.dot(vi.head<3>()) + flow_load.torque_i.dot(vi.tail<3>()) +
                        flow_load.force_j.dot(vj.head<3>()) + flow_load.torque_j.dot(vj.tail<3>());
    loads.first_moment += 2 * (work - rate * affine.stress);
}

void add_to_block(ResistanceMatrix& matrix, std::size_t index, const BlockCoefficients& c)
{
    PairBlock& block = matrix.pairs[index];
    add_pair(matrix.diagonal[block.i], block.normal, c.xa, c.ya, c.yb11, c.yc11);
    add_pair(matrix.diagonal[block.j], block.normal, c.xa, c.ya, -c.yb21, c.yc22);
    block.xa += c.xa;
    block.ya += c.ya;
    block.yb11 += c.yb11;
    block.yb21 += c.yb21;
    block.yc12 += c.yc12;
}

/// Velocities from which the slip of sliding contacts is estimated.
struct Estimate {
    Velocities nonaffine;
    double rate;
};

}

Evaluation evaluate_implicitly(const State& state, const Model& model, const Control& control,
                               const ImplicitStage& stage, Workspace& workspace)
{
    if (uses_dashpot(model))
        throw Error(ErrorKind::input, "contact_hydrodynamics",
                    "\"dashpot\" cannot be used with the scheme \"implicit\"");
    Workspace::Buffers& b = workspace.buffers();
    Evaluation e = prepare(state, model, control, b);
    Loads loads = assemble_loads(state, e, b);
    const Stiffness k = stiffness(model, control);
    SolutionHistory& history = b.history[stage.earlier ? 1 : 0];
    const Estimate estimate = stage.earlier
                                  ? Estimate{stage.earlier->nonaffine, stage.earlier->shear_rate}
                                  : Estimate{history.guess(state.time), b.last_rate};
    std::size_t block = 0, contact = 0;
    for (const PairState& p : e.pairs) {
        const Pair& pair = p.pair;
        const ContactLoad* touch = pair.touching() ? &e.contacts[contact++] : nullptr;
        if (p.factors.L == 0) continue;  // not in the matrix
        while (b.matrix.pairs[block].candidate != pair.candidate) ++block;
        BlockCoefficients r{};
        if (touch) {
            double factor = 1;
            if (touch->memory.sliding && !estimate.nonaffine.empty()) {
                const PairVelocities v = moving(state, estimate.nonaffine, estimate.rate, pair);
                factor = sliding_factor(*touch, relative_motion(state, v, pair).slip,
                                        secant_steps * stage.step);
            }
            r = spring_resistance(state, pair, k, stage.ahead, factor);
        } else {
            r.xa = stage.ahead * p.repulsion / model.debye_length;
        }
        if (r.xa == 0 && r.ya == 0) continue;
        add_to_block(b.matrix, block, r);
        const AffineLoad affine = affine_load(state, pair, r);
        add(b.unit_load, pair, affine.load);
        loads.affine += affine.stress;
        if (stage.earlier) add_earlier(*stage.earlier, pair, r, affine, b, loads);
    }
    solve_at_once(state, loads, history, b, e);
    complete(state, e);
    return e;
}

}
