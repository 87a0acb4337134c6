// sigmaflow compare
#include "workflows/commands.h"
#include "workflows/json_lines.h"
#include "workflows/run_comparison.h"

#include <CLI/CLI.hpp>
#include <memory>

namespace sigmaflow::workflows {

namespace {

struct CompareArguments {
    std::string a, b;
    double tolerance = 0;
    bool json = false;
};

/// "shear_rate of shear from strain 0.37 on".
std::string first_difference(const RunComparison& comparison)
{
    for (const SeriesComparison& series : comparison.series)
        if (!series.quantities.empty())
            return series.quantities.front().name + " of " + series.name + " from strain " +
                   nlohmann::json(series.quantities.front().strain).dump() + " on";
    for (const SeriesComparison& series : comparison.series)
        if (!series.equal()) return series.name + " ends at another strain";
    return comparison.results.empty() ? "" : comparison.results.front().place;
}

Work declare(CLI::App& app)
{
    const auto given = std::make_shared<CompareArguments>();
    app.add_option("A", given->a, "a folder of a run, series.csv, run.h5 or summary.json")
        ->required();
    app.add_option("B", given->b, "the other one")->required();
    app.add_option("--tolerance", given->tolerance,
                   "largest relative difference of two equal numbers; 0: the same bits")
        ->check(CLI::Range(0., 1.))
        ->default_val(0);
    describe_json(app, given->json);
    return [given] {
        const RunComparison comparison = compare_runs(given->a, given->b, given->tolerance);
        if (given->json)
            print_json(comparison_json(comparison));
        else
            print_result(comparison_text(comparison));
        if (!comparison.equal())
            throw Verdict(ErrorKind::different, given->a + " and " + given->b,
                          "differ: " + first_difference(comparison));
    };
}

}

Command compare_command()
{
    return {
        "compare", "which quantity of two runs differs, from which strain on and by how much",
        R"(  sigmaflow compare out/a out/b                       exit code 0: equal, 1: different
  sigmaflow compare out/a out/b --tolerance 1e-6      equal if numbers agree to a millionth
  sigmaflow compare a/shear/run.h5 b/shear/series.csv)",
        declare};
}

}
