// sigmaflow report
#include "workflows/commands.h"
#include "workflows/report_page.h"

#include <CLI/CLI.hpp>
#include <memory>

namespace sigmaflow::workflows {

namespace {

struct ReportArguments {
    std::string folder, out;
};

Work declare(CLI::App& app)
{
    const auto given = std::make_shared<ReportArguments>();
    app.add_option("DIR", given->folder, "the folder of the run")->required();
    const CLI::Option* out =
        app.add_option("--out", given->out, "the page, default DIR/report.html");
    return [given, out] {
        if (out->count()) need_text("--out", given->out, "must name a file");
        print_result(write_report_page(given->folder, given->out).string() + "\n");
    };
}

}

Command report_command()
{
    return {
        "report", "one HTML page of a run: complete, interrupted, failed or going on",
        R"(  sigmaflow report out/quickstart                     writes out/quickstart/report.html
  sigmaflow report out/quickstart --out run.html      a page to send; its pictures are inside)",
        declare};
}

}
