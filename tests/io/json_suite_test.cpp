// Texts that are JSON and must be read (y), and texts that are not, or that name a key twice, and
// must be refused as a whole (n). The grammar is that of RFC 8259; what it leaves open is decided
// here: numbers beyond double precision, halves of surrogate pairs and repeated keys are refused.
#include "io/json_document.h"

#include <gtest/gtest.h>
#include <array>
#include <string>
#include <string_view>

namespace sigmaflow::io {
namespace {

// clang-format off
constexpr std::array<std::string_view, 83> y{
    "null", "true", "false", "0", "-0", "1", "-1", "42", "1.5", "-0.0", "0.1", "1e0", "1E0", "1e+3", "1e-3",
    "1E+3", "0e0", "0.5e-7", "-1.25E2", "123456789012345678901234567890", "0.0000000000000000000000000000001",
    "1e308", "-1e308", "1e-400", "4.9e-324", "1.7976931348623157e308", "18446744073709551616", "\"\"",
    "\"a\"", "\" \"", "\"\\\"\"", "\"\\\\\"", "\"\\/\"", "\"/\"", "\"\\b\\f\\n\\r\\t\"", "\"\\u0041\"",
    "\"\\u00e9\"", "\"\\u03b3\\u0307\"", "\"\\ud834\\udd1e\"", "\"\\uD834\\uDD1E\"", "\"\\u0000\"",
    "\"\\uFFFF\"", "\"\\u2028\"", "\"\177\"", "\"\303\251\"", "\"\316\263\314\207\"", "\"\360\235\233\276\"",
    "\"\342\200\250\342\200\251\"", "\"\357\273\277\"", "\"\357\277\277\"", "\"{\\\"a\\\": [1, 2]}\"",
    "\"// no comment\"", "\"/* nor this */\"", "[]", "[ ]", "[1]", "[1,2]", "[1, \"a\", null, true, {}]",
    "[[]]", "[[[[1]]]]", "[[1],[2]]", "[\t1\n,\r\n2 ]", "[null, null]", "[-0]", "[0,0.0,0e1]", "{}", "{ }",
    "{\"a\":1}", "{\"a\": 1, \"b\": 2}", "{\"\":0}", "{\" \":0}", "{\"a\":{\"a\":{\"a\":{}}}}",
    "{\"a\":[],\"b\":{}}", "{\"\\u0061\":1,\"b\":2}", "{\"a\":1,\"A\":2}", "{\"a\\u0000b\":1,\"a\":2}",
    "{\"\303\251\":1,\"e\\u0301\":2}", "{\"a\"\n:\n1}", "{\"a\":{\"b\":1},\"b\":{\"b\":1}}",
    "[{\"a\":1},{\"a\":1}]", " 1 ", "\n\n[1]\n\n", "\t{}\r\n",
};

constexpr std::array<std::string_view, 162> n{
    "nul", "nulll", "Null", "NULL", "tru", "truee", "True", "FALSE", "nil", "undefined", "NaN", "-NaN",
    "Infinity", "-Infinity", "inf", "+1", "--1", "-", "- 1", "01", "-01", "00", "1.", ".5", "-.5", "1.e3",
    "1e", "1e+", "1e-", "1ee3", "1e3.5", "1.2.3", "1 000", "1,000", "1_000", "0x10", "0b1", "0o7", "1f",
    "1e999", "-1e999", "1/2", "\302\275", "\357\274\221", "\342\210\236", "\"", "\"a", "a\"", "'a'", "`a`",
    "\342\200\234a\342\200\235", "\"a\" \"b\"", "\"\\a\"", "\"\\x41\"", "\"\\'\"", "\"\\\"", "\"\\u\"",
    "\"\\u00\"", "\"\\u00G0\"", "\"\\U00000041\"", "\"\\ud834\"", "\"\\udd1e\"", "\"\\udd1e\\ud834\"",
    "\"\\ud834\\u0041\"", "\"\\ud834x\"", "\"a\nb\"", "\"a\tb\"", "\"a\rb\"", "\"\037\"", "\"\001\"", "[",
    "]", "[1", "[1,", "[1,]", "[,1]", "[,]", "[1,,2]", "[1 2]", "[1;2]", "[1:2]", "[\"a\":1]", "[1]]", "[[1]",
    "[1}", "[*]", "[1,2,...]", "{", "}", "{\"a\"", "{\"a\":", "{\"a\":1", "{\"a\":1,", "{\"a\":1,}",
    "{,\"a\":1}", "{\"a\":1,,\"b\":2}", "{\"a\" 1}", "{\"a\"::1}", "{\"a\"=1}", "{\"a\"}", "{\"a\",\"b\"}",
    "{a:1}", "{'a':1}", "{1:1}", "{null:1}", "{[]:1}", "{\"a\":1]", "{\"a\":1}}", "{\"a\":1 \"b\":2}",
    "{\"a\":1;\"b\":2}", "{\"a\":1,\"a\":2}", "{\"a\":1,\"a\":1}", "{\"a\":1,\"\\u0061\":2}",
    "{\"a\":{\"b\":1,\"b\":2}}", "[{\"\":0,\"\":0}]", "{\"x\":1,\"y\":2,\"x\":3}", "", " ", "\n", "// a\n1",
    "/* a */ 1", "1 // a", "1 /* a */", "# a\n1", "[1, # a\n2]", "1 2", "{} {}", "[] x", "1,", "{},",
    "\\u0031", "\\n1", "\0141", "\302\2401", "\342\200\2501", "\357\273\2771", "[\342\200\2131]", "@", "$",
    "()", "<a/>", "%PDF", "key: value", "\"\377\"", "\"\376\"", "\"\200\"", "\"\303\"", "\"\303(\"",
    "\"\300\257\"", "\"\301\277\"", "\"\340\200\257\"", "\"\342\202\"", "\"\342(\"", "\"\355\240\200\"",
    "\"\355\277\277\"", "\"\360\200\200\200\"", "\"\360\235\233\"", "\"\364\220\200\200\"",
    "\"\370\210\200\200\200\"", "\377", "[\351]", "{\"\351\":1}",
};
// clang-format on

}

TEST(JsonSuite, ReadsWhatIsJson)
{
    for (const std::string_view text : y)
        EXPECT_NO_THROW(JsonDocument::parse(std::string(text), "y.json")) << text;
}

TEST(JsonSuite, RefusesWhatIsNotJson)
{
    for (const std::string_view text : n) {
        try {
            JsonDocument::parse(std::string(text), "n.json");
            ADD_FAILURE() << "accepted: " << text;
        } catch (const Error& error) {
            EXPECT_EQ(error.kind(), ErrorKind::input) << text;
            EXPECT_EQ(error.where().substr(0, 7), "n.json:") << error.what();
        }
    }
}

TEST(JsonSuite, RefusesEveryBeginningOfAnObject)
{
    const std::string text = R"({"a": [1, -2.5e-3, "x\u00e9", true, null], "b": {"c": {}}})";
    EXPECT_NO_THROW(JsonDocument::parse(text, "y.json"));
    for (std::size_t length = 0; length < text.size(); ++length)
        EXPECT_THROW(JsonDocument::parse(text.substr(0, length), "n.json"), Error) << length;
}

}
