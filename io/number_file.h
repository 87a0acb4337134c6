// io/number_file.h -- a list of numbers as text, one a line.
//
// Blank lines and what follows a # are passed over; a point is the decimal mark in every locale.
// Errors: missing (cannot be read), input "<file>:<line>: must be >= 0.01 and <= 100 [a], got -1"
// (not a number, out of range, more than one in a line; too few or too many of them).
#pragma once
#include "io/json_document.h"

#include <filesystem>
#include <string_view>
#include <vector>

namespace sigmaflow::io {

std::vector<double> read_numbers(const std::filesystem::path& path, Length length, Range range,
                                 std::string_view unit);

}
