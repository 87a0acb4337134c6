// Parameters declared once: reading, writing, explaining.
#include "io/json_fields.h"

#include "io/model_fields.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace sigmaflow::io {

namespace {

enum class Colour { red, green };

struct Example {
    double length = 0.25;
    std::optional<double> width;
    int count = 3;
    std::uint64_t seed = 7;
    bool flag = true;
    std::string title;
    std::string word = "b";
    Colour colour = Colour::green;
    Vec3 shape{1, 2, 3};
    std::vector<double> radii;
    double depth = 1;

    std::vector<Field> describe()
    {
        Fields f;
        f("length", length, above(0), "a", "how long").require();
        f("width", width, at_least(0), "a", "how wide");
        f("count", count, Integers{1, 9}, "-", "how many");
        f("seed", seed, "seed");
        f("flag", flag, "or not");
        f("title", title, 10, "what it is called");
        f("word", word, std::vector<std::string_view>{"a", "b"}, "a word");
        f("colour", colour, Words<Colour>{{"red", Colour::red}, {"green", Colour::green}},
          "a colour");
        f("shape", shape, above(0), "a", "a vector");
        f("radii", radii, Length{1, 3}, above(0), "a", "a list");
        f.group("inner", "an object",
                [this](Fields& g) { g("depth", depth, between(0, 1), "-", "how deep"); });
        return f.list();
    }
    void read(const std::string& text)
    {
        const auto document = JsonDocument::parse(text, "f.json");
        read_fields(document.root(), describe());
    }
};

}

TEST(Fields, FillTheStructAndKeepDefaultsOfWhatIsNotGiven)
{
    Example e;
    e.read(R"({"length": 2, "width": 0, "count": 4, "seed": 18446744073709551615, "flag": false,
               "title": "t", "word": "a", "colour": "red", "radii": [1, 2], "inner": {"depth": 0}})");
    EXPECT_EQ(e.length, 2);
    EXPECT_EQ(e.width, 0);
    EXPECT_EQ(e.count, 4);
    EXPECT_EQ(e.seed, 18446744073709551615u);
    EXPECT_FALSE(e.flag);
    EXPECT_EQ(e.title, "t");
    EXPECT_EQ(e.word, "a");
    EXPECT_EQ(e.colour, Colour::red);
    EXPECT_EQ(e.shape, Vec3(1, 2, 3));
    EXPECT_EQ(e.radii, (std::vector<double>{1, 2}));
    EXPECT_EQ(e.depth, 0);
}

TEST(Fields, WrittenJsonReadsBackAsTheSameStruct)
{
    Example first;
    first.read(R"({"length": 0.1, "colour": "red", "inner": {"depth": 0.3333333333333333}})");
    Example second;
    second.read(write_fields(first.describe()).dump());
    EXPECT_EQ(write_fields(second.describe()), write_fields(first.describe()));
    EXPECT_EQ(second.length, 0.1);
    EXPECT_EQ(second.depth, 0.3333333333333333);
    EXPECT_FALSE(write_fields(first.describe()).contains("width"));
}

TEST(Fields, RequiredOnesMustBeGiven)
{
    Example e;
    try {
        e.read("{\"count\": 1}");
        FAIL();
    } catch (const Error& error) {
        EXPECT_EQ(error.what(), std::string("f.json:1:1: misses the required key \"length\""));
    }
}

TEST(Fields, ExplainThemselves)
{
    Example e;
    const auto fields = e.describe();
    EXPECT_EQ(fields[0].allowed(), "> 0");
    EXPECT_EQ(fields[0].default_text(), "required");
    EXPECT_EQ(fields[1].default_text(), "none");
    EXPECT_EQ(fields[2].allowed(), "integer >= 1 and <= 9");
    EXPECT_EQ(fields[2].default_text(), "3");
    EXPECT_EQ(fields[7].allowed(), "red, green");
    EXPECT_EQ(fields[7].default_text(), "\"green\"");
}

TEST(ModelFields, WrittenModelReadsBackBitwise)
{
    Model model;
    model.normal_stiffness = 1.0 / 3;
    model.stiffness_scale = StiffnessScale::fixed;
    model.repulsion_amplitude = RepulsionAmplitude::constant;
    model.background_drag = false;
    model.friction_dynamic = 0.3;
    Fields f;
    describe(f, model);
    const auto document = JsonDocument::parse(write_fields(f.list()).dump(), "f.json");
    const Model back = read_model(document.root());
    EXPECT_EQ(back.normal_stiffness, model.normal_stiffness);
    EXPECT_EQ(back.stiffness_scale, StiffnessScale::fixed);
    EXPECT_EQ(back.repulsion_amplitude, RepulsionAmplitude::constant);
    EXPECT_FALSE(back.background_drag);
    EXPECT_EQ(back.friction_dynamic, 0.3);
    EXPECT_EQ(document.root().keys().size(), 19u);  // every parameter of the model
}

TEST(ModelFields, ControlIsEitherStressOrRate)
{
    Model scaled, fixed;
    fixed.stiffness_scale = StiffnessScale::fixed;
    const auto control = [](const char* text, const Model& model) {
        const auto document = JsonDocument::parse(text, "f.json");
        return read_control(document.root(), model);
    };
    EXPECT_EQ(std::get<ImposedStress>(control("{\"stress\": 2}", scaled)).value, 2);
    EXPECT_EQ(std::get<ImposedRate>(control("{\"rate\": -0.5}", fixed)).value, -0.5);
    EXPECT_EQ(std::get<ImposedStress>(control("{\"stress\": -1}", fixed)).value, -1);
    for (const char* bad : {"{\"rate\": 1}", "{\"stress\": 0}", "{\"stress\": -1}", "{}",
                            "{\"stress\": 1, \"rate\": 1}", "{\"stres\": 1}", "1"})
        EXPECT_THROW(control(bad, scaled), Error) << bad;
}

}
