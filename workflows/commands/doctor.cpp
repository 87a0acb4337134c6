// sigmaflow doctor
#include "workflows/doctor.h"
#include "workflows/commands.h"
#include "workflows/json_lines.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <memory>

namespace sigmaflow::workflows {

namespace {

struct DoctorArguments {
    std::string folder = ".";
    bool json = false;
};

std::string as_text(const std::vector<Finding>& findings)
{
    std::string text;
    for (const Finding& finding : findings) {
        std::string level(level_name(finding.level)), name = finding.name;
        level.resize(6, ' ');
        name.resize(11, ' ');
        text += level + name + finding.text + "\n";
        if (!finding.mend.empty()) text += std::string(17, ' ') + "mend: " + finding.mend + "\n";
    }
    return text;
}

nlohmann::ordered_json as_json(const std::vector<Finding>& findings, bool healthy)
{
    nlohmann::ordered_json checks = nlohmann::ordered_json::array();
    for (const Finding& finding : findings)
        checks.push_back({{"name", finding.name},
                          {"level", level_name(finding.level)},
                          {"text", finding.text},
                          {"mend", finding.mend}});
    return {{"event", "doctor"}, {"healthy", healthy}, {"checks", checks}};
}

Work declare(CLI::App& app)
{
    const auto given = std::make_shared<DoctorArguments>();
    app.add_option("DIR", given->folder, "where results are to be written")->default_val(".");
    describe_json(app, given->json);
    return [given] {
        const std::vector<Finding> findings = examine(given->folder);
        const auto failed = std::find_if(findings.begin(), findings.end(), [](const Finding& f) {
            return f.level == Finding::Level::fail;
        });
        if (given->json)
            print_json(as_json(findings, failed == findings.end()));
        else
            print_result(as_text(findings));
        if (failed != findings.end())
            throw Verdict(failed->kind, failed->name, failed->text + "; mend: " + failed->mend);
    };
}

}

Command doctor_command()
{
    return {"doctor", "does this machine have what runs need? what is missing, and the mend",
            R"(  sigmaflow doctor                                    results in the current folder
  sigmaflow doctor /scratch/me                        results there)",
            declare};
}

}
