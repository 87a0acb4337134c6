// workflows/json_lines.h -- what programs read of this one: with --json, a JSON value per line on
// stdout and nothing else (json_lines.md says which, json_lines.schema.json how they look).
//
// An error is an event, too: {"event": "error", "kind", "exit_code", "where", "problem"}.
#pragma once
#include "engine/error.h"

#include <chrono>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

namespace sigmaflow::workflows {

/// "input", "no_space", ...: the word of ErrorKind.
std::string_view kind_name(ErrorKind kind);

/// One line; bytes that are not UTF-8 are replaced. Errors: file.
void print_json(const nlohmann::ordered_json& value);
nlohmann::ordered_json error_event(const Error& error);

}
