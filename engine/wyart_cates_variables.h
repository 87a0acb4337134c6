// engine/wyart_cates_variables.h -- the parameters of wyart_cates.h in variables that may take any
// real value; only the fit uses them.
//
// A logistic function squeezes each variable into the limits of its parameter (the logarithm of
// positive ones). phi_0 comes before phi_mu, whose lower limit depends on it: the lowest value with
// phi_J > phi at every flowing point. So phi < phi_J holds for all variables.
#pragma once
#include "engine/types.h"
#include "engine/wyart_cates_data.h"

#include <vector>

namespace sigmaflow {

class WyartCatesVariables {
public:
    WyartCatesVariables(std::span<const WyartCatesPoint> points, const WyartCatesVariant& variant);

    int size() const { return 4 + !variant_.exponent + !variant_.sharpness; }
    const Limits& limit(WyartCatesParameter p) const { return limits_[static_cast<unsigned>(p)]; }

    WyartCates model(const Eigen::VectorXd& x) const;
    /// The inverse; a model on its limits, or beyond, is moved just inside.
    Eigen::VectorXd variables_of(const WyartCates& model) const;

    /// A model with the held parameters.
    WyartCates held() const;
    /// The lowest phi_mu that keeps phi < phi_J, for phi_0, onset and sharpness of `model` [-].
    double lowest_frictional_fraction(const WyartCates& model) const;

private:
    struct Flowing {
        double stress, volume_fraction;  // the highest at this stress
    };
    std::vector<Flowing> densest_;
    WyartCatesVariant variant_;
    std::array<Limits, wyart_cates_parameters.size()> limits_;
};

}
