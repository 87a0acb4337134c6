// sigmaflow validate
#include "workflows/validate.h"

#include "engine/error.h"
#include "workflows/commands.h"
#include "workflows/json_lines.h"

#include <CLI/CLI.hpp>
#include <exception>
#include <iostream>
#include <memory>
#include <optional>

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

nlohmann::ordered_json places_of(const Error& error)
{
    const auto place = [](const Error& one) {
        return nlohmann::ordered_json{{"where", one.where()}, {"problem", one.problem()}};
    };
    nlohmann::ordered_json list = nlohmann::ordered_json::array();
    if (const auto* several = dynamic_cast<const Errors*>(&error))
        for (const Error& one : several->list()) list.push_back(place(one));
    else
        list.push_back(place(error));
    return list;
}

/// One event for each file, with all errors.
void validate_as_json(const std::vector<std::string>& files,
                      const std::vector<io::Override>& overrides)
{
    std::optional<Error> last;
    for (const std::string& file : files) {
        nlohmann::ordered_json event = {{"event", "validate"}, {"file", file}, {"valid", true}};
        try {
            event["text"] = validate_file(file, overrides);
        } catch (const Error& error) {
            if (error.kind() != ErrorKind::input && error.kind() != ErrorKind::missing) throw;
            event["valid"] = false;
            event["text"] = error.what();
            event["errors"] = places_of(error);
            last = error;
        }
        print_json(event);
    }
    if (last) throw Verdict(last->kind(), last->where(), "not valid");
}

struct ValidateArguments {
    std::vector<std::string> files;
    bool json = false;
};

Work declare(CLI::App& app)
{
    const auto given = std::make_shared<ValidateArguments>();
    app.add_option("FILE", given->files, "the files")->required();
    const auto overrides = declare_overrides(app);
    describe_json(app, given->json);
    return [given, overrides] {
        given->json ? validate_as_json(given->files, overrides())
                    : validate_files(given->files, overrides());
    };
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
