// io/run_schema.h -- what the writer and the reader of run.h5 must agree on (schema: io/README.md).
#pragma once
#include "engine/model.h"
#include "io/json_fields.h"

#include <optional>

namespace sigmaflow::io {

inline constexpr int run_schema_version = 1;

/// The parameters of /parameters: those of the model, and `stress` or `rate`.
struct RunParameters {
    Model model;
    std::optional<double> stress, rate;

    void describe(Fields& fields);
};

}
