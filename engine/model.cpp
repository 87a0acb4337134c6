#include "engine/model.h"

#include "engine/error.h"

namespace sigmaflow {

Stiffness stiffness(const Model& model, const Control& control)
{
    double scale = 1;
    if (model.stiffness_scale == StiffnessScale::stress) {
        const auto* stress = std::get_if<ImposedStress>(&control);
        if (!stress)
            throw Error(ErrorKind::input, "stiffness_scale",
                        "\"stress\" needs an imposed stress; use \"fixed\" under an imposed rate");
        scale = stress->value;
    }
    return {scale * model.normal_stiffness, scale * model.tangential_stiffness,
            scale * model.rolling_stiffness};
}

}
