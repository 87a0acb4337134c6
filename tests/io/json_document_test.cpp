// Strict JSON: places of values and keys, refused texts and files, checked conversions.
#include "io/json_document.h"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>

namespace sigmaflow::io {

namespace {

/// The message of the Error(input) that a text or a conversion causes.
template <class Use>
std::string message_of(const std::string& text, Use use)
{
    try {
        const auto document = JsonDocument::parse(text, "f.json");
        use(document.root());
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::input);
        return error.what();
    }
    return "accepted";
}

std::string message_of(const std::string& text)
{
    return message_of(text, [](const JsonNode&) {});
}

class JsonFile : public testing::Test {
protected:
    void SetUp() override
    {
        std::string pattern = testing::TempDir() + "json_XXXXXX";
        ASSERT_NE(mkdtemp(pattern.data()), nullptr);
        folder_ = pattern;
    }
    void TearDown() override { std::filesystem::remove_all(folder_); }

    std::filesystem::path write(const std::string& text)
    {
        std::ofstream(folder_ / "f.json", std::ios::binary) << text;
        return folder_ / "f.json";
    }
    ErrorKind kind_of(const std::filesystem::path& path)
    {
        try {
            JsonDocument::read(path);
        } catch (const Error& error) {
            EXPECT_NE(std::string(error.what()).find(path.string()), std::string::npos);
            return error.kind();
        }
        ADD_FAILURE() << path << " was accepted";
        return ErrorKind::internal;
    }

    std::filesystem::path folder_;
};

}

TEST(JsonDocument, KnowsWhereEveryValueAndKeyStands)
{
    const auto document = JsonDocument::parse(
        "{\n  \"a\": [1,\n    {\"b/c~\": null}],\n"
        "  \"γ̇σ\": true, \"d\": \"x\"\n}",
        "f.json");
    const JsonNode root = document.root();
    const auto place = [](const JsonNode& node) { return node.error("!").where(); };
    EXPECT_EQ(place(root), "f.json:1:1");
    EXPECT_EQ(place(root.member("a")), "f.json:2:8: /a");
    EXPECT_EQ(place(root.member("a").element(0)), "f.json:2:9: /a/0");
    EXPECT_EQ(place(root.member("a").element(1)), "f.json:3:5: /a/1");
    EXPECT_EQ(place(root.member("a").element(1).member("b/c~")), "f.json:3:14: /a/1/b~1c~0");
    EXPECT_EQ(place(root.member("d")), "f.json:4:21: /d");
    EXPECT_EQ(root.error_at_key("d", "!").where(), "f.json:4:16: /d");
    EXPECT_EQ(root.keys(), (std::vector<std::string>{"a", "γ̇σ", "d"}));
}

TEST(JsonDocument, TextsWithEscapesAndStructureInsideDoNotShiftPlaces)
{
    const auto document =
        JsonDocument::parse(R"(["a\"b,:{[\\", "\u03c3", {"k\n":  -1.5e-3}])", "f.json");
    EXPECT_EQ(document.root().element(0).text(), "a\"b,:{[\\");
    EXPECT_EQ(document.root().element(1).text(), "σ");
    EXPECT_EQ(document.root().element(2).error("!").where(), "f.json:1:26: /2");
    EXPECT_EQ(document.root().element(2).member("k\n").wrong("x").what(),
              std::string("f.json:1:35: /2/k?: x, got -1.5e-3"));
}

TEST(JsonDocument, LineEndsOfWindowsCount)
{
    EXPECT_EQ(message_of("{\r\n \"a\": 1,\r\n \"a\": 2}").substr(0, 11), "f.json:3:2:");
}

TEST(JsonDocument, RefusesNestingDeeperThan64)
{
    const auto nested = [](int depth) { return std::string(depth, '[') + std::string(depth, ']'); };
    EXPECT_EQ(message_of(nested(64)), "accepted");
    EXPECT_EQ(message_of(nested(65)), "f.json:1:65: nested deeper than 64");
    EXPECT_EQ(message_of(std::string(1'000'000, '[')), "f.json:1:65: nested deeper than 64");
    std::string objects;
    for (int i = 0; i < 100'000; ++i) objects += "{\"a\":";
    EXPECT_EQ(message_of(objects), "f.json:1:321: nested deeper than 64");
}

TEST(JsonDocument, RefusesWhatIsNotUtf8)
{
    for (const char* bad : {"\"\xFF\"", "\"\xC0\xAF\"", "\"\xED\xA0\x80\"", "\"\xF4\x90\x80\x80\"",
                            "\"\xE2\x82\"", "\"\x80\""})
        EXPECT_NE(message_of(bad).find("UTF-8"), std::string::npos) << message_of(bad);
    for (const char* good : {"\"\xC3\xA9\"", "\"\xF0\x9D\x9B\xBE\"", "\"\xEF\xBF\xBD\""})
        EXPECT_EQ(message_of(good), "accepted");
    EXPECT_NE(message_of("\xEF\xBB\xBF{}").find("byte-order mark"), std::string::npos);
    EXPECT_NE(message_of("\xFF\xFE{").find("UTF-16"), std::string::npos);
    EXPECT_NE(message_of("\"\\ud800\""), "accepted");  // half a pair
}

TEST(JsonDocument, RefusesANulByteInsteadOfEndingThere)
{
    EXPECT_EQ(message_of(std::string("{}\0garbage", 10)), "f.json:1:3: contains a NUL byte");
}

TEST(JsonDocument, MessagesHoldNoControlCharacters)
{
    const std::string message = message_of("{\"\\u001b[31m\\n\": 1}",
                                           [](const JsonNode& n) { n.refuse_other_keys({"a"}); });
    for (char c : message) EXPECT_GE(static_cast<unsigned char>(c), 0x20);
    EXPECT_EQ(in_quotes("a\"b\n\x1b"), "\"a\\\"b\\n\\u001b\"");
    EXPECT_EQ(in_quotes("γγγγ", 5), "\"γγ...\"");  // never half a character
}

TEST(JsonDocument, MessagesAreUtf8EvenAboutBytesThatAreNot)
{
    EXPECT_EQ(message_of("  \x9C"), "f.json:1:3: not valid JSON: unexpected \"\uFFFD\"");
    EXPECT_EQ(message_of("[“a”]"), "f.json:1:2: /0: not valid JSON: unexpected \"“a”\"");
    EXPECT_EQ(message_of("1e999\xC4\x08"),
              "f.json:1:1: not valid JSON: the number 1e999 is too large");
}

// ------------------------------------------------------------------------------ conversions

TEST(JsonNode, IntegersAreExactAndInRange)
{
    const auto integer = [](const std::string& text) {
        return message_of(text, [&](const JsonNode& n) {
            throw Error(ErrorKind::input, "", std::to_string(n.integer(-10, 5'000'000'000)));
        });
    };
    EXPECT_EQ(integer("7"), "7");
    EXPECT_EQ(integer("-10"), "-10");
    EXPECT_EQ(integer("-0"), "0");
    EXPECT_EQ(integer("5000000000"), "5000000000");
    EXPECT_EQ(integer("1e3"), "1000");
    EXPECT_EQ(integer("2.0"), "2");
    for (const char* bad : {"1.5", "-11", "5000000001", "1e300", "1e-1", "99999999999999999999",
                            "\"7\"", "true", "null", "[7]"})
        EXPECT_NE(integer(bad).find("must be an integer >= -10 and <= 5000000000, got"),
                  std::string::npos)
            << bad << ": " << integer(bad);
}

TEST(JsonNode, UnsignedIntegersReach64Bits)
{
    const auto document = JsonDocument::parse("[18446744073709551615, 0, 1e3]", "f.json");
    EXPECT_EQ(document.root().element(0).unsigned_integer(), 18446744073709551615u);
    EXPECT_EQ(document.root().element(1).unsigned_integer(), 0u);
    EXPECT_EQ(document.root().element(2).unsigned_integer(), 1000u);
    for (const char* bad : {"-1", "18446744073709551616", "1.5", "1e20", "-1e3", "\"1\""})
        EXPECT_NE(message_of(bad, [](const JsonNode& n) { n.unsigned_integer(); })
                      .find("must be an integer >= 0 and < 2^64"),
                  std::string::npos)
            << bad;
}

TEST(JsonNode, NumbersKeepTheirLastBit)
{
    for (double value : {0.1, 1.0 / 3, 5e-324, 1.7976931348623157e308, -2.2250738585072014e-308}) {
        const auto document = JsonDocument::parse("[" + number_text(value) + "]", "f.json");
        EXPECT_EQ(document.root().element(0).number(), value);
    }
    EXPECT_NE(message_of("[1e309]"), "accepted");
    EXPECT_NE(message_of("[-1e999]"), "accepted");
}

TEST(JsonNode, RangesAreOpenOrClosedAsDeclared)
{
    EXPECT_TRUE(above_to(0, 0.64).contains(0.64));
    EXPECT_FALSE(above_to(0, 0.64).contains(0));
    EXPECT_FALSE(above_to(0, 0.64).contains(std::nextafter(0.64, 1)));
    EXPECT_TRUE(between(1, 2).contains(1));
    EXPECT_FALSE(from_below(1, 2).contains(2));
    EXPECT_FALSE(below(2).contains(2));
    EXPECT_FALSE(any_number().contains(std::nan("")));
    EXPECT_FALSE(any_number().contains(HUGE_VAL));
    EXPECT_EQ(above_to(0, 0.64).text(), "> 0 and <= 0.64");
    EXPECT_EQ(from_below(-1, 2).text(), ">= -1 and < 2");
    EXPECT_EQ(any_number().text(), "finite");
    EXPECT_EQ(message_of("[0]", [](const JsonNode& n) { n.element(0).number(above(0), "sigma0"); }),
              "f.json:1:2: /0: must be > 0 [sigma0], got 0");
}

TEST(JsonNode, ArraysAreCheckedForLengthAndEveryElement)
{
    const auto vector = [](const std::string& text) {
        return message_of(text, [](const JsonNode& n) { n.vector(above(0), "a"); });
    };
    EXPECT_EQ(vector("[1, 2, 3]"), "accepted");
    EXPECT_EQ(vector("[1, 2]"),
              "f.json:1:1: must be an array of 3 numbers, got an array of 2 elements");
    EXPECT_EQ(vector("[1, 2,\n0]"), "f.json:2:1: /2: must be > 0 [a], got 0");
    EXPECT_EQ(vector("[1, 2, \"3\"]"), "f.json:1:8: /2: must be a number > 0 [a], got \"3\"");
    EXPECT_EQ(vector("{}"), "f.json:1:1: must be an array of 3 numbers, got an object");

    const auto document = JsonDocument::parse("[[1, 2, 3], [4, 5, 6], [7, 8, 9]]", "f.json");
    const Mat3 matrix = document.root().matrix();
    EXPECT_EQ(matrix(0, 2), 3);
    EXPECT_EQ(matrix(2, 0), 7);
    EXPECT_EQ(document.root().vectors(Length::exactly(3))[1], Vec3(4, 5, 6));
    EXPECT_EQ(message_of("[[1, 2, 3], [4, 5], [7, 8, 9]]", [](const JsonNode& n) { n.matrix(); }),
              "f.json:1:13: /1: must be an array of 3 numbers, got an array of 2 elements");
}

TEST(JsonNode, NearestWordAllowsTwoSlips)
{
    constexpr std::array<std::string_view, 4> words{"volume_fraction", "strain", "stress", "seed"};
    EXPECT_EQ(nearest_word("volum_fracton", words), "volume_fraction");
    EXPECT_EQ(nearest_word("sterss", words), "stress");
    EXPECT_EQ(nearest_word("strian", words), "strain");
    EXPECT_EQ(nearest_word("Volume-Fraction", words), "volume_fraction");
    EXPECT_EQ(nearest_word("vol", words), "volume_fraction");
    EXPECT_EQ(nearest_word("temperature", words), std::nullopt);
    EXPECT_EQ(nearest_word("x", words), std::nullopt);
    EXPECT_EQ(nearest_word("", words), std::nullopt);
    EXPECT_EQ(nearest_word(std::string(100'000, 's'), words), std::nullopt);
}

// ------------------------------------------------------------------------------------ files

TEST_F(JsonFile, MissingFilesFoldersPipesAndDevicesAreNotRead)
{
    EXPECT_EQ(kind_of(folder_ / "nothing.json"), ErrorKind::missing);
    EXPECT_EQ(kind_of(folder_ / "no_folder" / "f.json"), ErrorKind::missing);
    EXPECT_EQ(kind_of(folder_), ErrorKind::missing);
    EXPECT_EQ(kind_of("/dev/zero"), ErrorKind::missing);
    ASSERT_EQ(mkfifo((folder_ / "pipe").c_str(), 0600), 0);
    EXPECT_EQ(kind_of(folder_ / "pipe"), ErrorKind::missing);  // and does not wait for a writer
    if (geteuid() != 0) {
        const auto secret = write("{}");
        std::filesystem::permissions(secret, std::filesystem::perms::none);
        EXPECT_EQ(kind_of(secret), ErrorKind::missing);
    }
}

TEST_F(JsonFile, FilesAbove32MebibytesAreRefusedUnread)
{
    const auto path = write("{}");
    std::filesystem::resize_file(path, (std::uintmax_t{32} << 20) + 1);
    EXPECT_EQ(kind_of(path), ErrorKind::input);
}

TEST_F(JsonFile, IsReadWhole)
{
    const auto path = write("{\"a\": [" + std::string(200'000, ' ') + "1]}");
    const auto document = JsonDocument::read(path);
    EXPECT_EQ(document.root().member("a").element(0).number(), 1);
}

}
