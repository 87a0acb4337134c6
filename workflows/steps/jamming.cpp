// Step "jamming": above which stress does a suspension jam, and does it flow again?
//
// Each start packs with a seed of its own and shears at the lowest stress. From there every stress
// is tried, and the highest one that flows is bracketed by bisection. The state that jammed at the
// lowest stress is then tried at the lowest stress (unjamming) and at its own stress in the other
// direction (reversal, in a mirror). Starts and volume fractions are parts (workflows/parts.h).
#include "engine/jamming.h"
#include "engine/random.h"
#include "workflows/jamming_report.h"
#include "workflows/parts.h"
#include "workflows/start.h"
#include "workflows/steps.h"

#include <algorithm>
#include <cmath>

namespace sigmaflow::workflows {

namespace {

struct Jamming {
    Start start;
    std::vector<double> volume_fractions;
    double lowest_stress = 0.5, highest_stress = 50, ratio = 1.1;
    double strain_before = 1, strain = 2;
    int starts = 3;
    io::ModelChanges model;
    PictureSize size{1440, 1080};

    void describe(io::Fields& f)
    {
        start.describe(f);
        f("volume_fractions", volume_fractions, io::Length{1, 1000}, io::above_to(0, 1), "-",
          "to be searched, instead of one");
        f("starts", starts, io::Integers{1, 10'000}, "-",
          "packings at each, with seeds made from that of the suspension");
        f("lowest_stress", lowest_stress, io::between(1e-6, 1e9), "sigma0",
          "of the search, and of the shear before it");
        f("highest_stress", highest_stress, io::between(1e-6, 1e9), "sigma0", "of the search");
        f("ratio", ratio, io::between(1.001, 10), "-",
          "the search ends when jammed and flowing stress differ by this factor");
        f("strain_before", strain_before, io::above_to(0, 1e4), "-",
          "strain of each start at the lowest stress");
        f("strain", strain, io::above_to(0, 1e4), "-", "what flows for this strain does not jam");
        model.describe(f);
        size.describe(f);
    }

    void validate(const io::JsonNode& node, Plan& plan)
    {
        if (const auto list = node.find("volume_fractions")) {
            if (node.has("volume_fraction"))
                throw list->error("volume_fraction and volume_fractions exclude each other");
            for (const io::JsonNode& value : list->elements())
                plan.suspension.check_volume_fraction(value.number(), value);
        }
        if (highest_stress <= lowest_stress)
            throw node.error_at_key("highest_stress",
                                    "must be > lowest_stress, " + io::number_text(lowest_stress));
        Plan own = plan;  // the packings of this step are no state for the next one
        for (double phi : fractions(plan.suspension)) {
            Start one = start;
            one.volume_fraction = phi;
            one.check(node, own);
            if (checked_model(model, node, own).contact_hydrodynamics ==
                ContactHydrodynamics::dashpot)
                throw node.error("needs contact_hydrodynamics \"lubrication\"");
            plan.needs.volume_fraction = std::max(plan.needs.volume_fraction, phi);
        }
        plan.needs.particles = own.particles;
        plan.needs.plotted_pixels = size.pixels();
    }

    /// In ascending order.
    std::vector<double> fractions(const Suspension& suspension) const
    {
        std::vector<double> result = volume_fractions;
        if (result.empty())
            result.push_back(start.volume_fraction.value_or(suspension.packing.volume_fraction));
        std::sort(result.begin(), result.end());
        return result;
    }

    Tried attempt(State& state, const Model& of_all, double stress, double until,
                  const Pulse& pulse) const
    {
        ShearingParameters parameters;
        parameters.stress = stress;
        parameters.series_interval = until;  // no samples are needed
        const Trial trial = try_shear(state, parameters.task(of_all, until, 0, 1), pulse);
        Tried tried{.stress = stress,
                    .outcome = trial.result.outcome,
                    .strain = state.strain,
                    .steps = trial.result.steps};
        if (const auto& window = trial.result.window) {
            tried.viscosity = window->strain_gain > 0 ? window->mean_viscosity : 0;
            tried.force_residual = window->force_residual;
        }
        return tried;
    }

    Found search(const Suspension& suspension, double volume_fraction, int number,
                 const Pulse& pulse) const
    {
        PackingParameters packing = start.packing(suspension);
        packing.volume_fraction = volume_fraction;
        constexpr std::uint32_t stream = 0x4a41;  // of these seeds
        packing.seed = derived_seed(packing.seed, stream, static_cast<std::uint64_t>(number));
        Found found{.volume_fraction = volume_fraction,
                    .seed = packing.seed,
                    .bracket = {},
                    .tried = {},
                    .unjamming = {},
                    .reversal = {}};
        std::optional<State> packing_state = packed(packing, pulse);
        found.is_packed = packing_state.has_value();
        if (!packing_state) return found;
        State& sheared = *packing_state;
        const Model of_all = model.applied_to(suspension.model);
        found.tried.push_back(attempt(sheared, of_all, lowest_stress, strain_before, pulse));
        State jammed;
        double jammed_stress = 0;
        const auto has_jammed = [&](const State& end, double stress) {
            if (found.tried.back().outcome == Outcome::flowing) return false;
            jammed = end;
            jammed_stress = stress;
            return true;
        };
        const auto jams = [&](double stress) {
            if (stress == lowest_stress) return has_jammed(sheared, stress);  // tried before
            State state = sheared;
            found.tried.push_back(attempt(state, of_all, stress, strain, pulse));
            return has_jammed(state, stress);
        };
        found.bracket = bracket_jamming_stress(lowest_stress, highest_stress, ratio, jams);
        found.has_jammed = jammed_stress > 0;
        if (!found.has_jammed) return found;
        State released = jammed, reversed = mirrored(jammed);
        found.unjamming = attempt(released, of_all, lowest_stress, strain_before, pulse);
        found.reversal = attempt(reversed, of_all, jammed_stress, strain, pulse);
        return found;
    }

    std::vector<Found> search_all(Context& context) const
    {
        const std::vector<double> all = fractions(context.suspension);
        std::vector<Found> result(all.size() * static_cast<std::size_t>(starts));
        const Parts parts(context);
        compute_side_by_side(
            context, static_cast<int>(result.size()), [&](int k, const Pulse& pulse) {
                const double volume_fraction = all[static_cast<std::size_t>(k / starts)];
                result[static_cast<std::size_t>(k)] = parts.value(std::to_string(k), [&] {
                    return search(context.suspension, volume_fraction, k % starts, pulse);
                });
            });
        return result;
    }

    void run(Context& context) const
    {
        report_jamming(context, search_all(context),
                       {start.packing(context.suspension).particles, lowest_stress, highest_stress},
                       size);
    }
};

}

StepKind jamming_step()
{
    return step_kind<Jamming>(
        "jamming",
        "stress above which a suspension jams, by bisection, and whether that is undone");
}

}
