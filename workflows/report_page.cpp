#include "workflows/report_page.h"

#include "io/atomic_file.h"
#include "workflows/html.h"
#include "workflows/page_overview.h"
#include "workflows/page_values.h"
#include "workflows/report.h"
#include "workflows/run_folder.h"

#include <algorithm>
#include <map>
#include <span>

namespace sigmaflow::workflows {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;
using html::element;
using html::escaped;
using Row = std::vector<std::string>;

namespace {

constexpr std::size_t largest_picture = std::size_t{256} << 20;  // bytes

/// The run, and the way from the page to its folder.
struct Source {
    const PastRun& run;
    std::string to_folder;

    std::string link(const std::string& name, const std::string& content) const
    {
        return element("a", content, "href=\"" + html::link(to_folder + name) + "\"");
    }
};

std::string picture_html(const Source& source, const PastFile& file, bool svg)
{
    const fs::path path = source.run.folder / file.name;
    const std::string bytes = io::read_file(path, largest_picture);
    if (!bytes.starts_with(svg ? "<" : "\x89PNG\r\n\x1a\n"))
        throw Error(ErrorKind::input, path.string(),
                    std::string("is no ") + (svg ? "SVG" : "PNG") + " picture");
    const std::string name = escaped(file.name);
    const std::string image = "<img alt=\"" + name + "\" src=\"data:image/" +
                              (svg ? "svg+xml" : "png") + ";base64," + html::base64(bytes) + "\"/>";
    return element("figure", source.link(file.name, image) + element("figcaption", name)) + "\n";
}

/// Plots as SVG, what has none as PNG.
std::string pictures_html(const Source& source, const PastStep& step)
{
    std::vector<std::string> drawn;  // names without ending
    std::string text;
    for (const char* ending : {".svg", ".png"})
        for (const PastFile& file : step.files_ending(ending)) {
            const std::string stem = file.name.substr(0, file.name.size() - 4);
            if (!file.exists || std::find(drawn.begin(), drawn.end(), stem) != drawn.end())
                continue;
            drawn.push_back(stem);
            text += picture_html(source, file, ending == std::string(".svg"));
        }
    return text;
}

/// Folders below that of a step, as vtk/, are one entry.
std::string files_html(const Source& source, const std::vector<PastFile>& files)
{
    struct Content {
        int files = 0;
        double size = 0;
    };
    std::map<std::string, Content> folders;
    std::string text;
    for (const PastFile& file : files) {
        const std::string parent = fs::path(file.name).parent_path().string();
        if (parent.find('/') == std::string::npos) {
            const std::string size = file.exists ? ", " + size_text(file.size) : ": is missing now";
            text += element("li", source.link(file.name, escaped(file.name)) + size);
            continue;
        }
        ++folders[parent].files;
        folders[parent].size += file.size;
    }
    for (const auto& [folder, content] : folders)
        text +=
            element("li", source.link(folder + "/", escaped(folder + "/")) + ", " +
                              std::to_string(content.files) + " files, " + size_text(content.size));
    return text.empty() ? "" : html::details("files", element("ul", text));
}

std::string content_html(const Source& source, const PastStep& step)
{
    if (!step.wall_seconds) return element("p", "not finished", "class=\"note\"") + "\n";
    Json parameters = step.parameters;
    parameters.erase("step");
    parameters.erase("name");
    return pictures_html(source, step) + results_html(step.results) +
           html::details("parameters", value_html(parameters)) + files_html(source, step.files);
}

std::string heading(const std::string& title, const std::string& note)
{
    return element("h3", title + " " + element("span", escaped(note), "class=\"kind\"")) + "\n";
}

std::string alone_html(const Source& source, std::size_t k)
{
    const PastStep& step = source.run.steps[k];
    const std::string time = step.wall_seconds ? ", " + seconds_text(*step.wall_seconds) : "";
    return element("section",
                   heading(escaped(step.name), step.kind + time) + content_html(source, step),
                   "id=\"" + step_id(k) + "\"") +
           "\n";
}

/// Name, parameter, the usual means and the outcome of every run.
std::string table_of_runs(const PastRun& run, const Chapter& chapter)
{
    Row head{"step", escaped(in_words(chapter.parameter))};
    std::vector<Row> rows;
    const auto steps = std::span(run.steps).subspan(chapter.first, chapter.count);
    for (std::size_t k = 0; k < steps.size(); ++k)
        rows.push_back(
            {link_to_step(run, chapter.first + k), parameter_html(steps[k], chapter.parameter)});
    for (const char* key : {"shear_stress", "shear_rate", "viscosity", "contact_number"}) {
        const auto has = [&](const PastStep& step) {
            return step.results.contains(key) && is_mean(step.results[key]);
        };
        const auto one = std::find_if(steps.begin(), steps.end(), has);
        // what is imposed needs no second column
        if (one == steps.end() || "shear_" + chapter.parameter == key) continue;
        const std::string unit = text_at(one->results[key], "unit");
        head.push_back(
            escaped(in_words(key) + (unit.empty() || unit == "-" ? "" : " [" + unit + "]")));
        for (std::size_t k = 0; k < steps.size(); ++k)
            rows[k].push_back(has(steps[k]) ? mean_html(steps[k].results[key]) : "–");
    }
    head.push_back("outcome");
    for (std::size_t k = 0; k < steps.size(); ++k)
        rows[k].push_back(steps[k].wall_seconds ? escaped(text_at(steps[k].results, "outcome"))
                                                : "not finished");
    return html::table(head, rows);
}

/// One table of all runs, each with its numbers folded below.
std::string together_html(const Source& source, const Chapter& chapter)
{
    const PastRun& run = source.run;
    std::string folded;
    for (std::size_t k = chapter.first; k < chapter.first + chapter.count; ++k)
        folded += html::details(escaped(run.steps[k].name), content_html(source, run.steps[k]),
                                "id=\"" + step_id(k) + "\"");
    const std::string note = run.steps[chapter.first].kind + ", " + std::to_string(chapter.count) +
                             " runs, " + seconds_text(seconds_of(run, chapter));
    return element("section", heading(chapter_name(run, chapter), note) +
                                  table_of_runs(run, chapter) + folded) +
           "\n";
}

/// Everything that went in.
std::string origin_html(const Source& source)
{
    std::vector<Row> rows;
    for (const auto& [key, value] : source.run.manifest.items())
        if (key != "workflow" && key != "steps" && key != "files" && key != "error")
            rows.push_back({escaped(in_words(key)), value_html(value)});
    std::string links;
    for (const char* name : {manifest_name, summary_name})
        links += element("li", source.link(name, name));
    return element("h2", "How it was made") + "\n" + html::table({}, rows) + element("ul", links) +
           "\n" + files_html(source, source.run.files) +
           html::details("the workflow with all defaults",
                         element("pre", escaped(source.run.manifest["workflow"].dump(2))));
}

/// The page must not take the place of what the run has found.
void refuse_results(const PastRun& run, const fs::path& out)
{
    const auto refuse_if = [&](const std::string& name) {
        std::error_code ignored;
        if (fs::equivalent(run.folder / name, out, ignored))
            throw Error(ErrorKind::usage, "--out", out.string() + " is a result of the run");
    };
    for (const char* name : {manifest_name, summary_name}) refuse_if(name);
    for (const PastFile& file : run.files) refuse_if(file.name);
    for (const PastStep& step : run.steps)
        for (const PastFile& file : step.files) refuse_if(file.name);
}

/// The way from the page to the folder, empty or ending with /.
std::string way_to_folder(const fs::path& folder, const fs::path& page)
{
    std::error_code error;
    const fs::path from = fs::weakly_canonical(fs::absolute(page).parent_path(), error);
    const fs::path way = fs::relative(folder, from, error);
    if (error || way.empty()) return fs::absolute(folder).string() + "/";
    return way == "." ? "" : way.string() + "/";
}

}

std::string report_page(const PastRun& run, const std::string& to_folder)
{
    const Source source{run, to_folder};
    const std::vector<Chapter> parts = chapters(run);
    std::string body = element("h1", escaped(run.title())) + "\n";
    if (const std::string words = run.description(); !words.empty())
        body += element("p", escaped(words)) + "\n";
    body += overview_html(run, parts) + element("h2", "Steps") + "\n";
    for (const Chapter& part : parts)
        body +=
            part.parameter.empty() ? alone_html(source, part.first) : together_html(source, part);
    return html::page(escaped(run.title()), body + origin_html(source));
}

fs::path write_report_page(const fs::path& folder, const fs::path& out)
{
    const PastRun run = read_past_run(folder);
    const fs::path path = out.empty() ? folder / "report.html" : out;
    refuse_results(run, path);
    io::write_file(path, report_page(run, way_to_folder(folder, path)));
    return path;
}

}
