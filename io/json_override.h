// io/json_override.h -- values that replace those of a JSON file, as from the command line.
#pragma once
#include <string>

namespace sigmaflow::io {

/// "/steps/1/stress=3": a value of the file by its JSON pointer (RFC 6901). The parent must exist;
/// a new member is added to an object, an element of an array must be there.
struct Override {
    std::string option;   // as errors name it: --set
    std::string pointer;  // "/steps/1/stress"
    std::string value;    // JSON; what is no JSON stands for a text: heun
};

/// Errors: usage (no "=", no pointer).
Override parse_override(const std::string& option, const std::string& text);

struct JsonTree;

/// Errors: input (the pointer leads nowhere), at the option.
void apply_override(JsonTree& tree, const Override& given);

}
