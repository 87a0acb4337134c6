// sigmaflow validate
#include "workflows/validate.h"

#include "engine/error.h"
#include "workflows/commands.h"

#include <CLI/CLI.hpp>
#include <exception>
#include <iostream>
#include <memory>

namespace sigmaflow::workflows {

namespace {

/// One line for each good file, errors for each bad one; those of the last are thrown.
void validate_files(const std::vector<std::string>& files,
                    const std::vector<io::Override>& overrides)
{
    std::exception_ptr last;
    std::string last_complaint;
    for (const std::string& file : files) {
        try {
            print_result(validate_file(file, overrides) + "\n");
        } catch (const Error& error) {
            if (error.kind() != ErrorKind::input && error.kind() != ErrorKind::missing) throw;
            std::cerr << last_complaint;
            last = std::current_exception();
            last_complaint = complaint(error);
        }
    }
    if (last) std::rethrow_exception(last);
}

Work declare(CLI::App& app)
{
    const auto files = std::make_shared<std::vector<std::string>>();
    app.add_option("FILE", *files, "the files")->required();
    const auto overrides = declare_overrides(app);
    return [files, overrides] { validate_files(*files, overrides()); };
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
