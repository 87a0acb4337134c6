#include "io/model_fields.h"

namespace sigmaflow::io {

void describe(Fields& f, Model& m)
{
    // clang-format off
    f("lubrication_delta", m.lubrication_delta, between(1e-9, 1), "-",
      "regularisation delta of the reduced gap xi: the resistance grows as 1/(xi + delta)");
    f("lubrication_range", m.lubrication_range, above_to(0, 10), "xi",
      "pairs with a reduced gap below it resist each other's motion");
    f("contact_hydrodynamics", m.contact_hydrodynamics,
      Words<ContactHydrodynamics>{{"lubrication", ContactHydrodynamics::lubrication},
                                  {"dashpot", ContactHydrodynamics::dashpot}},
      "touching pairs keep their full lubrication block, or only a dashpot");
    f("contact_relaxation_time", m.contact_relaxation_time, between(0, 1e9), "1/rate0",
      "tau: touching pairs resist with 4 kn tau; 0: with 1/delta");
    f("normal_stiffness", m.normal_stiffness, between(0, 1e9), "F*/a", "spring constant kn of a contact");
    f("tangential_stiffness", m.tangential_stiffness, between(0, 1e9), "F*/a",
      "tangential spring constant kt of a contact");
    f("stiffness_scale", m.stiffness_scale,
      Words<StiffnessScale>{{"stress", StiffnessScale::stress}, {"fixed", StiffnessScale::fixed}},
      "stress: spring constants times sigma/sigma0 (needs an imposed stress); fixed: as given");
    f("friction_static", m.friction_static, between(0, 1e6), "-",
      "friction coefficient of sticking contacts; 0: frictionless");
    f("friction_dynamic", m.friction_dynamic, between(0, 1e6), "-",
      "friction coefficient of sliding contacts, at most friction_static");
    f("critical_load", m.critical_load, between(0, 1e9), "F*",
      "friction acts on the part of the normal force above this load");
    f("rolling_stiffness", m.rolling_stiffness, between(0, 1e9), "F*/a", "spring constant of rolling");
    f("rolling_friction", m.rolling_friction, between(0, 1e6), "-", "friction coefficient of rolling");
    f("repulsion", m.repulsion, between(0, 1e9), "F*", "strength of the repulsion; 0: none");
    f("debye_length", m.debye_length, between(1e-6, 1e3), "a", "decay length of the repulsion");
    f("repulsion_amplitude", m.repulsion_amplitude,
      Words<RepulsionAmplitude>{{"reduced_radius", RepulsionAmplitude::reduced_radius},
                                {"derjaguin", RepulsionAmplitude::derjaguin},
                                {"constant", RepulsionAmplitude::constant}},
      "factor a_i a_j/(a_i + a_j), twice that, or 1");
    f("repulsion_range", m.repulsion_range, above_to(0, 10), "xi",
      "pairs with a reduced gap below it repel each other");
    f("einstein", m.einstein, "solvent stress with the factor 1 + 5/2 phi");
    f("drag_factor", m.drag_factor, between(1e-6, 1e6), "-", "multiplies the Stokes drag of every particle");
    f("background_drag", m.background_drag,
      "drag relative to the ambient flow; false: the limit of vanishing drag");
    // clang-format on
}

Model read_model(const JsonNode& object)
{
    Model model;
    Fields fields;
    describe(fields, model);
    read_fields(object, fields.list());
    check_model(model, object);
    return model;
}

void check_model(const Model& model, const JsonNode& object)
{
    if (model.friction_dynamic > model.friction_static)
        throw object.error_at_key(
            object.has("friction_dynamic") ? "friction_dynamic" : "friction_static",
            "friction_dynamic must be <= friction_static, got " +
                number_text(model.friction_dynamic) + " and " + number_text(model.friction_static));
}

void ModelChanges::describe(Fields& fields)
{
    fields.changes(
        "model", "parameters of the suspension's model that this step replaces",
        [this](Fields& inner) { io::describe(inner, values); }, given);
}

Model ModelChanges::applied_to(const Model& model) const
{
    Model result = model;
    if (given.is_null()) return result;
    Fields fields;
    io::describe(fields, result);
    const JsonDocument document = JsonDocument::parse(given.dump(), "model");
    read_fields(document.root(), fields.list());
    return result;
}

Control checked_control(const std::optional<double>& stress, const std::optional<double>& rate,
                        const Model& model, const JsonNode& object)
{
    if (stress && rate)
        throw object.error_at_key("rate", "stress and rate exclude each other, give one of them");
    if (!stress && !rate) throw object.error("needs either stress [sigma0] or rate [rate0]");
    const bool scaled = model.stiffness_scale == StiffnessScale::stress;
    if (rate && scaled)
        throw object.error_at_key("rate",
                                  "the model's stiffness_scale \"stress\" needs an imposed stress; "
                                  "set it to \"fixed\" to impose a rate");
    if (rate) return ImposedRate{*rate};
    if (scaled && *stress <= 0)
        throw object.error_at_key("stress",
                                  "must be > 0 [sigma0] with stiffness_scale \"stress\", "
                                  "got " +
                                      number_text(*stress));
    return ImposedStress{*stress};
}

Control read_control(const JsonNode& object, const Model& model)
{
    std::optional<double> stress, rate;
    Fields f;
    f("stress", stress, between(-1e9, 1e9), "sigma0", "imposed shear stress");
    f("rate", rate, between(-1e9, 1e9), "rate0", "imposed shear rate");
    read_fields(object, f.list());
    return checked_control(stress, rate, model, object);
}

}
