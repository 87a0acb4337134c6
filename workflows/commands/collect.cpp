// sigmaflow collect
#include "workflows/collect.h"

#include "workflows/commands.h"
#include "workflows/slurm.h"

#include <CLI/CLI.hpp>
#include <memory>

namespace sigmaflow::workflows {

namespace {

struct CollectArguments {
    std::string folder, quantity;
};

Work declare(CLI::App& app)
{
    const auto given = std::make_shared<CollectArguments>();
    app.add_option("DIR", given->folder, "the folder of the sweep")->required();
    app.add_option("--y", given->quantity,
                   "column of the table that is drawn, default the viscosity of the last run");
    return [given] {
        const SweepFolder sweep = read_sweep(given->folder);
        std::vector<PointStatus> status = read_status(sweep);
        add_slurm_states(sweep, status);
        print_result(collect_sweep(sweep, status, given->quantity));
    };
}

}

Command collect_command()
{
    return {
        "collect", "table and figure of a sweep, also while it goes on",
        R"(  sigmaflow collect out/flow_sweep                    writes table.csv and a figure there
  sigmaflow collect out/flow_sweep --y shear.contact_number)",
        declare};
}

}
