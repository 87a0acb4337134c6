// workflows/wyart_cates_fits.h -- the fits of step "wyart_cates" as a table and in words.
#pragma once
#include "engine/wyart_cates_uncertainty.h"

#include <optional>
#include <string>
#include <vector>

namespace sigmaflow::workflows {

/// One variant of the model fitted to one range of the data.
struct Row {
    FitRange range;
    WyartCatesVariant variant;
    WyartCatesFit fit;
    std::vector<WyartCates> drawn = {};
    std::array<std::optional<Interval>, wyart_cates_parameters.size()> profile =
        {};  // of the widest range

    template <class Quantity>
    std::vector<double> drawn_values(const Quantity& quantity) const
    {
        std::vector<double> values;
        for (const WyartCates& m : drawn)
            if (const std::optional<double> value = quantity(m)) values.push_back(*value);
        return values;
    }
    std::vector<double> drawn_values(WyartCatesParameter p) const
    {
        return drawn_values([p](const WyartCates& m) { return std::optional(value_of(m, p)); });
    }
};

std::optional<double> critical_fraction(const WyartCates& model);

/// One line for each row.
std::string csv_text(const std::vector<Row>& rows, double confidence);

/// "exponent 2, free sharpness"
std::string words(const WyartCatesVariant& variant);

/// What a reader of the numbers should know, in sentences. `best` is the row with the lowest Akaike
/// number of the widest range, `points` what it was fitted to.
std::vector<std::string> verdict(const std::vector<Row>& rows, const Row& best,
                                 const std::vector<WyartCatesPoint>& points, double confidence);

}
