// Step "one_dimensional_flow": what a disturbance of uniform flow in a gap does, with the measured
// flow curve, inertia and the memory of the microstructure.
#include "engine/constitution.h"
#include "engine/flow_development.h"
#include "io/atomic_file.h"
#include "workflows/falling_intervals.h"
#include "workflows/gap_flow_report.h"
#include "workflows/pictures.h"
#include "workflows/steps.h"

#include <algorithm>
#include <cmath>

namespace sigmaflow::workflows {

namespace {

using Json = nlohmann::ordered_json;

/// The state that is disturbed.
struct Base {
    double volume_fraction = 0, stress = 0;  // [sigma0]
    SteadyCurve curve;
    MemoryFlow flow = {};
    std::optional<double> critical = {};  // Re_c
};

std::vector<FlowPoint> points_of(const Curve& curve)
{
    std::vector<FlowPoint> points;
    for (const auto& [stress, m] : curve.by_stress) {
        if (!m.jammed && !(m.rate.mean > 0)) break;
        points.push_back(m.point());
        if (m.jammed) break;
    }
    return points;
}

Json root_json(std::complex<double> x)
{
    return {{"growth", x.real()}, {"frequency", std::abs(x.imag())}, {"unit", "shear rate"}};
}

std::string fate_text(const Development& d, double disturbance)
{
    if (d.broke_off) return "broke off, the stresses do not converge";
    const std::string between = "shear rates between " + short_number(d.smallest_rate) + " and " +
                                short_number(d.largest_rate) + " of that of uniform flow";
    if (d.fate == Fate::decays) return "stable, the disturbance decays";
    if (d.fate == Fate::oscillates)
        return "unstable, ends in " +
               std::string(d.frequency > 0 ? "steady oscillations" : "a steady state") + " with " +
               between;
    if (d.expected.real() < 0) return "stable, the disturbance still decays";
    if (d.largest_rate - d.smallest_rate < 100 * disturbance)
        return "unstable, the disturbance is still small";
    return "unstable, irregular or not yet steady, " + between;
}

struct OneDimensionalFlow {
    MemoryParameters memory;
    std::optional<double> volume_fraction, stress, reynolds, strain;
    double reynolds_over_critical = 2, disturbance = 1e-6;
    int cells = 32;
    PictureSize size;
    std::vector<PlannedRun> runs;  // of steps "shear", known when the step is validated

    void describe(io::Fields& f)
    {
        memory.describe(f);
        f("volume_fraction", volume_fraction, io::above_to(0, 0.74), "-",
          "of the flow curve; default: the least stable one");
        f("stress", stress, io::above_to(0, 1e6), "sigma0",
          "of the uniform flow; default: where the rate falls most steeply");
        f("reynolds", reynolds, io::above_to(0, 1e9), "-",
          "rho rate H^2/viscosity; default: from reynolds_over_critical");
        f("reynolds_over_critical", reynolds_over_critical, io::between(1e-3, 1e3), "-",
          "Reynolds number over the critical one");
        f("disturbance", disturbance, io::between(1e-8, 1e-2), "shear rate",
          "amplitude of the first mode in the rate at the start");
        f("strain", strain, io::above_to(0, 1e4), "-",
          "time times the rate of uniform flow; default: growth and ten oscillations; at most 40 "
          "000 steps");
        f("cells", cells, io::Integers{8, 256}, "-", "volumes across the gap");
        size.describe(f);
    }

    void validate(const io::JsonNode& node, Plan& plan)
    {
        memory.validate(node, plan);
        runs = runs_for_curves(node, plan);
        memory.use(plan, runs);
        if (volume_fraction && std::none_of(runs.begin(), runs.end(), [&](const PlannedRun& run) {
                return run.volume_fraction == *volume_fraction &&
                       std::holds_alternative<ImposedStress>(run.control);
            }))
            throw node.member("volume_fraction")
                .wrong("must be one that was sheared at imposed stresses");
        plan.needs.plotted_pixels = size.pixels();
    }

    /// The volume fraction and the stresses between which the rate falls most dangerously.
    std::optional<Interval> least_stable_interval(const Curves& curves) const
    {
        std::vector<Interval> certain, possible;
        for (const Interval& i : intervals_of(curves, memory)) {
            if (volume_fraction && i.volume_fraction != *volume_fraction) continue;
            if (i.onset) possible.push_back(i);
            if (i.is_drawn()) certain.push_back(i);
        }
        const auto& list = certain.empty() ? possible : certain;
        const auto least =
            std::min_element(list.begin(), list.end(), [](const Interval& a, const Interval& b) {
                return a.onset->reynolds.mean < b.onset->reynolds.mean;
            });
        return least == list.end() ? std::nullopt : std::optional(*least);
    }

    /// Nothing, and the reason in the results, if there is no flow to disturb.
    std::optional<Base> base_of(Context& context, const Curves& curves) const
    {
        const std::optional<Interval> interval = least_stable_interval(curves);
        if (!interval && !(stress && reynolds)) {
            context.results["outcome"] =
                "not integrated, the rate falls nowhere: uniform flow is stable at all Reynolds "
                "numbers";
            return std::nullopt;
        }
        Base base;
        base.volume_fraction =
            interval ? interval->volume_fraction : volume_fraction.value_or(curves.rbegin()->first);
        const std::vector<FlowPoint> points = points_of(curves.at(base.volume_fraction));
        if (std::count_if(points.begin(), points.end(),
                          [](const FlowPoint& p) { return !p.jammed; }) < 2) {
            context.results["outcome"] = "not integrated, no two neighbouring stresses flow";
            return std::nullopt;
        }
        base.curve = steady_curve(points);
        base.stress = stress ? *stress : base.curve.steepest_fall(interval->from, interval->to);
        const double rate = base.curve.shear_rate(base.stress);
        if (!(rate > 0)) {
            context.results["outcome"] = "not integrated, jammed at the stress asked for";
            return std::nullopt;
        }
        base.flow = memory.flow({base.stress / rate, 0}, {base.curve.slope(base.stress), 0});
        if (const auto onset = onset_of_instability(base.flow))
            base.critical = onset->reynolds.mean;
        else if (!reynolds) {
            context.results["outcome"] =
                "not integrated, the rate does not fall at this stress: stable at all Reynolds "
                "numbers";
            return std::nullopt;
        }
        return base;
    }

    Constitution constitution_of(const Base& base) const
    {
        const SteadyRate steady = over_base(base.curve, base.stress);
        if (!instantaneous()) return viscous_constitution(steady, base.flow.kernel);
        return contact_constitution(steady, base.flow.kernel,
                                    *instantaneous() / base.flow.viscosity.mean);
    }
    const std::optional<double>& instantaneous() const { return memory.instantaneous_viscosity; }

    render::Plot plot(const Base& base, double reynolds_number) const
    {
        render::Plot result = size.plot();
        result.title = "$ϕ$ = " + short_number(base.volume_fraction) +
                       ", $σ$/$σ$_{0} = " + short_number(base.stress) +
                       ", Re = " + short_number(reynolds_number);
        if (base.critical)
            result.title += " = " + short_number(reynolds_number / *base.critical) + " Re_{c}";
        result.x.title = "strain (time times the rate of uniform flow)";
        return result;
    }

    void write_results(Context& context, const Base& base, const Development& d,
                       const DevelopmentPlan& plan) const
    {
        Json& results = context.results;
        results["volume_fraction"] = base.volume_fraction;
        results["stress"] = base.stress;
        results["memory"] = memory.json();
        results["viscosity"] = base.flow.viscosity.mean;
        results["slope"] = base.flow.slope.mean;
        if (base.critical) results["critical_reynolds"] = *base.critical;
        results["reynolds"] = plan.reynolds;
        results["strain"] = d.moments.back().time;
        results["linear_theory"] = root_json(d.expected);
        if (d.measured) {
            results["integrated"] = root_json(*d.measured);
            const std::complex<double> upper(d.expected.real(), std::abs(d.expected.imag()));
            const double difference = std::abs(*d.measured - upper) / std::abs(upper);
            results["relative_difference"] = difference;
            results["agrees"] = difference < 0.02;
        } else {
            results["integrated"] = "too few values while the disturbance is small";
        }
        results["smallest_rate"] = d.smallest_rate;
        results["largest_rate"] = d.largest_rate;
        if (d.frequency > 0) results["final_frequency"] = d.frequency;
        results["outcome"] = fate_text(d, plan.disturbance);
    }

    void integrate(Context& context) const
    {
        const std::optional<Base> base = base_of(context, curves_of(context, runs));
        if (!base) return;
        const double number = reynolds ? *reynolds : reynolds_over_critical * *base->critical;
        DevelopmentPlan plan = plan_development(base->flow, number, disturbance);
        plan.cells = cells;
        if (strain) plan.time = std::min(*strain, 40000 * plan.step);
        const Development d = develop(constitution_of(*base), base->flow, plan);
        io::write_file(context.folder.file(context.step_name + ".csv"), series_text(d));
        io::write_file(context.folder.file(context.step_name + "_field.csv"), field_text(d));
        write_results(context, *base, d, plan);
        if (d.moments.size() < 3) return;
        write_plot(context, context.step_name, rates_plot(plot(*base, number), d));
        write_plot(context, context.step_name + "_growth",
                   growth_plot(plot(*base, number), d, disturbance));
        write_plot(context, context.step_name + "_profiles", profiles_plot(plot(*base, number), d));
    }

    void run(Context& context) const
    {
        run_with_memory(*this, context, &OneDimensionalFlow::integrate);
    }
};

}

StepKind one_dimensional_flow_step()
{
    return step_kind<OneDimensionalFlow>(
        "one_dimensional_flow",
        "integrates flow in a gap with inertia and memory: does a disturbance grow as the linear "
        "theory says, and where does it end?");
}

}
