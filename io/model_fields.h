// io/model_fields.h -- the parameters of engine/model.h in workflow and case files.
#pragma once
#include "engine/model.h"
#include "io/json_fields.h"

#include <nlohmann/json.hpp>
#include <optional>

namespace sigmaflow::io {

/// One line per parameter of the model: name, limits, unit, meaning.
void describe(Fields& fields, Model& model);

/// Reads the object `model`; parameters that are not given keep their default. Also checks that
/// friction_dynamic <= friction_static.
Model read_model(const JsonNode& object);
void check_model(const Model& model, const JsonNode& object);

/// Some parameters of a model with other values.
struct ModelChanges {
    Model values;                  // that are replaced, the others without meaning
    nlohmann::ordered_json given;  // null: none

    /// One line, "model".
    void describe(Fields& fields);
    Model applied_to(const Model& model) const;
};

/// Reads {"stress": x} or {"rate": x}, any finite number. Checks that the model allows it: the
/// stiffness scale `stress` needs an imposed stress > 0.
Control read_control(const JsonNode& object, const Model& model);

/// The control that two optional fields stand for; exactly one must be given in `object`.
Control checked_control(const std::optional<double>& stress, const std::optional<double>& rate,
                        const Model& model, const JsonNode& object);

}
