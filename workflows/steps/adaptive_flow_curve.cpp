// Step "adaptive_flow_curve": a flow curve to a tolerance. The program chooses the stresses, and
// how long to shear at each (engine/adaptive_curve.h).
//
// Every point is a run of its own, from a packing of its own, so that errors are independent and
// points are computed side by side, in rounds: first equal intervals, then what is needed most.
// Each stretch of a run is a part (workflows/parts.h).
#include "engine/adaptive_curve.h"
#include "engine/random.h"
#include "workflows/averages.h"
#include "workflows/curve_report.h"
#include "workflows/parts.h"
#include "workflows/shearing.h"
#include "workflows/start.h"
#include "workflows/steps.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace sigmaflow::workflows {

namespace {

/// A stretch of a run, and where it ended.
struct Stretch {
    Outcome outcome = Outcome::undecided;
    State end;
    std::vector<Sample> series;
};

template <class Archive>
void archive(Archive& a, Stretch& s)
{
    a(s.outcome, s.end, s.series);
}

/// A stress with all that was sheared there.
struct Point {
    double stress = 0;
    int stretches = 0;
    double strain = 0;
    bool jammed = false;
    State end;
    std::vector<Sample> series;

    /// The samples of the next stretch go on where the ones before ended.
    void add(Stretch&& next)
    {
        const double before = strain, time = series.empty() ? 0 : series.back().time;
        for (Sample& sample : next.series) {
            if (stretches > 0 && sample.strain == 0) continue;  // known already
            sample.strain += before;
            sample.time += time;
            series.push_back(sample);
        }
        strain += next.end.strain;
        jammed = next.outcome != Outcome::flowing;
        end = std::move(next.end);
        ++stretches;
    }
};

struct AdaptiveFlowCurve {
    Start start;
    double lowest_stress = 0.3, highest_stress = 30;
    int points = 6;
    CurveGoal goal;
    double strain = 3, maximum_strain = 30, confidence = 0.95;
    io::ModelChanges model;
    PictureSize size;

    static constexpr double series_interval = 0.01;

    void describe(io::Fields& f)
    {
        start.describe(f);
        f("lowest_stress", lowest_stress, io::between(1e-6, 1e9), "sigma0", "of the curve");
        f("highest_stress", highest_stress, io::between(1e-6, 1e9), "sigma0", "of the curve");
        f("points", points, io::Integers{2, 1000}, "-", "at equal ratios, to begin with");
        f("most_points", goal.most_points, io::Integers{2, 1000}, "-", "in the end");
        f("tolerance", goal.tolerance, io::between(1e-4, 1), "-",
          "relative standard error of each rate, and of the rate between the points");
        f("closest", goal.closest, io::between(1.001, 10), "-",
          "neighbouring stresses differ by this factor at least");
        f("strain", strain, io::between(0.1, 1e4), "-",
          "of each run; doubled until its error is within the tolerance");
        f("maximum_strain", maximum_strain, io::between(0.1, 1e5), "-", "of each run at most");
        f("confidence", confidence, io::between(0.5, 0.9999), "-",
          "of all statements on the curve together");
        model.describe(f);
        size.describe(f);
    }

    void validate(const io::JsonNode& node, Plan& plan)
    {
        Plan own = plan;  // the packings of this step are no state for the next one
        start.check(node, own);
        if (highest_stress <= lowest_stress)
            throw node.error_at_key("highest_stress",
                                    "must be > lowest_stress, " + io::number_text(lowest_stress));
        if (goal.most_points < points)
            throw node.error_at_key("most_points", "must be >= points, " + std::to_string(points));
        if (maximum_strain < strain)
            throw node.error_at_key("maximum_strain",
                                    "must be >= strain, " + io::number_text(strain));
        if (checked_model(model, node, own).contact_hydrodynamics == ContactHydrodynamics::dashpot)
            throw node.error("needs contact_hydrodynamics \"lubrication\"");
        plan.needs.particles = own.particles;
        plan.needs.volume_fraction = own.volume_fraction;
        plan.needs.samples = goal.most_points * maximum_strain / series_interval;
        plan.needs.plotted_pixels = 2 * size.pixels();
        plan.endings = {"", "_viscosity"};
    }

    Stretch shear_on(const Suspension& suspension, const Point& point, double until,
                     const Pulse& pulse) const
    {
        Stretch stretch{.end = point.end, .series = {}};
        if (point.stretches == 0) {
            PackingParameters packing = start.packing(suspension);
            // a stress has the same packing whenever it is asked for
            const auto number = std::bit_cast<std::uint64_t>(point.stress);
            constexpr std::uint32_t stream = 0x4146;  // of these seeds
            packing.seed = derived_seed(packing.seed, stream, number);
            stretch.end = random_packing(packing, [&](int, double) { pulse(); });
        }
        ShearingParameters parameters;
        parameters.stress = point.stress;
        parameters.series_interval = series_interval;
        Trial trial = try_shear(
            stretch.end, parameters.task(model.applied_to(suspension.model), until, 0, 1), pulse);
        stretch.outcome = trial.result.outcome;
        stretch.series = std::move(trial.series);
        return stretch;
    }

    /// One stretch more for each of these points: the first one, or as long as all before.
    void shear_round(Context& context, const Parts& parts, std::vector<Point*>& round) const
    {
        compute_side_by_side(
            context, static_cast<int>(round.size()), [&](int k, const Pulse& pulse) {
                Point& point = *round[static_cast<std::size_t>(k)];
                const double until = point.stretches == 0
                                         ? strain
                                         : std::min(point.strain, maximum_strain - point.strain);
                const std::string name =
                    io::number_text(point.stress) + "_" + std::to_string(point.stretches);
                point.add(parts.value(
                    name, [&] { return shear_on(context.suspension, point, until, pulse); }));
            });
    }

    Run run_of(const Point& point, const Suspension& suspension) const
    {
        const PackingParameters packing = start.packing(suspension);
        Run run{.name = io::number_text(point.stress),
                .control = ImposedStress{point.stress},
                .volume_fraction = packing.volume_fraction,
                .particles = packing.particles,
                .file = {},
                .series = point.series,
                .start_up = {},
                .jammed = point.jammed,
                .continues = {}};
        if (!run.jammed) find_start_up(run);
        return run;
    }

    Curve curve_of(const std::vector<Point>& all, const Suspension& suspension) const
    {
        Curve curve;
        for (const Point& point : all)
            curve.by_stress[point.stress] = measured(run_of(point, suspension));
        return curve;
    }

    /// The points to be sheared next; new ones are added. Those that may not become longer are left
    /// as they are.
    std::vector<Point*> next_round(std::vector<Point>& all, const Curve& curve) const
    {
        std::vector<FlowPoint> known;
        for (const auto& [stress, m] : curve.by_stress) known.push_back(m.point());
        const CurveTasks tasks = next_curve_tasks(known, goal);
        for (double stress : tasks.insert)
            all.push_back({.stress = stress, .end = {}, .series = {}});
        std::vector<Point*> round;
        for (Point& point : all) {
            const bool wanted = std::find(tasks.lengthen.begin(), tasks.lengthen.end(),
                                          point.stress) != tasks.lengthen.end();
            const bool allowed = maximum_strain - point.strain > 0.5 * strain;
            if (point.stretches == 0 || (wanted && allowed)) round.push_back(&point);
        }
        return round;
    }

    void run(Context& context) const
    {
        const Parts parts(context);
        std::vector<Point> all;
        for (int k = 0; k < points; ++k)
            all.push_back({.stress = lowest_stress *
                                     std::pow(highest_stress / lowest_stress, k / (points - 1.)),
                           .end = {},
                           .series = {}});
        std::vector<Point*> round;
        for (Point& point : all) round.push_back(&point);
        int rounds = 0;
        Curve curve;
        for (; !round.empty(); ++rounds) {
            shear_round(context, parts, round);
            curve = curve_of(all, context.suspension);
            round = next_round(all, curve);
        }
        double total = 0, largest_error = 0;
        for (const Point& point : all) total += point.strain;
        for (const auto& [stress, m] : curve.by_stress)
            if (!m.jammed && m.rate.mean > 0)
                largest_error = std::max(largest_error, m.rate.standard_error / m.rate.mean);
        context.results["points"] = all.size();
        context.results["rounds"] = rounds;
        context.results["strain_of_all"] = total;
        context.results["largest_relative_error"] = largest_error;
        context.results["tolerance_met"] = largest_error <= goal.tolerance;
        report_curves(context, {{start.packing(context.suspension).volume_fraction, curve}},
                      confidence, size);
    }
};

}

StepKind adaptive_flow_curve_step()
{
    return step_kind<AdaptiveFlowCurve>(
        "adaptive_flow_curve",
        "flow curve to a tolerance: the program chooses stresses and lengths of runs");
}

}
