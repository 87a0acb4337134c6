#include "workflows/step_names.h"

#include <set>

namespace sigmaflow::workflows {

namespace {

bool is_digit(char c)
{
    return c >= '0' && c <= '9';
}

}

bool is_name(const std::string& text)
{
    if (text.empty() || text.size() > longest_name || text[0] == '-') return false;
    for (std::size_t k = 0; k < text.size(); ++k) {
        const char c = text[k];
        // a point in a number: no name is that of a file
        const bool decimal = c == '.' && k > 0 && k + 1 < text.size() && is_digit(text[k - 1]) &&
                             is_digit(text[k + 1]);
        const bool letter = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
        if (!letter && !is_digit(c) && c != '_' && c != '-' && !decimal) return false;
    }
    return true;
}

std::vector<StepText> unfolded(const io::JsonNode& node)
{
    const auto sweep = node.find("sweep");
    if (!sweep) return {{node}};
    const std::vector<std::string> names = sweep->keys();
    if (names.size() != 1)
        throw sweep->error(
            "must have one parameter with a list of values, as {\"stress\": [1, 2]}");
    if (node.has(names.front())) throw node.error_at_key(names.front(), "is in the sweep as well");
    std::vector<StepText> result;
    for (const io::JsonNode& value : sweep->member(names.front()).elements({1, most_steps}))
        result.push_back({node, names.front(), value});
    return result;
}

void name_steps(std::vector<Step>& steps, const std::vector<StepText>& texts,
                io::Problems& problems)
{
    std::set<std::string> used;
    const auto given_name = [&](std::size_t i) {
        const auto given = texts[i].node.is_object() ? texts[i].node.find("name") : std::nullopt;
        return given && given->is_text() ? given : std::nullopt;
    };
    const auto base = [&](std::size_t i) {
        const auto given = given_name(i);
        return given ? given->text() : steps[i].kind;
    };
    const auto name_given = [&](std::size_t i) {
        const auto given = given_name(i);
        const auto& value = texts[i].value;
        if (!given && !value) return;
        if (given && !is_name(base(i))) return;  // refused when the step is read
        steps[i].name = base(i);
        if (value) steps[i].name += "_" + (value->is_number() ? value->shown() : value->text());
        if (!is_name(steps[i].name))
            throw value->wrong(
                "must be a number or a word that can be a part of the name of the step");
        if (!used.insert(steps[i].name).second)
            throw(value ? *value : *given).wrong("must be different for every step");
    };
    for (std::size_t i = 0; i < steps.size(); ++i) problems.collect([&] { name_given(i); });
    for (std::size_t i = 0; i < steps.size(); ++i) {
        if (texts[i].value || given_name(i)) continue;
        const std::string kind = steps[i].kind;
        for (int number = 2; !used.insert(steps[i].name).second; ++number)
            steps[i].name = kind + "_" + std::to_string(number);
    }
}

}
