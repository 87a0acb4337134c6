// sigmaflow verify
#include "workflows/commands.h"
#include "workflows/json_lines.h"
#include "workflows/verification.h"

#include <CLI/CLI.hpp>
#include <memory>

namespace sigmaflow::workflows {

namespace {

struct VerifyArguments {
    std::string folder;
    bool json = false;
};

nlohmann::ordered_json as_json(const std::string& folder, const Verification& found)
{
    nlohmann::ordered_json faults = nlohmann::ordered_json::array();
    for (const Fault& fault : found.faults)
        faults.push_back({{"file", fault.file}, {"problem", fault.problem}});
    return {{"event", "verify"},       {"folder", folder},          {"status", found.status},
            {"whole", faults.empty()}, {"files", found.files},      {"bytes", found.bytes},
            {"faults", faults},        {"unlisted", found.unlisted}};
}

std::string as_text(const std::string& folder, const Verification& found)
{
    std::string text;
    for (const Fault& fault : found.faults) text += fault.file + ": " + fault.problem + "\n";
    for (const std::string& file : found.unlisted) text += file + ": is not listed, not checked\n";
    return text + folder + ": " + std::to_string(found.files) + " files, " +
           std::to_string(found.bytes) + " bytes" +
           (found.faults.empty() ? ", all as they were written" : "") + "; the run is " +
           found.status + "\n";
}

Work declare(CLI::App& app)
{
    const auto given = std::make_shared<VerifyArguments>();
    app.add_option("DIR", given->folder, "the folder of a run")->required();
    describe_json(app, given->json);
    return [given] {
        const Verification found = verify_folder(given->folder);
        if (given->json)
            print_json(as_json(given->folder, found));
        else
            print_result(as_text(given->folder, found));
        if (!found.faults.empty())
            throw Verdict(ErrorKind::input, given->folder,
                          std::to_string(found.faults.size()) + " of " +
                              std::to_string(found.files) +
                              " files are not what the run has written; sigmaflow run makes them "
                              "again");
    };
}

}

Command verify_command()
{
    return {
        "verify", "compare every file of a run with its checksum",
        R"(  sigmaflow verify out/quickstart                     changed, missing and unlisted files
  sigmaflow verify out/quickstart --json              the same as one JSON object)",
        declare};
}

}
