// What is declared once is the same everywhere: reader, help, schema, reference, and the files in
// the repository that are made from it. Values from the command line are values of the file.
#include "workflows/explain.h"
#include "workflows/init.h"
#include "workflows/schema.h"
#include "workflows/step_names.h"
#include "workflows/steps.h"
#include "workflows/workflow.h"

#include "tests/workflows/program.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <set>

namespace sigmaflow::workflows {

namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

const fs::path shipped = SIGMAFLOW_WORKFLOWS;

/// Where the errors of a workflow are, "line:column: pointer".
std::vector<std::string> places_of_errors(const std::string& text)
{
    std::vector<std::string> places;
    const auto place = [&](const Error& error) {
        places.push_back(error.where().substr(error.where().find(':') + 1));
    };
    try {
        parse_workflow(text, "test.json");
    } catch (const Errors& errors) {
        for (const Error& error : errors.list()) place(error);
    } catch (const Error& error) {
        place(error);
    }
    return places;
}

Json resolved(const std::string& text, const std::vector<std::string>& set = {})
{
    std::vector<io::Override> overrides;
    for (const std::string& one : set) overrides.push_back(io::parse_override("--set", one));
    const auto document = io::JsonDocument::parse(text, "test.json", overrides);
    return Json::parse(read_workflow(document, "test.json").resolved().dump());
}

std::string error_of(const std::string& text, const std::string& set)
{
    try {
        resolved(text, {set});
    } catch (const Error& error) {
        return error.what();
    }
    return "";
}

constexpr const char* small =
    R"({"name": "small", "suspension": {"particles": 20, "volume_fraction": 0.3,
    "model": {"debye_length": 0.05}}, "steps": [{"step": "pack"},
    {"step": "shear", "stress": 2, "strain": 0.1, "series_interval": 0.01, "frame_interval": 0.05}]})";

}

TEST(Declarations, SchemaAndReferenceInTheRepositoryAreThoseOfTheProgram)
{
    EXPECT_EQ(text_of(shipped / schema_name), workflow_schema_text())
        << "sigmaflow schema > workflows/workflow.schema.json";
    EXPECT_EQ(text_of(shipped / "reference.md"), reference_page())
        << "sigmaflow explain --markdown > workflows/reference.md";
}

TEST(Declarations, EveryShippedWorkflowBeginsWithTheSchema)
{
    int count = 0;
    for (const auto& entry : fs::recursive_directory_iterator(shipped)) {
        if (entry.path().extension() != ".json" || entry.path().filename() == schema_name) continue;
        const auto workflow = nlohmann::ordered_json::parse(text_of(entry.path()));
        if (!workflow.contains("steps")) continue;
        ++count;
        ASSERT_TRUE(workflow.contains("$schema")) << entry.path();
        EXPECT_EQ(workflow.begin().key(), "$schema") << entry.path();
        const fs::path schema = entry.path().parent_path() / workflow["$schema"].get<std::string>();
        EXPECT_TRUE(fs::equivalent(schema, shipped / schema_name)) << entry.path();
    }
    EXPECT_GE(count, 20);
}

TEST(Declarations, EveryParameterIsExplainedAndInTheSchema)
{
    const Json schema = Json::parse(workflow_schema_text());
    for (const StepKind& kind : step_kinds()) {
        const std::string name(kind.name);
        Step step = kind.make();
        const std::string all = explain(name);
        const Json& properties = schema["$defs"][name]["properties"];
        const std::vector<io::Field> fields = step_fields(step);
        EXPECT_EQ(properties.size(), fields.size()) << name;
        for (const io::Field& field : fields) {
            EXPECT_FALSE(field.help.empty()) << field.name;
            EXPECT_NE(all.find(field.name), std::string::npos) << field.name;
            const std::string one = explain(name + "." + field.name);
            EXPECT_NE(one.find(field.allowed()), std::string::npos) << one;
            EXPECT_NE(one.find(field.default_text()), std::string::npos) << one;
            EXPECT_TRUE(properties.contains(field.name)) << name << " " << field.name;
        }
    }
    EXPECT_NE(explain("model.friction_static").find(">= 0 and <= 1e+06; default: 1.0"),
              std::string::npos);
    EXPECT_NE(explain("debye_length").find("model.debye_length [a]"), std::string::npos);
}

TEST(Declarations, UnknownNamesAreWrongUsageWithTheNearestOne)
{
    for (const auto& [asked, meant] : {std::pair{"sheer", "shear"},
                                       {"shear.stres", "shear.stress"},
                                       {"debye_lenght", "debye_length"}}) {
        try {
            explain(asked);
            ADD_FAILURE() << asked;
        } catch (const Error& error) {
            EXPECT_EQ(error.kind(), ErrorKind::usage);
            EXPECT_NE(
                std::string(error.what()).find("did you mean \"" + std::string(meant) + "\"?"),
                std::string::npos)
                << error.what();
        }
    }
}

TEST(Declarations, AllErrorsOfAWorkflowAreReportedAtOnceAndNoneFollowsFromAnother)
{
    const std::string text = R"({
"suspension": {"particles": 1.5, "volum_fraction": 0.5,
  "model": {"friction_static": -1, "debye_length": "a"}},
"steps": [
{"step": "pak"},
{"step": "shear", "name": "a", "stres": 2},
{"step": "shear", "name": "b", "stress": 2, "strain": 0, "scheme": "huen"},
{"step": "shear", "stress": 1, "strain": 2},
{"step": "snapshot", "of": "a"},
{"step": "snapshot", "of": "shear", "strain": 3},
{"step": "snapshot", "of": "c"},
{"step": "velocity_profile", "bins": 1},
{"step": "shear", "stress": 1, "rate": 2},
{"step": "snapshot", "name": "b"}
]})";
    const std::vector<std::string> expected{
        "2:34: /suspension/volum_fraction",
        "2:29: /suspension/particles",
        "3:32: /suspension/model/friction_static",
        "3:52: /suspension/model/debye_length",
        "5:10: /steps/0/step",
        "14:30: /steps/9/name",
        "6:32: /steps/1/stres",
        "7:55: /steps/2/strain",
        "7:68: /steps/2/scheme",
        "10:47: /steps/5/strain",
        "11:28: /steps/6/of",
        "12:38: /steps/7/bins",
        "13:32: /steps/8/rate",
    };
    std::vector<std::string> found = places_of_errors(text);
    EXPECT_EQ(found, expected);
}

TEST(Declarations, AFileFullOfErrorsIsLeftAtTheFiftieth)
{
    std::string keys;
    for (int k = 0; k < 100'000; ++k) keys += "\"x" + std::to_string(k) + "\": 1, ";
    EXPECT_EQ(places_of_errors("{" + keys + "\"steps\": 1}").size(), 50u);
}

TEST(Declarations, NineOfTenTypingErrorsAreUnderstood)
{
    std::set<std::string> unique;
    for (const StepKind& kind : step_kinds()) {
        Step step = kind.make();
        for (const io::Field& field : step_fields(step))
            if (field.name.size() > 3) unique.insert(field.name);
    }
    const std::vector<std::string> names(unique.begin(), unique.end());
    const std::vector<std::string_view> known(names.begin(), names.end());
    int understood = 0, count = 0;
    for (std::size_t k = 0; k < names.size(); ++k) {
        std::string typed = names[k];
        const std::size_t at = 1 + (7 * k) % (typed.size() - 2);
        switch (k % 5) {
            case 0:
                typed.erase(at, 1);
                break;
            case 1:
                typed.insert(at, 1, typed[at]);
                break;
            case 2:
                std::swap(typed[at], typed[at + 1]);
                break;
            case 3:
                typed[at] = typed[at] == 'e' ? 'a' : 'e';
                break;
            default:
                typed[0] = static_cast<char>(typed[0] - 'a' + 'A');
        }
        if (typed == names[k]) continue;
        ++count;
        understood += io::nearest_word(typed, known) == names[k];
    }
    EXPECT_GE(count, 50);
    EXPECT_GE(understood, 9 * count / 10) << "of " << count;
}

TEST(Overrides, AreValuesOfTheFile)
{
    Json edited = Json::parse(small);
    edited["steps"][1]["stress"] = 3;
    edited["steps"][1]["scheme"] = "heun";
    edited["suspension"]["model"]["debye_length"] = 0.1;
    edited["suspension"]["seed"] = 18446744073709551615u;
    EXPECT_EQ(resolved(small, {"/steps/1/stress=7", "/steps/1/stress=3", "/steps/1/scheme=heun",
                               "/suspension/model={\"debye_length\": 0.1}",
                               "/suspension/seed=18446744073709551615"}),
              resolved(edited.dump()));
}

TEST(Overrides, AreCheckedLikeTheFile)
{
    EXPECT_EQ(error_of(small, "/steps/1/stress=a"),
              "--set: /steps/1/stress: must be a number >= 1e-06 and <= 1e+09 [sigma0], got \"a\"");
    EXPECT_NE(
        error_of(small, "/steps/1/stres=2").find("--set: /steps/1/stres: unknown key, did you"),
        std::string::npos);
    EXPECT_NE(error_of(small, "/suspension/model={\"debye_length\": -1}")
                  .find("--set: /suspension/model/debye_length: must be"),
              std::string::npos);
    EXPECT_EQ(error_of(small, "/steps/7/stress=2"),
              "--set: /steps/7: does not exist in the file: there are 2 elements, counted from 0");
    EXPECT_EQ(error_of(small, "/a/b=2"), "--set: /a: does not exist in the file");
    EXPECT_NE(error_of(small, "/name/b=2").find("neither an object nor an array"),
              std::string::npos);
    for (const char* wrong : {"stress=2", "/steps/1/stress", "=", "/=2", ""}) try {
            io::parse_override("--set", wrong);
            ADD_FAILURE() << wrong;
        } catch (const Error& error) {
            EXPECT_EQ(error.kind(), ErrorKind::usage) << wrong;
        }
}

class Files : public Program {
protected:
    using Names = std::vector<std::string>;

    static Names differing(const std::map<std::string, std::string>& a,
                           const std::map<std::string, std::string>& b)
    {
        Names names;
        for (const auto& [name, text] : a)
            if (!b.contains(name) || b.at(name) != text) names.push_back(name);
        for (const auto& [name, text] : b)
            if (!a.contains(name)) names.push_back(name);
        return names;
    }

    /// All files of a run but those with times and records.
    std::map<std::string, std::string> results(const std::string& out)
    {
        std::map<std::string, std::string> files;
        for (const auto& entry : fs::recursive_directory_iterator(folder / out)) {
            const std::string name = fs::relative(entry.path(), folder / out).string();
            if (entry.is_regular_file() && name != "manifest.json" && !name.starts_with(".sigma"))
                files[name] = text_of(entry.path());
        }
        return files;
    }
};

TEST_F(Files, ResolvedWorkflowGivesTheSameBytes)
{
    write("small.json", small);
    ASSERT_EQ(run("run small.json -q --out first --set /suspension/seed=5").exit_code, 0);
    ASSERT_EQ(run("run first/resolved.json -q --out second").exit_code, 0);
    EXPECT_GE(results("first").size(), 8u);
    EXPECT_EQ(differing(results("first"), results("second")), Names());
    EXPECT_EQ(Json::parse(text_of(folder / "first/manifest.json"))["overrides"],
              Json({"/suspension/seed=5"}));
    // paths count from the folder of the workflow, the resolved one stands elsewhere
    write("stored.json", R"({"name": "stored", "steps": [
        {"step": "stored_run", "file": "first/shear/run.h5"}, {"step": "statistics"}]})");
    ASSERT_EQ(run("run stored.json -q --out third").exit_code, 0);
    ASSERT_EQ(run("run third/resolved.json -q --out fourth").exit_code, 0);
    auto third = results("third"), fourth = results("fourth");
    for (auto* files : {&third, &fourth}) {  // the path is told as it was given
        Json summary = Json::parse((*files)["summary.json"]);
        summary["steps"]["stored_run"].erase("file");
        (*files)["summary.json"] = summary.dump();
    }
    EXPECT_EQ(differing(third, fourth), Names());
}

TEST_F(Files, InitWritesAWorkflowThatRunsAndOverwritesNothing)
{
    ASSERT_EQ(run("init study.json").exit_code, 0);
    EXPECT_EQ(run("init study.json").exit_code, 64);
    EXPECT_EQ(text_of(folder / schema_name), workflow_schema_text());
    const Said checked = run("validate study.json");
    EXPECT_EQ(checked.exit_code, 0) << checked.err;
    const Said ran =
        run("run study.json -q --set /suspension/particles=60 --set /steps/2/strain=1 "
            "--set /steps/1/maximum_strain=1");
    EXPECT_EQ(ran.exit_code, 0) << ran.err;
    EXPECT_TRUE(fs::exists(folder / "out/study/snapshot.png"));
}

}
