#include "tests/support/json_compare.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

namespace sigmaflow::support {

using nlohmann::json;

namespace {

double number(const json& value)
{
    if (value.is_boolean()) return value.get<bool>();
    return value.is_number() ? value.get<double>() : std::numeric_limits<double>::quiet_NaN();
}

double largest(const json& value)
{
    if (!value.is_structured()) return std::abs(number(value));
    double most = 0;
    for (const json& item : value) most = std::max(most, largest(item));
    return most;
}

// One number of the same name in every row of a table becomes one array.
json transposed(const json& rows)
{
    json columns = json::object();
    for (const auto& [key, ignored] : rows.front().items())
        for (const json& row : rows) columns[key].push_back(row.at(key));
    return columns;
}

void worse(Deviation& worst, const Deviation& other)
{
    if (!(other.value <= worst.value)) worst = other;
}

double difference(const json& stored, const json& computed)
{
    if (!stored.is_structured()) return std::abs(number(stored) - number(computed));
    if (stored.size() != computed.size()) return std::numeric_limits<double>::infinity();
    double most = 0;
    for (std::size_t k = 0; k < stored.size(); ++k) {
        const double d = difference(stored[k], computed[k]);
        if (!(d <= most)) most = d;
    }
    return most;
}

Deviation compare(const json& stored, const json& computed, double scale, const std::string& where)
{
    if (stored.is_array() && !stored.empty() && stored.front().is_object()) {
        if (stored.size() != computed.size())
            return {std::numeric_limits<double>::infinity(), where + " (length)"};
        return compare(transposed(stored), transposed(computed), scale, where);
    }
    if (stored.is_object()) {
        Deviation worst{0, where};
        for (const auto& [key, value] : stored.items()) {
            if (!computed.contains(key))
                return {std::numeric_limits<double>::infinity(), where + "/" + key + " (missing)"};
            const bool shared = key == "stress" || key == "power" || key == "force_on_i";
            worse(worst, compare(value, computed.at(key), shared ? largest(value) : scale,
                                 where + "/" + key));
        }
        return worst;
    }
    const double size = scale > 0 ? scale : largest(stored);
    return {difference(stored, computed) / std::max(size, 1e-12), where};
}

}

Deviation deviation(const json& stored, const json& computed)
{
    return compare(stored, computed, 0, "");
}

}
