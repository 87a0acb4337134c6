// io/json_schema.h -- the JSON Schema (draft 2020-12) of declared parameters.
//
// It refuses what read_fields refuses: unknown keys, missing required ones, wrong types, words and
// numbers out of range. Lengths of texts are counted in characters there and in bytes here, and
// what several values mean together, no schema says.
#pragma once
#include "io/json_fields.h"

#include <nlohmann/json.hpp>

namespace sigmaflow::io {

/// Of one value: type, limits, default, and as description the unit and the meaning.
nlohmann::ordered_json schema_of(const Field& field);

/// Of an object with these fields and no others.
nlohmann::ordered_json schema_of(const std::vector<Field>& fields);

}
