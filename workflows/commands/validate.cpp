// sigmaflow validate
#include "workflows/validate.h"

#include "engine/error.h"
#include "workflows/commands.h"
#include "workflows/json_lines.h"

#include <CLI/CLI.hpp>
#include <iostream>
#include <memory>
#include <optional>

namespace sigmaflow::workflows {

namespace {

/// One line for each good file, an error for each bad one; the last error is thrown.
void validate_files(const std::vector<std::string>& files)
{
    std::optional<Error> last;
    for (const std::string& file : files) {
        try {
            print_result(validate_file(file) + "\n");
        } catch (const Error& error) {
            if (error.kind() != ErrorKind::input && error.kind() != ErrorKind::missing) throw;
            if (last) std::cerr << complaint(*last);
            last = error;
        }
    }
    if (last) throw *last;
}

/// One event for each file.
void validate_as_json(const std::vector<std::string>& files)
{
    std::optional<Error> last;
    for (const std::string& file : files) {
        nlohmann::ordered_json event = {{"event", "validate"}, {"file", file}, {"valid", true}};
        try {
            event["text"] = validate_file(file);
        } catch (const Error& error) {
            if (error.kind() != ErrorKind::input && error.kind() != ErrorKind::missing) throw;
            event["valid"] = false;
            event["text"] = error.what();
            last = error;
        }
        print_json(event);
    }
    if (last) throw Verdict(last->kind(), last->where(), last->problem());
}

struct ValidateArguments {
    std::vector<std::string> files;
    bool json = false;
};

Work declare(CLI::App& app)
{
    const auto given = std::make_shared<ValidateArguments>();
    app.add_option("FILE", given->files, "the files")->required();
    describe_json(app, given->json);
    return [given] { given->json ? validate_as_json(given->files) : validate_files(given->files); };
}

}

Command validate_command()
{
    return {
        "validate", "check workflows, cases, runs (.h5) and VTK files, compute nothing",
        R"(  sigmaflow validate my_flow.json                     all that is wrong with it, at once
  sigmaflow validate *.json out/a/shear/run.h5        what files are, or what is wrong)",
        declare};
}

}
