// Every example is run once by the program, and its numbers are those of expected/<example>.json:
// rows of quantity, value, tolerance and why this value. A quantity is a path in summary.json, or
// <series.csv>/<column>/<row>, -1 for the last row. A value may be another quantity of the run.
#include "tests/workflows/program.h"

#include "io/series_csv.h"
#include "render/image.h"
#include "tests/support/film_reader.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <sstream>

namespace sigmaflow::workflows {

namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

std::vector<std::string> names_in(const fs::path& folder)
{
    std::vector<std::string> names;
    for (const auto& entry : fs::directory_iterator(folder))
        if (entry.path().extension() == ".json") names.push_back(entry.path().stem());
    std::sort(names.begin(), names.end());
    return names;
}

std::vector<std::string> examples()
{
    return names_in(SIGMAFLOW_WORKFLOWS "/examples");
}

std::vector<std::string> words_of(const std::string& quantity)
{
    std::vector<std::string> words;
    std::istringstream text(quantity);
    for (std::string word; std::getline(text, word, '/');) words.push_back(word);
    return words;
}

Json in_series(const fs::path& run, const std::vector<std::string>& words)
{
    const std::vector<Sample> series = io::read_series(run / words[0] / words[1]);
    const int row = std::stoi(words[3]);
    const Sample& sample = row < 0 ? series.at(series.size() + row) : series.at(row);
    for (const SampleField& field : sample_fields())
        if (field.name == words[2]) return sample.*field.value;
    throw std::runtime_error("no column " + words[2]);
}

Json value_of(const fs::path& run, const std::string& quantity)
{
    const std::vector<std::string> words = words_of(quantity);
    if (words.size() == 4 && words[1] == "series.csv") return in_series(run, words);
    Json value = Json::parse(text_of(run / "summary.json"));
    for (const std::string& word : words)
        value = value.is_array() ? value.at(std::stoul(word)) : value.at(word);
    return value;
}

bool names_a_quantity(const Json& value)
{
    return value.is_string() && value.get<std::string>().find('/') != std::string::npos;
}

/// Pictures show something: some of their pixels are not white.
void expect_drawn(const fs::path& picture)
{
    const render::Image image = render::read_png(picture);
    const auto dark = std::count_if(image.rgb.begin(), image.rgb.end(),
                                    [](std::uint8_t value) { return value < 200; });
    EXPECT_GT(dark, image.width) << picture;
}

class Example : public Program, public testing::WithParamInterface<std::string> {};

}

TEST_P(Example, GivesTheNumbersThatAreExpected)
{
    const std::string name = GetParam();
    const fs::path file = fs::path(SIGMAFLOW_WORKFLOWS "/examples") / (name + ".json");
    const Json workflow = Json::parse(text_of(file));
    EXPECT_EQ(workflow.begin().key(), "$schema");  // sorts before all letters
    EXPECT_EQ(workflow["$schema"], "../workflow.schema.json");
    EXPECT_FALSE(workflow["description"].get<std::string>().empty());

    const Said said = run("run -q '" + file.string() + "'");
    ASSERT_EQ(said.exit_code, 0) << said.err;
    const fs::path out = folder / "out" / name;
    EXPECT_EQ(Json::parse(text_of(out / "manifest.json"))["status"], "complete");
    for (const Json& row : Json::parse(text_of(fs::path(SIGMAFLOW_EXPECTED) / (name + ".json")))) {
        const std::string quantity = row["quantity"];
        const Json found = value_of(out, quantity);
        Json expected = row["value"];
        if (names_a_quantity(expected)) expected = value_of(out, expected.get<std::string>());
        EXPECT_FALSE(row["why"].get<std::string>().empty());
        if (expected.is_string()) {
            EXPECT_EQ(found, expected) << quantity;
            continue;
        }
        ASSERT_TRUE(found.is_number()) << quantity;
        EXPECT_NEAR(found.get<double>(), expected.get<double>(), row["tolerance"].get<double>())
            << quantity << ": " << row["why"];
    }
    for (const auto& entry : fs::recursive_directory_iterator(out)) {
        if (entry.path().extension() == ".png") expect_drawn(entry.path());
        if (entry.path().extension() != ".ogv") continue;
        const test::Film film = test::read_film(text_of(entry.path()));
        EXPECT_TRUE(film.ended);
        EXPECT_EQ(film.frames.size(), value_of(out, "steps/movie/frames").get<std::size_t>());
        const render::Image last = render::read_png(out / "movie.png");
        EXPECT_EQ(film.width, last.width);
        EXPECT_EQ(film.height, last.height);
    }
}

INSTANTIATE_TEST_SUITE_P(Gallery, Example, testing::ValuesIn(examples()),
                         [](const auto& example) { return example.param; });

TEST(Examples, AreAllRunAndAreAllInTheTable)
{
    const std::vector<std::string> shipped = examples();
    EXPECT_GE(shipped.size(), 10u);
    EXPECT_EQ(shipped, names_in(SIGMAFLOW_EXPECTED));
    const std::string table = text_of(SIGMAFLOW_WORKFLOWS "/examples/README.md");
    for (const std::string& name : shipped) {
        EXPECT_NE(table.find("`" + name + ".json`"), std::string::npos) << name;
        const Json rows = Json::parse(text_of(fs::path(SIGMAFLOW_EXPECTED) / (name + ".json")));
        EXPECT_GE(rows.size(), 2u) << name;
    }
}

}
