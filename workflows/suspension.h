// workflows/suspension.h -- the suspension that a workflow works on, named once.
#pragma once
#include "engine/model.h"
#include "engine/packing.h"
#include "io/json_fields.h"

#include <string>

namespace sigmaflow::workflows {

/// "comment": what people want to say of an object, JSON has no comments. Not kept.
io::Field comment_field();

struct Suspension {
    PackingParameters packing;
    Model model;
    double largest_volume_fraction = 0;  // random close packing of these spheres, set by check()

    void describe(io::Fields& f);
    /// Combinations that exclude each other. Errors: input, with the position in `object`.
    void check(const io::JsonNode& object);
    /// Error(input) at `value` if the spheres have no random packing at a volume fraction.
    void check_volume_fraction(double volume_fraction, const io::JsonNode& value) const;
};

}
