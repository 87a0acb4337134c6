#include "io/run_parameters.h"

#include "io/model_fields.h"

#include <nlohmann/json.hpp>

#include <optional>

namespace sigmaflow::io {
namespace {

/// A numeric or text attribute as the JSON value it was made from.
nlohmann::ordered_json stored_value(const Hdf5Group& group, const Field& field)
{
    if (field.kind == FieldKind::boolean) return read_number(group, field.name) != 0;
    if (field.kind == FieldKind::number) return read_number(group, field.name);
    return read_text(group, field.name);
}

void describe_control(Fields& fields, std::optional<double>& stress, std::optional<double>& rate)
{
    fields("stress", stress, any_number(), "sigma0", "imposed shear stress");
    fields("rate", rate, any_number(), "rate0", "imposed shear rate");
}

}

void write_parameters(const Hdf5Group& file, const RunParameters& parameters)
{
    Model model = parameters.model;
    std::optional<double> stress, rate;
    if (const auto* imposed = std::get_if<ImposedStress>(&parameters.control))
        stress = imposed->value;
    if (const auto* imposed = std::get_if<ImposedRate>(&parameters.control)) rate = imposed->value;
    Fields fields;
    describe(fields, model);
    describe_control(fields, stress, rate);

    const Hdf5Group group = file.create_group("parameters"), units = group.create_group("unit");
    for (const Field& field : fields.list()) {
        const nlohmann::ordered_json value = field.write();
        if (value.is_null()) continue;  // the control that was not imposed
        if (value.is_boolean())
            write_number(group, field.name, static_cast<std::uint8_t>(value.get<bool>()));
        else if (value.is_number())
            write_number(group, field.name, value.get<double>());
        else
            write_text(group, field.name, value.get<std::string>());
        if (!field.unit.empty()) write_text(units, field.name, field.unit);
    }
}

RunParameters read_parameters(const Hdf5Group& file)
{
    const Hdf5Group group = file.open_group("parameters");
    RunParameters result;
    std::optional<double> stress, rate;
    Fields fields;
    describe(fields, result.model);
    describe_control(fields, stress, rate);

    // Checked in the same way as a workflow file: unknown names, missing ones, limits.
    nlohmann::ordered_json stored;
    for (const std::string& name : attribute_names(group)) stored[name] = nullptr;
    for (const Field& field : fields.list()) {
        const bool control = field.name == "stress" || field.name == "rate";
        if (!control || stored.contains(field.name))
            stored[field.name] = stored_value(group, field);
    }
    const JsonDocument document = JsonDocument::parse(stored.dump(), group.where());
    read_fields(document.root(), fields.list());
    result.control = checked_control(stress, rate, result.model, document.root());
    return result;
}

}
