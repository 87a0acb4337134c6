// workflows/output.h -- what goes to stdout: results and nothing else.
#pragma once
#include <string_view>

namespace sigmaflow::workflows {

/// Error(file) if that fails: a full disk or a closed pipe must not pass for success.
void print_result(std::string_view text);

}
