// The page of a run: read back by an XML parser and compared with the folder that it tells of.
#include "workflows/report_page.h"

#include "engine/error.h"
#include "render/image.h"
#include "tests/support/xml_tree.h"
#include "tests/workflows/program.h"
#include "workflows/html.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <set>

namespace sigmaflow::workflows {

namespace {

using Json = nlohmann::ordered_json;
using test::read_xml;
using test::XmlElement;
using test::XmlTree;
namespace fs = std::filesystem;

constexpr const char* hostile = "</title><script>alert(\"1\")</script>'&amp;]]>\x01 γ̇";
// XML cannot hold the control character
constexpr const char* hostile_shown = "</title><script>alert(\"1\")</script>'&amp;]]>\uFFFD γ̇";

Json mean(double value, const Json& error, const char* unit)
{
    return {{"mean", value}, {"standard_error", error}, {"unit", unit}};
}

Json shear_step(const std::string& name, double stress)
{
    return {{"step", "shear"}, {"name", name}, {"stress", stress}, {"strain", 2}};
}

Json flowing(double rate)
{
    return {{"step", "shear"},
            {"control", {{"stress", 2}}},
            {"outcome", "flowing"},
            {"time", 123.456789012345},
            {"errors_reliable", true},
            {"viscosity", mean(2 / rate, 0.1 / rate, "eta0")},
            {"shear_rate", mean(rate, rate / 20, "rate0")},
            {"contact_number", mean(1.5, nullptr, "-")}};
}

/// A folder as `sigmaflow run` leaves it, of steps that need not exist.
class PageOfFolder : public testing::Test {
protected:
    void SetUp() override
    {
        std::string pattern = testing::TempDir() + "sigmaflow_page_XXXXXX";
        ASSERT_NE(mkdtemp(pattern.data()), nullptr);
        folder = fs::path(pattern) / "run";
        fs::create_directories(folder);
        manifest = {{"sigmaflow", "0.0.0"},
                    {"status", "complete"},
                    {"workflow_file", "w.json"},
                    {"seed", 18446744073709551615u},
                    {"host", "here"},
                    {"threads", 1},
                    {"libraries", {{"vtk", "9"}}},
                    {"workflow", {{"name", "flow"}, {"steps", Json::array()}}},
                    {"steps", Json::array()},
                    {"files", Json::array()}};
        summary = {{"workflow", "flow"}, {"steps", Json::object()}};
    }
    void TearDown() override { fs::remove_all(folder.parent_path()); }

    void add_step(const Json& parameters, const Json& results)
    {
        manifest["workflow"]["steps"].push_back(parameters);
        if (results.is_null()) return;
        manifest["steps"].push_back(
            {{"name", parameters["name"]}, {"step", parameters["step"]}, {"wall_seconds", 1.25}});
        summary["steps"][parameters["name"].get<std::string>()] = results;
    }

    void add_file(const std::string& name, const std::string& content)
    {
        fs::create_directories((folder / name).parent_path());
        std::ofstream(folder / name, std::ios::binary) << content;
        list_file(name, content.size());
    }

    void list_file(const std::string& name, std::size_t size)
    {
        manifest["files"].push_back({{"name", name}, {"size", size}});
    }

    void write_folder() const
    {
        std::ofstream(folder / "manifest.json") << manifest.dump(2);
        std::ofstream(folder / "summary.json") << summary.dump(2);
    }

    std::string page() const
    {
        write_folder();
        return text_of(write_report_page(folder, ""));
    }

    XmlTree tree() const
    {
        XmlTree result = read_xml(page());
        EXPECT_FALSE(result.elements.empty()) << "not well-formed";
        return result;
    }

    ErrorKind kind_of_error(const std::string& phrase, const fs::path& out = "") const
    {
        try {
            write_report_page(folder, out);
        } catch (const Error& error) {
            EXPECT_NE(std::string(error.what()).find(phrase), std::string::npos) << error.what();
            return error.kind();
        }
        return ErrorKind::internal;
    }

    fs::path folder;
    Json manifest, summary;
};

std::string svg(const std::string& inside)
{
    return "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"9\" height=\"9\">" + inside +
           "</svg>";
}

std::string decoded(const std::string& base64)
{
    const std::string letters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string bytes;
    unsigned bits = 0;
    int count = 0;
    for (char c : base64) {
        if (c == '=') break;
        bits = bits << 6 | static_cast<unsigned>(letters.find(c));
        count += 6;
        if (count < 8) continue;
        count -= 8;
        bytes += static_cast<char>(bits >> count & 255);
    }
    return bytes;
}

/// The pictures in the page by their names.
std::map<std::string, std::string> pictures_in(const XmlTree& tree)
{
    std::map<std::string, std::string> result;
    for (const XmlElement& image : tree.named("img")) {
        const std::string source = image.attribute("src");
        const std::size_t comma = source.find(";base64,");
        EXPECT_EQ(source.rfind("data:image/", 0), 0u);
        if (comma != std::string::npos)
            result[image.attribute("alt")] = decoded(source.substr(comma + 8));
    }
    return result;
}

void collect_numbers(const Json& value, std::multiset<double>& numbers)
{
    if (value.is_object() && value.contains("mean")) {
        numbers.insert(value["mean"].get<double>());
        return;
    }
    if (value.is_number()) numbers.insert(value.get<double>());
    if (value.is_structured())
        for (const Json& inner : value) collect_numbers(inner, numbers);
}

bool contains(const std::string& text, const std::string& part)
{
    return text.find(part) != std::string::npos;
}

/// What people read, in its order.
std::string words_of(const std::string& page)
{
    std::string text;
    bool inside = false;
    for (std::size_t k = page.find("</style>"); k < page.size(); ++k) {
        if (page[k] == '<') inside = true;
        if (!inside) text += page[k];
        if (page[k] == '>') inside = false;
    }
    return text;
}

}

TEST(Html, Base64IsThatOfTheStandard)  // RFC 4648, section 10
{
    EXPECT_EQ(html::base64(""), "");
    EXPECT_EQ(html::base64("f"), "Zg==");
    EXPECT_EQ(html::base64("fo"), "Zm8=");
    EXPECT_EQ(html::base64("foo"), "Zm9v");
    EXPECT_EQ(html::base64("foob"), "Zm9vYg==");
    EXPECT_EQ(html::base64("fooba"), "Zm9vYmE=");
    EXPECT_EQ(html::base64("foobar"), "Zm9vYmFy");
    EXPECT_EQ(html::base64(std::string("\xff\xfe\x00", 3)), "//4A");
}

TEST(Html, NothingInATextIsTakenForMarkup)
{
    const XmlTree tree =
        read_xml("<a b=\"" + html::escaped(hostile) + "\">" + html::escaped(hostile) + "</a>");
    ASSERT_EQ(tree.elements.size(), 1u);
    EXPECT_EQ(tree.elements[0].text, hostile_shown);
    EXPECT_EQ(tree.elements[0].attribute("b"), hostile_shown);
    EXPECT_EQ(html::escaped("\uFFFF\uFFFE"), "\uFFFD\uFFFD");
}

TEST(Html, AddressesLeadToNoOtherPlace)
{
    EXPECT_EQ(html::link("shear_0.5/run.h5"), "shear_0.5/run.h5");
    EXPECT_EQ(html::link("javascript:a(\"1\")"), "javascript%3Aa%28%221%22%29");
    EXPECT_EQ(html::link("a?b#c%d é"), "a%3Fb%23c%25d%20%C3%A9");
}

TEST_F(PageOfFolder, TellsTitleVerdictsAndStepsInTheOrderOfTheWorkflow)
{
    manifest["workflow"]["description"] = "what it is for";
    add_step({{"step", "pack"}, {"name", "zebra"}}, {{"step", "pack"}, {"seed", 1}});
    add_step(shear_step("middle", 2), flowing(0.0192345));
    add_step({{"step", "flow_curve"}, {"name", "aardvark"}},
             {{"step", "flow_curve"},
              {"curves", Json::array({{{"volume_fraction", 0.58}, {"shape", "S-shaped"}}})}});
    const XmlTree tree = this->tree();
    EXPECT_EQ(tree.named("title").at(0).text, "flow");
    std::vector<std::string> order;
    for (std::size_t k = 0; k < tree.elements.size(); ++k)
        if (tree.elements[k].name == "h3") order.push_back(tree.elements[k].text);
    ASSERT_EQ(order.size(), 3u);
    EXPECT_TRUE(contains(order[0], "zebra") && contains(order[1], "middle") &&
                contains(order[2], "aardvark"));
    const std::string text = words_of(page());
    for (const char* words : {"what it is for", "outcome: flowing", "errors reliable: yes",
                              "volume fraction 0.58: shape: S-shaped", "0.01923 ± 0.00096",
                              "3 of 3 steps are finished"})
        EXPECT_TRUE(contains(text, words)) << words;
    EXPECT_LT(text.find("outcome: flowing"), text.find("0.01923"));  // verdicts first
}

TEST_F(PageOfFolder, ShowsEveryNumberOfTheSummaryAndKeepsItExactly)
{
    add_step(shear_step("one", 2), flowing(0.0192345678901));
    add_step({{"step", "flow_curve"}, {"name", "curve"}},
             {{"step", "flow_curve"},
              {"confidence", 0.95},
              {"curves",
               Json::array({{{"volume_fraction", 0.58},
                             {"slopes", Json::array({{{"slope", -1.23456789e-3},
                                                      {"confidence_interval", {-2e-3, 1e-9}}}})},
                             {"critical_reynolds", mean(0.302, 0.053, "-")}}})}});
    const XmlTree tree = this->tree();
    std::multiset<double> wanted, found;
    collect_numbers(summary, wanted);
    for (const XmlElement& number : tree.named("data")) {
        const double value = std::stod(number.attribute("value"));
        found.insert(value);
        const std::string shown = number.text;
        const double read = std::stod(shown);
        // an error with two digits leaves one in twenty of it at most, others four digits
        const std::size_t sign = shown.find("±");
        const double slack = sign == std::string::npos ? 5e-4 * std::abs(value)
                                                       : 0.051 * std::stod(shown.substr(sign + 2));
        EXPECT_NEAR(read, value, slack + 1e-300) << shown;
    }
    for (double value : wanted) EXPECT_GE(found.count(value), wanted.count(value)) << value;
    EXPECT_TRUE(contains(words_of(page()), "18446744073709551615"));
}

TEST_F(PageOfFolder, HoldsEveryPictureOfTheFolder)
{
    const std::string png = render::png_bytes(render::Image(5, 4, {1, 2, 3}));
    add_step({{"step", "plot"}, {"name", "plot"}}, {{"step", "plot"}});
    add_step({{"step", "snapshot"}, {"name", "plot_2"}}, {{"step", "snapshot"}});
    add_file("plot.svg", svg("<clipPath id=\"clip0\"/>"));
    add_file("plot.png", png);
    add_file("plot_growth.svg", svg("<clipPath id=\"clip0\"/><script>1</script>"));
    add_file("plot_2.png", png);
    const XmlTree tree = this->tree();
    const auto pictures = pictures_in(tree);
    EXPECT_EQ(pictures.size(), 3u);  // plot.png shows what plot.svg does
    for (const char* name : {"plot.svg", "plot_growth.svg", "plot_2.png"}) {
        ASSERT_TRUE(pictures.contains(name)) << name;
        EXPECT_EQ(pictures.at(name), text_of(folder / name));
    }
    // what is in a picture is no part of the page
    EXPECT_TRUE(tree.named("script").empty());
    EXPECT_TRUE(tree.named("clipPath").empty());

    fs::remove(folder / "plot.svg");
    EXPECT_EQ(pictures_in(this->tree()).count("plot.png"), 1u);
    EXPECT_TRUE(contains(words_of(page()), "plot.svg: is missing now"));
    std::ofstream(folder / "plot_2.png") << "no picture";
    EXPECT_EQ(kind_of_error("plot_2.png: is no PNG picture"), ErrorKind::input);
}

TEST_F(PageOfFolder, HostileNamesAndTextsAreOnlyTexts)
{
    manifest["workflow"]["name"] = hostile;
    manifest["workflow"]["description"] = hostile;
    manifest["error"] = hostile;
    manifest[hostile] = hostile;
    add_step({{"step", hostile}, {"name", hostile}, {hostile, hostile}},
             {{"step", hostile},
              {"outcome", hostile},
              {hostile, 3},
              {"shear_rate", {{"mean", 1.5}, {"standard_error", "x"}, {"unit", hostile}}},
              {"list", Json::array({{{hostile, hostile}}})}});
    list_file("../../outside.png", 1);
    list_file("/etc/passwd", 1);
    list_file("javascript:alert(1)//x.html", 1);
    const XmlTree tree = this->tree();
    EXPECT_TRUE(tree.named("script").empty());
    EXPECT_EQ(tree.named("title").at(0).text, hostile_shown);
    const std::string text = words_of(page());
    EXPECT_FALSE(contains(text, "outside.png"));
    EXPECT_FALSE(contains(text, "passwd"));
    for (const XmlElement& link : tree.named("a")) {
        const std::string address = link.attribute("href");
        EXPECT_TRUE(address[0] == '#' || address.find(':') == std::string::npos) << address;
    }
    for (const XmlElement& element : tree.elements)
        for (const auto& [key, value] : element.attributes) EXPECT_NE(key.substr(0, 2), "on");
}

TEST_F(PageOfFolder, NeedsNothingFromElsewhereAndHasEveryIdOnce)
{
    for (int k = 0; k < 3; ++k) {
        const std::string name = "flow" + std::to_string(k);
        add_step(shear_step(name, 1 + k % 2), flowing(0.1));
        add_file(name + "/series.csv", "1");
    }
    const XmlTree tree = this->tree();
    std::set<std::string> ids;
    for (const XmlElement& element : tree.elements) {
        if (const std::string id = element.attribute("id"); !id.empty()) {
            EXPECT_TRUE(ids.insert(id).second) << id;
        }
        EXPECT_NE(element.name, "script");
        EXPECT_NE(element.name, "link");
        EXPECT_NE(element.name, "iframe");
    }
    for (const XmlElement& style : tree.named("style")) {
        EXPECT_FALSE(contains(style.text, "url("));
        EXPECT_FALSE(contains(style.text, "@import"));
    }
    for (const XmlElement& link : tree.named("a"))
        if (link.attribute("href")[0] == '#') {
            EXPECT_TRUE(ids.contains(link.attribute("href").substr(1)));
        } else {
            EXPECT_TRUE(fs::exists(folder / link.attribute("href"))) << link.attribute("href");
        }
}

TEST_F(PageOfFolder, LinksLeadToTheFolderFromWhereverThePageIs)
{
    add_step(shear_step("a", 1), flowing(0.1));
    add_file("a/series.csv", "1");
    write_folder();
    const fs::path out = folder.parent_path() / "some where" / "page.html";
    fs::create_directories(out.parent_path());
    write_report_page(folder, out);
    bool found = false;
    for (const XmlElement& link : read_xml(text_of(out)).named("a")) {
        if (link.attribute("href")[0] == '#') continue;
        EXPECT_TRUE(fs::exists(out.parent_path() / link.attribute("href")));
        found = true;
    }
    EXPECT_TRUE(found);
}

TEST_F(PageOfFolder, ASweepOfAHundredIsOneTable)
{
    for (int k = 0; k < 100; ++k)
        add_step(
            shear_step("sweep_" + std::to_string(k + 1), k + 1),
            k == 99 ? Json{{"step", "shear"}, {"outcome", "jammed"}} : flowing(0.01 * (k + 1)));
    add_step({{"step", "pack"}, {"name", "last"}}, {{"step", "pack"}, {"seed", 1}});
    const XmlTree tree = this->tree();
    EXPECT_EQ(tree.named("h3").size(), 2u);
    std::size_t largest = 0;
    for (const XmlElement& body : tree.named("tbody"))
        largest = std::max(largest, body.children.size());
    EXPECT_EQ(largest, 100u);
    const std::string text = words_of(page());
    EXPECT_TRUE(contains(text, "shear, 100 runs"));
    EXPECT_TRUE(contains(text, "jammed (stress 100)")) << text.substr(0, 3000);
}

TEST_F(PageOfFolder, RunsThatDifferInTwoParametersOrDrawAreToldAlone)
{
    Json other = shear_step("c", 3);
    other["strain"] = 7;
    add_step(shear_step("a", 1), flowing(0.1));
    add_step(shear_step("b", 2), flowing(0.1));
    add_step(other, flowing(0.1));
    add_step(shear_step("d", 9), flowing(0.1));
    add_file("d.svg", svg(""));
    write_folder();
    const auto parts = chapters(read_past_run(folder));
    ASSERT_EQ(parts.size(), 3u);
    EXPECT_EQ(parts[0].count, 2u);
    EXPECT_EQ(parts[0].parameter, "stress");
    EXPECT_EQ(parts[1].count, 1u);
    EXPECT_EQ(parts[2].first, 3u);
}

TEST_F(PageOfFolder, AnUnfinishedRunShowsWhatIsFinishedAndNothingOfEarlierRuns)
{
    manifest["status"] = "failed";
    manifest["error"] = "/steps/1 (second): not positive definite";
    add_step(shear_step("first", 1), flowing(0.125));
    add_step({{"step", "plot"}, {"name", "second"}}, nullptr);
    add_step({{"step", "pack"}, {"name", "third"}}, nullptr);
    summary["steps"]["third"] = {{"step", "pack"}, {"volume_fraction", 0.777}};
    const std::string text = words_of(page());
    EXPECT_TRUE(contains(text, "failed: 1 of 3 steps are finished"));
    EXPECT_TRUE(contains(text, "not positive definite"));
    EXPECT_TRUE(contains(text, "not finished"));
    EXPECT_TRUE(contains(text, "0.1250 ± 0.0063"));
    EXPECT_FALSE(contains(text, "0.777"));

    write_folder();
    fs::remove(folder / "summary.json");
    EXPECT_NO_THROW(write_report_page(folder, ""));
}

TEST_F(PageOfFolder, HasTheSameBytesForTheSameFolder)
{
    add_step(shear_step("a", 1), flowing(0.1));
    add_file("a/series.csv", "1");
    const std::string first = page();
    EXPECT_EQ(page(), first);
    EXPECT_EQ(text_of(write_report_page(fs::relative(folder) / "", "")), first);
}

TEST_F(PageOfFolder, DamagedJsonIsToldWithItsPlace)
{
    write_folder();
    std::ofstream(folder / "summary.json") << "{\"steps\": {\n  \"a\": 3}}";
    EXPECT_EQ(kind_of_error("summary.json:2:8: /steps/a: must be an object"), ErrorKind::input);
    std::ofstream(folder / "summary.json") << "{\"steps\": {";
    EXPECT_EQ(kind_of_error("summary.json:1:12"), ErrorKind::input);
    std::ofstream(folder / "manifest.json") << "{\n \"sigmaflow\": 1}";
    EXPECT_EQ(kind_of_error("manifest.json:2:15: /sigmaflow: must be a text"), ErrorKind::input);
}

TEST_F(PageOfFolder, NeverTakesThePlaceOfResults)
{
    add_step(shear_step("a", 1), flowing(0.1));
    add_file("a/series.csv", "precious");
    write_folder();
    for (const char* name : {"summary.json", "manifest.json", "a/series.csv", "a/../summary.json"})
        EXPECT_EQ(kind_of_error("is a result of the run", folder / name), ErrorKind::usage);
    EXPECT_EQ(text_of(folder / "a/series.csv"), "precious");
}

class ReportOfRun : public Program {};

TEST_F(ReportOfRun, ShowsARealRunAndEndsWithTheUsualExitCodes)
{
    write("w.json", R"({"name": "<real>", "suspension": {"particles": 30, "volume_fraction": 0.4,
        "size_ratio": 1}, "steps": [{"step": "pack"},
        {"step": "shear", "sweep": {"stress": [1, 2]}, "strain": 0.1, "frame_interval": 0.05},
        {"step": "velocity_profile", "bins": 4, "width": 320, "height": 240},
        {"step": "snapshot", "width": 320, "height": 180},
        {"step": "panels", "of": ["velocity_profile", "snapshot"], "width": 400}]})");
    ASSERT_EQ(run("run w.json -q").exit_code, 0);
    const Said said = run("report out/w");
    ASSERT_EQ(said.exit_code, 0) << said.err;
    EXPECT_EQ(said.out, "out/w/report.html\n");
    const std::string page = text_of(folder / "out/w/report.html");
    const XmlTree tree = read_xml(page);
    ASSERT_FALSE(tree.elements.empty());
    EXPECT_EQ(tree.named("title").at(0).text, "<real>");
    const auto pictures = pictures_in(tree);
    EXPECT_EQ(pictures.size(), 3u);
    for (const auto& [name, bytes] : pictures) EXPECT_EQ(bytes, text_of(folder / "out/w" / name));
    EXPECT_TRUE(contains(words_of(page), "shear, 2 runs"));

    // the page does not stop the run from being used again, and is the same afterwards
    ASSERT_EQ(run("run w.json -q").exit_code, 0);
    EXPECT_EQ(run("report out/w --out again.html").exit_code, 0);
    EXPECT_EQ(run("report nowhere").exit_code, 66);
    EXPECT_EQ(run("report w.json").exit_code, 65);
    EXPECT_EQ(run("report .").exit_code, 65);
    EXPECT_EQ(run("report").exit_code, 64);
    EXPECT_EQ(run("report out/w --out ''").exit_code, 64);
    EXPECT_EQ(run("report out/w --out out/w/summary.json").exit_code, 64);
    EXPECT_EQ(run("report out/w --out missing/page.html").exit_code, 73);
    EXPECT_EQ(run("report out/w --out /dev/full").exit_code, 74);
    EXPECT_EQ(run("report --help").exit_code, 0);
    write("out/w/manifest.json", "{");
    const Said damaged = run("report out/w");
    EXPECT_EQ(damaged.exit_code, 65);
    EXPECT_TRUE(contains(damaged.err, "manifest.json:1:")) << damaged.err;
    EXPECT_EQ(text_of(folder / "out/w/report.html"), page);
}

}
