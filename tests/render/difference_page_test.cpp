// tests/render/difference_page_test.cpp -- comparisons that fail on purpose, and the page that they
// leave, read back by an XML parser.
#include "tests/support/difference_page.h"

#include "tests/render/scenes.h"
#include "tests/support/image_compare.h"
#include "tests/support/xml_tree.h"

#include <gtest/gtest.h>
#include <algorithm>
#include <fstream>
#include <map>
#include <sstream>

using namespace sigmaflow;
using render::Image;
namespace fs = std::filesystem;

namespace {

class DifferencePage : public testing::Test {
protected:
    void SetUp() override
    {
        std::string pattern = testing::TempDir() + "sigmaflow_images_XXXXXX";
        ASSERT_NE(mkdtemp(pattern.data()), nullptr);
        folders = {fs::path(pattern) / "baselines", fs::path(pattern) / "candidates"};
        fs::create_directories(folders.baselines);
    }
    void TearDown() override
    {
        if (HasFailure()) return;  // to look at the page
        fs::remove_all(folders.baselines.parent_path());
    }

    void accept(const Image& image, const std::string& name)
    {
        std::ofstream(folders.baselines / (name + ".png"), std::ios::binary)
            << render::png_bytes(image);
    }
    std::string message(const Image& image, const std::string& name)
    {
        const auto result = test::matches_baseline(image, name, 0.98, folders);
        return result ? "" : result.message();
    }
    fs::path page() const { return folders.candidates / test::page_name; }
    test::XmlTree tree() const
    {
        std::ifstream file(page(), std::ios::binary);
        std::ostringstream text;
        text << file.rdbuf();
        std::string content = text.str();
        content.erase(0, content.find('\n') + 1);  // the document type
        test::XmlTree result = test::read_xml(content);
        EXPECT_FALSE(result.elements.empty()) << "not well-formed";
        return result;
    }
    /// The pictures in the page by their texts.
    std::map<std::string, Image> pictures() const
    {
        std::map<std::string, Image> result;
        for (const test::XmlElement& image : tree().named("img")) {
            const std::string source = image.attribute("src"), head = "data:image/png;base64,";
            EXPECT_EQ(source.rfind(head, 0), 0u);
            const fs::path file = folders.candidates / "decoded.png";
            std::ofstream(file, std::ios::binary) << decoded(source.substr(head.size()));
            result[image.attribute("alt")] = render::read_png(file);
        }
        return result;
    }
    static std::string decoded(const std::string& text)
    {
        const std::string letters =
            "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
        std::string bytes;
        unsigned bits = 0;
        int count = 0;
        for (char c : text) {
            if (c == '=') break;
            bits = bits << 6 | static_cast<unsigned>(letters.find(c));
            count += 6;
            if (count < 8) continue;
            count -= 8;
            bytes += static_cast<char>(bits >> count & 255);
        }
        return bytes;
    }

    test::PictureFolders folders;
};

bool contains(const std::string& text, const std::string& part)
{
    return text.find(part) != std::string::npos;
}

}

TEST_F(DifferencePage, ShowsBaselineDrawnAndDifferenceOfAChangedPicture)
{
    render::Plot plot = test::linear_plot();
    const Image before = render::render_plot(plot);
    for (double& y : plot.series[0].y) y *= 1.1;
    const Image after = render::render_plot(plot);
    accept(before, "curve");
    const std::string said = message(after, "curve");
    EXPECT_TRUE(contains(said, "curve: similarity 0.")) << said;
    EXPECT_TRUE(contains(said, page().string())) << said;

    const std::map<std::string, Image> shown = pictures();
    ASSERT_EQ(shown.size(), 3u);
    EXPECT_EQ(shown.at("curve baseline").rgb, before.rgb);
    EXPECT_EQ(shown.at("curve drawn").rgb, after.rgb);
    const Image& difference = shown.at("curve difference");
    for (int y = 0; y < before.height; ++y)
        for (int x = 0; x < before.width; ++x) {
            const bool same =
                std::equal(before.pixel(x, y), before.pixel(x, y) + 3, after.pixel(x, y));
            const std::uint8_t* p = difference.pixel(x, y);
            ASSERT_EQ(same, p[0] == 255 && p[1] == 255 && p[2] == 255) << x << " " << y;
        }
    const auto cells = tree().named("td");
    ASSERT_EQ(cells.size(), 5u);
    const double score = std::stod(cells[3].text);
    EXPECT_NEAR(score, test::similarity(before, after), 1e-4);
    EXPECT_LT(score, 0.98);
}

TEST_F(DifferencePage, CollectsAllThatFailAndForgetsWhatIsRightAgain)
{
    const Image a = render::render_plot(test::linear_plot()),
                b = render::render_plot(test::log_plot());
    accept(a, "one");
    accept(a, "two");
    EXPECT_EQ(message(a, "one"), "");
    EXPECT_FALSE(fs::exists(page()));
    EXPECT_NE(message(b, "one"), "");
    EXPECT_NE(message(b, "two"), "");
    EXPECT_NE(message(b, "three"), "");  // has no baseline
    EXPECT_EQ(tree().named("tr").size(), 4u);
    EXPECT_EQ(pictures().size(), 7u);
    EXPECT_EQ(message(a, "two"), "");
    EXPECT_EQ(tree().named("tr").size(), 3u);
    accept(b, "one");
    accept(b, "three");
    EXPECT_EQ(message(b, "one"), "");
    EXPECT_EQ(message(b, "three"), "");
    EXPECT_FALSE(fs::exists(page()));
}

TEST_F(DifferencePage, BlankPicturesFailEvenIfTheBaselineIsBlank)
{
    const Image blank(100, 80, {250, 250, 250});
    accept(blank, "blank");
    EXPECT_TRUE(contains(message(blank, "blank"), "blank: only 0.0000 of the pixels"));
    Image line = blank;
    for (int x = 0; x < 100; ++x) line.pixel(x, 40)[0] = 0;
    accept(line, "line");
    EXPECT_EQ(message(line, "line"), "");
}

TEST_F(DifferencePage, OtherSizesAreToldNotCompared)
{
    const Image a = render::render_plot(test::linear_plot());
    accept(render::resized(a, 200, 150), "size");
    EXPECT_TRUE(contains(message(a, "size"), "another size"));
    EXPECT_EQ(pictures().size(), 2u);
}
