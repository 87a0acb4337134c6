#include "workflows/page_values.h"

#include "workflows/html.h"
#include "workflows/pictures.h"
#include "workflows/report.h"

#include <algorithm>

namespace sigmaflow::workflows {

using Json = nlohmann::ordered_json;
using html::element;
using html::escaped;

namespace {

constexpr std::size_t longest_open_list = 12;  // longer ones are folded

/// What says which thing a result is about is no result.
bool is_verdict(const std::string& key, const Json& value)
{
    return (value.is_string() && key != "step" && key != "of") || value.is_boolean();
}

std::string plain_text(const Json& scalar)
{
    if (scalar.is_string()) return scalar.get<std::string>();
    if (scalar.is_boolean()) return scalar.get<bool>() ? "yes" : "no";
    if (scalar.is_null()) return "–";
    return scalar.is_number_float() ? short_number(scalar.get<double>()) : scalar.dump();
}

std::string number_html(const Json& number, const std::string& shown)
{
    return element("data", shown, "value=\"" + number.dump() + "\"");
}

std::string unit_of(const Json& mean)
{
    const auto unit = mean.find("unit");
    const bool given = unit != mean.end() && unit->is_string() && *unit != "-";
    return given ? unit->get<std::string>() : "";
}

/// Objects of a list as rows; the columns are all their keys.
std::string table_of_objects(const Json& list)
{
    std::vector<std::string> keys, head;
    for (const Json& object : list)
        for (const auto& [key, value] : object.items())
            if (std::find(keys.begin(), keys.end(), key) == keys.end()) keys.push_back(key);
    for (const std::string& key : keys) head.push_back(escaped(in_words(key)));
    std::vector<std::vector<std::string>> rows;
    for (const Json& object : list) {
        std::vector<std::string>& row = rows.emplace_back();
        for (const std::string& key : keys)
            row.push_back(object.contains(key) ? value_html(object[key]) : "");
    }
    return html::table(head, rows);
}

std::string list_html(const Json& list)
{
    const auto are = [&](auto kind) { return std::all_of(list.begin(), list.end(), kind); };
    std::string text;
    if (list.empty()) return "none";
    if (are([](const Json& one) { return one.is_object() && !is_mean(one); })) {
        text = table_of_objects(list);
    } else {
        for (const Json& one : list) text += (text.empty() ? "" : ", ") + value_html(one);
    }
    if (list.size() <= longest_open_list) return text;
    return html::details(std::to_string(list.size()) + " entries", text);
}

std::string object_html(const Json& object)
{
    std::string text;
    for (const auto& [key, value] : object.items())
        text += element("li", escaped(in_words(key)) + ": " + value_html(value));
    return text.empty() ? "none" : element("ul", text);
}

}

std::string in_words(const std::string& key)
{
    std::string words = key;
    std::replace(words.begin(), words.end(), '_', ' ');
    return words;
}

std::string size_text(double bytes)
{
    if (bytes < 1000) return short_number(bytes) + " bytes";
    for (const char* unit : {"kB", "MB"}) {
        bytes /= 1000;
        if (bytes < 999.5) return short_number(std::round(bytes * 10) / 10) + " " + unit;
    }
    return short_number(bytes / 1000) + " GB";
}

std::string mean_html(const Json& entry)
{
    return number_html(entry["mean"], mean_text(entry, " ± "));
}

std::string value_html(const Json& value)
{
    if (is_mean(value)) {
        const std::string unit = unit_of(value);
        return mean_html(value) + (unit.empty() ? "" : " " + escaped(unit));
    }
    if (value.is_number()) return number_html(value, plain_text(value));
    if (value.is_array()) return list_html(value);
    if (value.is_object()) return object_html(value);
    return escaped(plain_text(value));
}

std::string results_html(const Json& results)
{
    std::vector<std::vector<std::string>> means, others;
    for (const auto& [key, value] : results.items()) {
        if (key == "step") continue;
        const std::string name = escaped(in_words(key));
        if (value.is_object() && !is_mean(value)) {
            for (const auto& [inner, entry] : value.items())
                others.push_back({name + ": " + escaped(in_words(inner)), value_html(entry)});
        } else if (is_mean(value)) {
            means.push_back({name, mean_html(value), escaped(unit_of(value))});
        } else {
            others.push_back({name, value_html(value)});
        }
    }
    std::string text;
    if (!means.empty()) text += html::table({"mean of", "± standard error", "unit"}, means);
    if (!others.empty()) text += html::table({}, others);
    return text;
}

Verdicts verdicts_of(const Json& results)
{
    Verdicts verdicts;
    for (const auto& [key, value] : results.items()) {
        if (is_verdict(key, value)) verdicts.emplace_back(in_words(key), plain_text(value));
        if (!value.is_array()) continue;
        for (const Json& object : value) {
            if (!object.is_object()) break;
            std::string about;  // its first number, as the volume fraction of a curve
            for (const auto& [inner, word] : object.items()) {
                if (about.empty() && word.is_number())
                    about = in_words(inner) + " " + plain_text(word) + ": ";
                if (is_verdict(inner, word))
                    verdicts.emplace_back(about + in_words(inner), plain_text(word));
            }
        }
    }
    return verdicts;
}

}
