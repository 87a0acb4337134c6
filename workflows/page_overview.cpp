#include "workflows/page_overview.h"

#include "workflows/html.h"
#include "workflows/page_values.h"
#include "workflows/pictures.h"
#include "workflows/progress.h"

#include <algorithm>
#include <cmath>

namespace sigmaflow::workflows {

using Json = nlohmann::ordered_json;
using html::element;
using html::escaped;

namespace {

std::string status_html(const PastRun& run)
{
    const std::string status = text_at(run.manifest, "status");
    const auto finished =
        std::count_if(run.steps.begin(), run.steps.end(),
                      [](const PastStep& step) { return step.wall_seconds.has_value(); });
    std::string text = element("strong", escaped(status)) + ": " + std::to_string(finished) +
                       " of " + std::to_string(run.steps.size()) + " steps are finished";
    if (status == "interrupted") text += "; the same command goes on";
    if (status == "running") text += "; it was still running, or was ended from outside";
    if (const std::string error = text_at(run.manifest, "error"); !error.empty())
        text += "<br/>" + escaped(error);
    std::string kind = "status";
    if (status == "complete" || status == "failed") kind += " " + status;
    return element("p", text, "class=\"" + kind + "\"") + "\n";
}

/// A word and the steps that say it, by their value of the parameter.
struct Said {
    std::string word, values;
};

/// What the steps of a chapter say on one thing.
struct Verdict {
    std::string key;
    std::vector<Said> said;

    void add(const std::string& word, const std::string& value)
    {
        auto same = std::find_if(said.begin(), said.end(),
                                 [&](const Said& one) { return one.word == word; });
        if (same == said.end())
            said.push_back({word, value});
        else
            same->values += ", " + value;
    }
};

std::vector<Verdict> verdicts_of_chapter(const PastRun& run, const Chapter& chapter)
{
    std::vector<Verdict> result;
    for (std::size_t k = chapter.first; k < chapter.first + chapter.count; ++k)
        for (const auto& one : verdicts_of(run.steps[k].results)) {
            const auto same_key = [&](const Verdict& verdict) { return verdict.key == one.first; };
            auto verdict = std::find_if(result.begin(), result.end(), same_key);
            if (verdict == result.end()) verdict = result.insert(verdict, {one.first, {}});
            verdict->add(one.second, parameter_html(run.steps[k], chapter.parameter));
        }
    return result;
}

/// One word if all say the same, otherwise which says what.
std::string verdict_html(const Verdict& verdict, const std::string& parameter)
{
    std::string words;
    for (const Said& said : verdict.said) {
        if (!words.empty()) words += "; ";
        words += element("strong", escaped(said.word));
        if (verdict.said.size() > 1 && !parameter.empty())
            words += " (" + escaped(in_words(parameter)) + " " + said.values + ")";
    }
    return element("li", escaped(verdict.key) + ": " + words);
}

std::string verdicts_html(const PastRun& run, const std::vector<Chapter>& chapters)
{
    std::vector<std::vector<std::string>> rows;
    for (const Chapter& chapter : chapters) {
        std::string words;
        for (const Verdict& verdict : verdicts_of_chapter(run, chapter))
            words += verdict_html(verdict, chapter.parameter);
        if (!words.empty()) rows.push_back({chapter_name(run, chapter), element("ul", words)});
    }
    if (rows.empty()) return "";
    return element("h2", "Verdicts") + "\n" + html::table({"step", "says"}, rows);
}

std::string times_html(const PastRun& run, const std::vector<Chapter>& chapters)
{
    double all = 0;
    for (const Chapter& chapter : chapters) all += seconds_of(run, chapter);
    std::vector<std::vector<std::string>> rows;
    for (const Chapter& chapter : chapters) {
        const double own = seconds_of(run, chapter), share = all > 0 ? 100 * own / all : 0;
        const std::string percent = short_number(std::round(10 * share) / 10) + "%";
        rows.push_back(
            {chapter_name(run, chapter), seconds_text(own), percent,
             element("div", "",
                     "class=\"bar\" style=\"width: " + short_number(0.1 * share) + "rem\"")});
    }
    return element("h2", "Where the time went") + "\n" +
           element("p", seconds_text(all) + " in the finished steps; threads: " +
                            escaped(text_at(run.manifest, "threads")) +
                            ", host: " + escaped(text_at(run.manifest, "host"))) +
           "\n" + html::table({"step", "time", "share", ""}, rows);
}

}

std::string overview_html(const PastRun& run, const std::vector<Chapter>& chapters)
{
    return status_html(run) + verdicts_html(run, chapters) + times_html(run, chapters);
}

std::string step_id(std::size_t step)
{
    return "step" + std::to_string(step + 1);
}

std::string link_to_step(const PastRun& run, std::size_t step)
{
    return element("a", escaped(run.steps[step].name), "href=\"#" + step_id(step) + "\"");
}

std::string chapter_name(const PastRun& run, const Chapter& chapter)
{
    const std::string first = link_to_step(run, chapter.first);
    if (chapter.count == 1) return first;
    return first + " … " + link_to_step(run, chapter.first + chapter.count - 1);
}

double seconds_of(const PastRun& run, const Chapter& chapter)
{
    double sum = 0;
    for (std::size_t k = chapter.first; k < chapter.first + chapter.count; ++k)
        sum += run.steps[k].wall_seconds.value_or(0);
    return sum;
}

std::string seconds_text(double seconds)
{
    return seconds < 60 ? short_number(std::round(seconds * 100) / 100) + " s"
                        : duration_text(seconds);
}

std::string parameter_html(const PastStep& step, const std::string& parameter)
{
    const auto it = step.parameters.find(parameter);
    return it == step.parameters.end() ? "–" : value_html(*it);
}

std::string text_at(const Json& object, const std::string& key)
{
    const auto it = object.find(key);
    if (it == object.end() || it->is_null()) return "";
    return it->is_string() ? it->get<std::string>() : it->dump();
}

}
