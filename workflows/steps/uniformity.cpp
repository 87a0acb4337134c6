// Step "uniformity": is the flow uniform, and how small a band would have been seen?
#include "engine/slab_profiles.h"
#include "io/atomic_file.h"
#include "workflows/averages.h"
#include "workflows/measured_fields.h"
#include "workflows/pictures.h"
#include "workflows/steps.h"
#include "workflows/uniformity_pictures.h"

#include <algorithm>
#include <cmath>

namespace sigmaflow::workflows {

namespace {

using Json = nlohmann::ordered_json;

/// Words for one field.
std::string verdict_text(const UniformityTest& test)
{
    const auto seen = [](const std::optional<double>& contrast) {
        return "of contrast above " + short_number(*contrast) + " would have been seen";
    };
    switch (test.verdict) {
        case BandVerdict::bands: {
            std::string text = "bands:";
            if (test.has_steady)
                text += " at rest, contrast " + short_number(test.steady.contrast) +
                        ", the high one in " + short_number(test.steady.fraction) + " of the box";
            if (test.has_steady && test.has_moving) text += ";";
            if (test.has_moving)
                text += " moving, mode 1 fluctuates " + short_number(test.moving.excess) +
                        " times as strongly as the others say";
            return text;
        }
        case BandVerdict::uniform:
            return "uniform: bands at rest " + seen(test.smallest_steady) +
                   (test.smallest_moving ? ", moving bands " + seen(test.smallest_moving)
                                         : ", moving bands would not");
        case BandVerdict::undecided:
            break;
    }
    return "undecided: too few frames, " + std::to_string(test.blocks) + " independent of " +
           std::to_string(test.instants);
}

Json contrast_json(const std::optional<double>& contrast)
{
    return contrast ? Json(*contrast) : Json(nullptr);
}

Json test_json(const MeasuredField& field, const UniformityTest& test)
{
    Json json = {{"field", field.name}, {"across", field.axis_name()}};
    json["verdict"] = verdict_name(field.name == "shear_rate" ? test.verdict : test.at_rest);
    json["independent_frames"] = test.blocks;
    if (test.blocks < fewest_blocks) return json;
    const SteadyBands& s = test.steady;
    json["chi2"] = {
        {"value", s.chi2}, {"degrees", 2 * test.modes.size()}, {"p_value", s.chi2_p_value}};
    json["two_bands"] = {{"likelihood_ratio", s.likelihood_ratio},
                         {"p_value", s.p_value},
                         {"contrast", s.contrast},
                         {"fraction", s.fraction},
                         {"place", s.place}};
    json["moving_bands"] = {{"excess", test.moving.excess}, {"p_value", test.moving.p_value}};
    json["order_parameter"] = {{"value", test.order.value},
                               {"confidence_interval", {test.order.lower, test.order.upper}},
                               {"from_noise", test.order.from_noise},
                               {"p_value", test.order.p_value}};
    json["smallest_contrast_seen"] = {{"at_rest", contrast_json(test.smallest_steady)},
                                      {"moving", contrast_json(test.smallest_moving)}};
    return json;
}

std::string modes_csv(const std::vector<MeasuredField>& fields,
                      const std::vector<UniformityTest>& tests)
{
    std::string text =
        "# Fourier modes of the fields over their scales: amplitude of the mean over the frames "
        "and "
        "its error, place of its maximum over the box, mean square of the fluctuations\n"
        "field,across,wave_number,amplitude,standard_error,place,fluctuation,p_value\n";
    for (std::size_t i = 0; i < fields.size(); ++i)
        for (const Mode& mode : tests[i].modes) {
            text += fields[i].name + "," + fields[i].axis_name() + "," +
                    std::to_string(mode.wave_number);
            for (double value :
                 {mode.amplitude, mode.standard_error, mode.phase, mode.fluctuation, mode.p_value})
                text += "," + io::number_text(value);
            text += "\n";
        }
    return text;
}

struct UniformityStep {
    std::string of;
    int bins = 20, seed = 1;
    double spacing = 1, level = 0.05;
    std::optional<double> from_strain;
    PictureSize size;

    void describe(io::Fields& f)
    {
        f("of", of, 64, "name of a step \"shear\"; default: the last one before this step");
        f("bins", bins, io::Integers{12, 200}, "-", "slabs across each direction");
        f("spacing", spacing, io::above_to(0, 1e4), "strain",
          "strain between two frames that are used");
        f("from_strain", from_strain, io::between(0, 1e4), "-",
          "strain of the first frame; default: where the start-up ends");
        f("level", level, io::between(0.005, 0.5), "-",
          "probability of calling uniform flow banded");
        f("seed", seed, io::Integers{0, 1000000000}, "-", "of the random shifts");
        size.describe(f);
    }

    void validate(const io::JsonNode& node, Plan& plan)
    {
        const PlannedRun& run = plan.need_run(node, of, true);
        check_within(run, node, "from_strain", from_strain);
        plan.needs.plotted_pixels = size.pixels();
    }

    std::vector<const Frame*> chosen(const Run& run, const std::vector<Frame>& frames) const
    {
        constexpr double rounding = 1e-9;
        double next = from_strain.value_or(run.start_up.value_or(0)) - rounding;
        std::vector<const Frame*> result;
        for (const Frame& frame : frames) {
            if (frame.state.strain < next) continue;
            result.push_back(&frame);
            next = frame.state.strain + spacing - rounding;
        }
        return result;
    }

    UniformitySettings settings() const
    {
        UniformitySettings s;
        s.level = level;
        s.shifts = std::max(s.shifts, static_cast<int>(std::ceil(20 / level)));
        s.seed = static_cast<std::uint64_t>(seed);
        return s;
    }

    /// The flow itself is judged by the local shear rate; of bands at rest in the other fields the
    /// most certain one is named, with its p-value times their number. The velocity across y is the
    /// local rate once more.
    void judge(Context& context, const std::vector<MeasuredField>& fields,
               const std::vector<UniformityTest>& tests) const
    {
        auto& results = context.results;
        results["fields"] = Json::array();
        double smallest = 1;
        int others = 0;
        std::string other;
        for (std::size_t i = 0; i < fields.size(); ++i) {
            const MeasuredField& field = fields[i];
            if (field.name == "velocity" && field.axis == gradient) continue;
            results["fields"].push_back(test_json(field, tests[i]));
            if (field.name == "shear_rate") {
                results["outcome"] = verdict_text(tests[i]);
                continue;
            }
            if (tests[i].blocks < fewest_blocks) continue;
            ++others;
            const double p = tests[i].steady.p_value;
            if (p >= smallest) continue;
            smallest = p;
            other = field.name + " across " + field.axis_name();
        }
        const double p = std::min(1.0, smallest * others);
        results["other_fields"] =
            others == 0 ? "undecided: too few independent frames"
            : p > level
                ? "no bands at rest seen, p-value of all together " + short_number(p)
                : "bands at rest: " + other + ", p-value of all together " + short_number(p);
    }

    void run(Context& context) const
    {
        const Run& run = context.run(of);
        context.results["of"] = of;
        if (run.jammed) {
            context.results["outcome"] = "undecided: the suspension is jammed";
            return;
        }
        const io::StoredRun stored = io::read_run(run.file);
        const std::vector<const Frame*> frames = chosen(run, stored.frames);
        double rate = 0, stress = 0;
        for (const Frame* frame : frames) {
            rate += frame->sample.shear_rate / static_cast<double>(frames.size());
            stress += frame->sample.shear_stress;
        }
        context.results["frames"] = frames.size();
        if (!(rate * stress > 0)) {  // also without frames
            context.results["outcome"] = frames.empty() ? "undecided: no frame after the start-up"
                                                        : "undecided: nothing flows";
            return;
        }
        context.results["from_strain"] = frames.front()->state.strain;
        context.results["level"] = level;
        const std::vector<MeasuredField> fields = measured_fields(frames, bins, rate);
        std::vector<UniformityTest> tests;
        for (const MeasuredField& field : fields)
            tests.push_back(test_uniformity(field.values, settings()));
        judge(context, fields, tests);

        const auto write = [&](const std::string& suffix, const std::string& text) {
            io::write_file(context.folder.file(context.step_name + suffix + ".csv"), text);
        };
        write("_y", fields_csv(fields, gradient));
        write("_z", fields_csv(fields, vorticity));
        write("_modes", modes_csv(fields, tests));
        const PictureContext pictures{size,
                                      title_text(run.volume_fraction, run.control, run.particles)};
        const auto rate_test =
            static_cast<std::size_t>(find_field(fields, "shear_rate", gradient) - fields.data());
        write_plot(
            context, context.step_name,
            residual_plot(pictures, *find_field(fields, "velocity", gradient), tests[rate_test]));
        write_plot(context, context.step_name + "_y", fields_plot(pictures, fields, gradient));
        write_plot(context, context.step_name + "_z", fields_plot(pictures, fields, vorticity));
        draw_space_time(context, pictures, stored.frames, rate);
    }

    void draw_space_time(Context& context, const PictureContext& pictures,
                         const std::vector<Frame>& frames, double rate) const
    {
        const std::vector<const Frame*> shown = thinned(frames);
        if (shown.size() < 2) return;
        const std::vector<MeasuredField> fields = measured_fields(shown, bins, rate);
        for (const auto& [name, axis] :
             {std::pair{"shear_rate", gradient}, std::pair{"frictional_contact_number", vorticity}})
            if (const MeasuredField* field = find_field(fields, name, axis))
                write_plot(context, context.step_name + "_space_time_" + field->axis_name(),
                           space_time_plot(pictures, shown, *field));
    }
};

}

StepKind uniformity_step()
{
    return step_kind<UniformityStep>(
        "uniformity", "is the flow uniform? tests for bands, and the smallest that would be seen");
}

}
