// Step "step_stress": what follows a step in the imposed stress, as a mean over many starts (Mari
// et al., Phys. Rev. E 91, 052302, 2015, Fig. 5).
//
// Each start packs with a seed of its own, shears at the stress before, and then at the stress
// after. Starts are parts: they are computed side by side, and an interrupted step goes on with
// those that are missing.
#include "engine/random.h"
#include "io/atomic_file.h"
#include "workflows/parts.h"
#include "workflows/response_report.h"
#include "workflows/shearing.h"
#include "workflows/start.h"
#include "workflows/steps.h"

#include <algorithm>

namespace sigmaflow::workflows {

namespace {

enum class StiffnessRule { rescaled, kept };

struct StepStress {
    Start start;
    double stress_before = 2, stress_after = 3;
    double strain_before = 2, strain_after = 0.2;
    int starts = 100;
    double series_interval = 5e-4;
    Scheme scheme = Scheme::implicit;
    std::optional<double> displacement;
    StiffnessRule stiffness = StiffnessRule::rescaled;
    io::ModelChanges model;
    PictureSize size{1440, 720};

    static constexpr double interval_before = 0.01;

    void describe(io::Fields& f)
    {
        start.describe(f);
        f("starts", starts, io::Integers{2, 100'000}, "-",
          "independent packings, with seeds made from that of the suspension");
        f("stress_before", stress_before, io::between(1e-6, 1e9), "sigma0", "imposed at first");
        f("stress_after", stress_after, io::between(1e-6, 1e9), "sigma0", "imposed then");
        f("strain_before", strain_before, io::above_to(0.1, 1e4), "-",
          "strain of each start before the step in stress");
        f("strain_after", strain_after, io::above_to(0, 1e3), "-", "strain after it");
        f("series_interval", series_interval, io::between(1e-6, 1), "strain",
          "strain between two samples after the step");
        describe_scheme(f, scheme);
        f("displacement", displacement, io::above_to(0, 0.1), "a",
          "nothing moves by more than this in one step after the step in stress; default: 0.005, "
          "heun and euler 0.001");
        f("stiffness", stiffness,
          io::Words<StiffnessRule>{{"rescaled", StiffnessRule::rescaled},
                                   {"kept", StiffnessRule::kept}},
          "the springs of contacts follow the stress at once, or stay those of stress_before "
          "(models with stiffness_scale \"stress\")");
        model.describe(f);
        size.describe(f);
    }

    void validate(const io::JsonNode& node, Plan& plan)
    {
        Plan own = plan;  // the packings of this step are no state for the next one
        start.check(node, own);
        if (stress_before == stress_after)
            throw node.error_at_key("stress_after", "must differ from stress_before");
        if (strain_after / series_interval > 1e5 || strain_after / series_interval < 10)
            throw node.error_at_key(
                "series_interval",
                "must give 10 to 1e5 samples in the strain " + io::number_text(strain_after));
        const Model changed = checked_model(model, node, own);
        if (changed.stiffness_scale == StiffnessScale::fixed && node.has("stiffness"))
            throw node.error_at_key("stiffness",
                                    "the model's stiffness_scale \"fixed\" leaves no choice");
        check_scheme(scheme, changed, node);
        plan.needs.particles = own.particles;
        plan.needs.volume_fraction = own.volume_fraction;
        plan.needs.samples =
            starts * (strain_after / series_interval + strain_before / interval_before);
        plan.needs.plotted_pixels = size.pixels();
        plan.endings = response_pictures();
        plan.responses.push_back(plan.step_name);
    }

    ShearingTask task(const Model& of_all, double stress, double strain, double interval,
                      std::optional<double> longest) const
    {
        ShearingParameters parameters;
        parameters.stress = stress;
        parameters.scheme = scheme;
        parameters.displacement = longest;
        parameters.series_interval = interval;
        return parameters.task(of_all, strain, 0, 1);
    }

    Model model_after(const Model& before) const
    {
        Model result = before;
        if (stiffness == StiffnessRule::rescaled || before.stiffness_scale == StiffnessScale::fixed)
            return result;
        const Stiffness kept = sigmaflow::stiffness(before, ImposedStress{stress_before});
        result.stiffness_scale = StiffnessScale::fixed;
        result.normal_stiffness = kept.normal;
        result.tangential_stiffness = kept.tangential;
        result.rolling_stiffness = kept.rolling;
        return result;
    }

    Response respond(const Suspension& suspension, int number, const Pulse& pulse) const
    {
        PackingParameters packing = start.packing(suspension);
        constexpr std::uint32_t stream = 0x5354;  // of these seeds
        packing.seed = derived_seed(packing.seed, stream, static_cast<std::uint64_t>(number));
        const Model of_step = model.applied_to(suspension.model);
        Response response{.seed = packing.seed, .before = {}, .after = {}};
        std::optional<State> state = packed(packing, pulse);
        response.packed = state.has_value();
        if (!state) return response;
        Trial before = try_shear(
            *state, task(of_step, stress_before, strain_before, interval_before, {}), pulse);
        response.before = std::move(before.series);
        response.jammed = before.result.outcome != Outcome::flowing;
        if (response.jammed) return response;
        Trial after =
            try_shear(*state,
                      task(model_after(of_step), stress_after, strain_after, series_interval,
                           displacement.value_or(scheme == Scheme::implicit ? 5e-3 : 1e-3)),
                      pulse);
        response.after = std::move(after.series);
        response.jammed = after.result.outcome != Outcome::flowing;
        return response;
    }

    std::vector<Response> respond_all(Context& context) const
    {
        std::vector<Response> result(static_cast<std::size_t>(starts));
        const Parts parts(context);
        compute_side_by_side(context, starts, [&](int k, const Pulse& pulse) {
            result[static_cast<std::size_t>(k)] = parts.value(
                std::to_string(k), [&] { return respond(context.suspension, k, pulse); });
        });
        return result;
    }

    void run(Context& context) const
    {
        std::vector<Response> responses = respond_all(context);
        std::string table = "seed,outcome\n";
        for (const Response& r : responses)
            table += std::to_string(r.seed) + "," + std::string(response_outcome(r)) + "\n";
        io::write_file(context.folder.file(context.step_name + "_starts.csv"), table);
        std::erase_if(responses, [](const Response& r) { return !r.packed || r.jammed; });
        context.results["starts"] = starts;
        context.results["without_flow"] = starts - static_cast<int>(responses.size());
        report_response(context, {stress_before, stress_after, strain_before}, responses, size);
    }
};

}

StepKind step_stress_step()
{
    return step_kind<StepStress>("step_stress",
                                 "mean response of many starts to a step in the imposed stress");
}

}
