#include "workflows/json_lines.h"

#include "workflows/output.h"

namespace sigmaflow::workflows {

using Json = nlohmann::ordered_json;

std::string_view kind_name(ErrorKind kind)
{
    switch (kind) {
        case ErrorKind::different:
            return "different";
        case ErrorKind::interrupted:
            return "interrupted";
        case ErrorKind::usage:
            return "usage";
        case ErrorKind::input:
            return "input";
        case ErrorKind::missing:
            return "missing";
        case ErrorKind::rendering:
            return "rendering";
        case ErrorKind::numerics:
            return "numerics";
        case ErrorKind::internal:
            return "internal";
        case ErrorKind::file:
            return "file";
        case ErrorKind::no_space:
            return "no_space";
        case ErrorKind::locked:
            return "locked";
    }
    return "internal";
}

void print_json(const Json& value)
{
    print_result(value.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n");
}

Json error_event(const Error& error)
{
    return {{"event", "error"},
            {"kind", kind_name(error.kind())},
            {"exit_code", static_cast<int>(error.kind())},
            {"where", error.where()},
            {"problem", error.problem()}};
}

}
