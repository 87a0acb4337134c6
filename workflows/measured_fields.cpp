#include "workflows/measured_fields.h"

#include "engine/slab_profiles.h"
#include "engine/statistics.h"
#include "io/atomic_file.h"

#include <numeric>

namespace sigmaflow::workflows {

namespace {

double mean_value(const std::vector<double>& values)
{
    return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

/// Divided by its mean over everything.
void add_relative(std::vector<MeasuredField>& fields, MeasuredField field)
{
    field.scale = mean_value(mean_over_instants(field.values));
    if (!(field.scale > 0)) return;
    for (auto& instant : field.values)
        for (double& value : instant) value /= field.scale;
    fields.push_back(std::move(field));
}

/// About its mean, which is a drift of everything, and divided by the velocity across the box.
Field relative_velocities(const std::vector<SlabProfiles>& profiles, double scale)
{
    Field result;
    for (const SlabProfiles& p : profiles) {
        const double mean = mean_value(p.nonaffine_velocity);
        std::vector<double> values = p.nonaffine_velocity;
        for (double& value : values) value = (value - mean) / scale;
        result.push_back(std::move(values));
    }
    return result;
}

void add_fields(std::vector<MeasuredField>& fields, const std::vector<const Frame*>& frames,
                Axis axis, int slabs, double mean_rate)
{
    std::vector<SlabProfiles> profiles;
    for (const Frame* frame : frames) profiles.push_back(slab_profiles(*frame, axis, slabs));
    const double height = frames[0]->state.box.length.y(), jump = mean_rate * height;
    const std::vector<double>& position = profiles[0].position;
    const bool across_gradient = axis == gradient;
    fields.push_back({"velocity", across_gradient ? "$u$ − $y$" : "$u$", axis, jump, position,
                      relative_velocities(profiles, jump)});
    if (across_gradient) {
        MeasuredField rate{"shear_rate", "local shear rate", axis, mean_rate, {}, {}};
        for (std::size_t k = 1; k <= position.size(); ++k)
            rate.position.push_back(static_cast<double>(k) / static_cast<double>(position.size()));
        for (const SlabProfiles& p : profiles)
            rate.values.push_back(local_shear_rate(p.nonaffine_velocity, mean_rate, height));
        fields.push_back(std::move(rate));
    }
    const auto add = [&](const char* name, const char* symbol,
                         std::vector<double> SlabProfiles::*values) {
        MeasuredField field{name, symbol, axis, 1, position, {}};
        for (const SlabProfiles& p : profiles) field.values.push_back(p.*values);
        add_relative(fields, std::move(field));
    };
    add("volume_fraction", "volume fraction", &SlabProfiles::volume_fraction);
    add("shear_stress", "shear stress", &SlabProfiles::shear_stress);
    add("frictional_contact_number", "frictional contacts",
        &SlabProfiles::frictional_contact_number);
}

}

std::vector<MeasuredField> measured_fields(const std::vector<const Frame*>& frames, int slabs,
                                           double mean_rate)
{
    std::vector<MeasuredField> fields;
    for (const Axis axis : {gradient, vorticity})
        add_fields(fields, frames, axis, slabs, mean_rate);
    return fields;
}

const MeasuredField* find_field(const std::vector<MeasuredField>& fields, const std::string& name,
                                Axis axis)
{
    for (const MeasuredField& field : fields)
        if (field.name == name && field.axis == axis) return &field;
    return nullptr;
}

FieldMean mean_of(const MeasuredField& field)
{
    FieldMean result;
    std::vector<double> values(field.values.size());
    for (std::size_t k = 0; k < field.position.size(); ++k) {
        for (std::size_t t = 0; t < values.size(); ++t) values[t] = field.values[t][k];
        const Estimate estimate = estimate_mean(values);
        result.mean.push_back(estimate.mean);
        if (values.size() > 1) result.standard_error.push_back(estimate.standard_error);
    }
    return result;
}

std::string fields_csv(const std::vector<MeasuredField>& fields, Axis axis)
{
    const std::string name = axis == gradient ? "y" : "z";
    std::string text =
        "# means over the instants in slabs; " + name + ": over the length of the box; velocity: " +
        (axis == gradient ? "U_x/(shear_rate L_y) - y/L_y; shear_rate: between the centres of this "
                            "slab and the next one, "
                          : "U_x/(shear_rate L_y); ") +
        "all others over their means\n" + name;
    std::vector<FieldMean> columns;
    const std::vector<double>* position = nullptr;
    for (const MeasuredField& field : fields) {
        if (field.axis != axis) continue;
        text += "," + field.name + "," + field.name + "_error";
        columns.push_back(mean_of(field));
        if (!position) position = &field.position;
    }
    text += "\n";
    for (std::size_t k = 0; position && k < position->size(); ++k) {
        text += io::number_text((*position)[k]);
        for (const FieldMean& column : columns) {
            text += "," + io::number_text(column.mean[k]) + ",";
            if (!column.standard_error.empty()) text += io::number_text(column.standard_error[k]);
        }
        text += "\n";
    }
    return text;
}

}
