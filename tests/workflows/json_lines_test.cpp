// --json: every line that the commands print is one that the published schema describes.
#include "tests/workflows/program.h"

#include <nlohmann/json.hpp>
#include <set>

namespace sigmaflow::workflows {

namespace {

using Json = nlohmann::json;

bool has_type(const Json& value, const std::string& type)
{
    return (type == "string" && value.is_string()) || (type == "boolean" && value.is_boolean()) ||
           (type == "object" && value.is_object()) || (type == "array" && value.is_array()) ||
           (type == "null" && value.is_null()) || (type == "number" && value.is_number()) ||
           (type == "integer" && value.is_number_integer());
}

/// What the value breaks of the words of draft-07 that the schema uses; "" if nothing.
std::string broken(const Json& value, const Json& schema)
{
    for (const auto& [word, rule] : schema.items()) {
        if (word == "description") continue;
        if (word == "const" && value != rule) return "is not " + rule.dump();
        if (word == "enum" && std::find(rule.begin(), rule.end(), value) == rule.end())
            return value.dump() + " is not one of " + rule.dump();
        if (word == "type") {
            const Json types = rule.is_array() ? rule : Json::array({rule});
            if (std::none_of(types.begin(), types.end(),
                             [&](const Json& type) { return has_type(value, type); }))
                return value.dump() + " is not of type " + rule.dump();
        }
        if (word == "required" && value.is_object())
            for (const Json& key : rule)
                if (!value.contains(key.get<std::string>())) return "lacks " + key.dump();
        if (word == "properties" && value.is_object())
            for (const auto& [key, member] : value.items()) {
                if (!rule.contains(key)) return "has an unknown key " + key;
                if (const auto why = broken(member, rule[key]); !why.empty())
                    return key + ": " + why;
            }
        if (word == "items" && value.is_array())
            for (const Json& element : value)
                if (const auto why = broken(element, rule); !why.empty()) return why;
        if (word == "oneOf" && std::count_if(rule.begin(), rule.end(), [&](const Json& one) {
                                   return broken(value, one).empty();
                               }) != 1)
            return "does not match exactly one of " + rule.dump();
    }
    return "";
}

class JsonLines : public Program {
protected:
    const Json schema = Json::parse(text_of(SIGMAFLOW_WORKFLOWS "/json_lines.schema.json"));

    /// The events of a command, each checked.
    std::vector<Json> events(const std::string& arguments, int code)
    {
        const Said said = run(arguments + " --json");
        EXPECT_EQ(said.exit_code, code) << arguments << "\n" << said.out << said.err;
        EXPECT_EQ(said.out.find('\033'), std::string::npos);
        EXPECT_EQ(said.err.find('\033'), std::string::npos);
        std::vector<Json> list;
        std::istringstream lines(said.out);
        for (std::string line; std::getline(lines, line);) {
            list.push_back(Json::parse(line));
            const std::string name = list.back()["event"];
            EXPECT_TRUE(schema["definitions"].contains(name)) << name;
            EXPECT_EQ(broken(list.back(), schema["definitions"][name]), "") << line;
            seen.insert(name);
        }
        return list;
    }

    std::set<std::string> seen;
};

constexpr const char* flow = R"({"suspension": {"particles": 30, "volume_fraction": 0.45},
    "steps": [{"step": "pack"}, {"step": "shear", "stress": 2, "strain": STRAIN}]})";

std::string with_strain(const std::string& strain)
{
    std::string text = flow;
    return text.replace(text.find("STRAIN"), 6, strain);
}

}

TEST_F(JsonLines, AreWhatTheSchemaSaysForEveryCommand)
{
    write("w.json", with_strain("0.1"));
    const auto first = events("run w.json", 0);
    EXPECT_EQ(first.front()["event"], "start");
    EXPECT_EQ(first.back(), (Json{{"event", "end"}, {"exit_code", 0}}));
    std::vector<std::string> order;
    for (const Json& event : first)
        if (event["event"] == "step_begin" || event["event"] == "step_end")
            order.push_back(event["event"].get<std::string>() + " " +
                            event["name"].get<std::string>());
    EXPECT_EQ(order, (std::vector<std::string>{"step_begin pack", "step_end pack",
                                               "step_begin shear", "step_end shear"}));
    const Json summary = Json::parse(text_of(folder / "out/w/summary.json"));
    for (const Json& event : first) {
        if (event["event"] != "step_end") continue;
        const Json& step = summary["steps"][event["name"].get<std::string>()];
        for (const auto& [key, value] : event["results"].items())
            EXPECT_EQ(value, step[key]) << key;
    }
    for (const Json& event : events("run w.json", 0))
        EXPECT_TRUE(event["event"] != "step_end" || event["from_earlier_run"] == true) << event;
    events("plan w.json", 0);
    events("status out/w", 0);
    events("verify out/w", 0);
    events("compare out/w out/w", 0);
    events("doctor", 0);
    EXPECT_EQ(events("validate w.json", 0).at(0)["valid"], true);

    write("l.json", with_strain("1000"));
    const auto stopped = events("run l.json --max-walltime 2s", 3);
    EXPECT_EQ(stopped.back(), (Json{{"event", "end"}, {"exit_code", 3}}));
    EXPECT_EQ(stopped[stopped.size() - 2]["event"], "error");
    EXPECT_EQ(stopped[stopped.size() - 2]["kind"], "interrupted");
    events("status out/l", 0);
    events("compare out/w/shear/series.csv out/l/shear/series.csv", 1);
    events("run l.json --max-walltime 2s", 3);  // a note: goes on

    write("w.json", R"({"suspension": {}, "steps": [{"step": "shear"}]})");
    EXPECT_EQ(events("run w.json", 65).front()["event"], "error");
    EXPECT_EQ(events("validate w.json nothing.json", 66).size(), 2u);
    EXPECT_EQ(events("status nowhere", 66).at(0)["exit_code"], 66);
    EXPECT_EQ(events("status", 64).at(0)["kind"], "usage");
    for (const auto& [name, unused] : schema["definitions"].items())
        EXPECT_TRUE(seen.contains(name) || name == "warning") << name << " was not tried";
}

TEST_F(JsonLines, ProgressComesAtMostOnceASecond)
{
    write("l.json", with_strain("1000"));
    int progress = 0;
    for (const Json& event : events("run l.json --max-walltime 4s", 3))
        if (event["event"] == "progress") {
            ++progress;
            EXPECT_GE(event["fraction"], 0);
            EXPECT_LE(event["fraction"], 1);
        }
    EXPECT_GE(progress, 1);
    EXPECT_LE(progress, 4);
}

// As `script` makes a terminal: with NO_COLOR nothing but plain lines is written to it.
TEST_F(JsonLines, NoColorKeepsEscapeSequencesFromATerminal)
{
    write("l.json", with_strain("1000"));
    const auto on_terminal = [&](const std::string& environment) {
        std::filesystem::remove_all(folder / "out");
        const std::string command =
            "cd '" + folder.string() + "' && " + environment +
            " script -qec \"'" SIGMAFLOW_PROGRAM
            "' run l.json --max-walltime 2s\" typed.txt >/dev/null 2>&1 </dev/null";
        if (std::system("command -v script >/dev/null") != 0) return std::string("?");
        std::system(command.c_str());
        return text_of(folder / "typed.txt");
    };
    const std::string coloured = on_terminal("TERM=xterm");
    if (coloured == "?") GTEST_SKIP() << "no program script";
    EXPECT_NE(coloured.find('\033'), std::string::npos);
    EXPECT_EQ(on_terminal("TERM=xterm NO_COLOR=1").find('\033'), std::string::npos);
    EXPECT_EQ(on_terminal("TERM=dumb").find('\033'), std::string::npos);
}

}
