// sigmaflow validate
#include "workflows/validate.h"

#include "engine/error.h"
#include "workflows/commands.h"

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

Work declare(CLI::App& app)
{
    const auto files = std::make_shared<std::vector<std::string>>();
    app.add_option("FILE", *files, "the files")->required();
    return [files] { validate_files(*files); };
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
