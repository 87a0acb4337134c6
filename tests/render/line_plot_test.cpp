// tests/render/line_plot_test.cpp -- geometry of plots, read back from their SVG form.
#include "render/line_plot.h"

#include "engine/error.h"
#include "render/colour_map.h"
#include "tests/render/scenes.h"
#include "tests/render/svg_reader.h"
#include "tests/support/image_compare.h"

#include <gtest/gtest.h>
#include <cmath>

using namespace sigmaflow;
using render::Plot;
using render::Series;
using test::SvgFile;

namespace {

Series line(std::vector<double> x, std::vector<double> y)
{
    Series series;
    series.x = std::move(x);
    series.y = std::move(y);
    return series;
}

Plot plot_of(std::vector<Series> series)
{
    Plot plot;
    plot.width = 800;
    plot.height = 600;
    plot.series = std::move(series);
    return plot;
}

SvgFile drawn(const Plot& plot)
{
    return test::read_svg(render::plot_svg(plot));
}

ErrorKind error_kind(const Plot& plot)
{
    try {
        render::plot_svg(plot);
    } catch (const Error& error) {
        return error.kind();
    }
    return ErrorKind::internal;
}

}

TEST(LinePlot, SvgIsWellFormedEvenWithAwkwardTexts)
{
    Plot plot = plot_of({line({0, 1}, {0, 1})});
    plot.title = "a < b & \"c\" > d";
    plot.series[0].label = "$γ̇$_{0}";
    const SvgFile file = drawn(plot);
    ASSERT_TRUE(file.well_formed);
    EXPECT_NE(file.text("a < b & \"c\" > d"), nullptr);
    EXPECT_NE(file.text("γ̇0"), nullptr);
}

TEST(LinePlot, HasOnePolylinePerUnbrokenLine)
{
    const double gap = std::nan("");
    EXPECT_EQ(drawn(plot_of({line({0, 1, 2}, {0, 1, 0})})).clipped_polylines().size(), 1u);
    EXPECT_EQ(drawn(plot_of({line({0, 1, 2, 3, 4}, {0, 1, gap, 3, 4})})).clipped_polylines().size(),
              2u);
    EXPECT_EQ(
        drawn(plot_of({line({0, 1}, {0, 1}), line({0, 1}, {1, 0})})).clipped_polylines().size(),
        2u);
    Plot bars = plot_of({line({0, 1}, {0, 1})});
    bars.series[0].line = render::Line::none;
    bars.series[0].y_error = {0.1, 0.2};
    EXPECT_EQ(drawn(bars).clipped_polylines().size(), 6u);  // two bars with two caps each
}

TEST(LinePlot, HasTheTextsThatWereAskedFor)
{
    const SvgFile file = drawn(test::linear_plot());
    for (const std::string text :
         {"φ = 0.56", "strain γ", "rate γ̇/γ̇0", "rate", "mean", "start", "0", "2", "10"})
        EXPECT_NE(file.text(text), nullptr) << text;
    const SvgFile log = drawn(test::log_plot());
    for (const std::string text : {"10−1", "1", "10", "102", "series 2"})
        EXPECT_NE(log.text(text), nullptr) << text;
}

TEST(LinePlot, LinearAxesAreAffine)
{
    Plot plot = plot_of({line({0, 1, 3}, {10, 30, 20})});
    const auto lines = drawn(plot).clipped_polylines();
    ASSERT_EQ(lines.size(), 1u);
    const auto& p = lines[0].points;
    ASSERT_EQ(p.size(), 3u);
    EXPECT_NEAR((p[2].x - p[0].x) / (p[1].x - p[0].x), 3, 1e-3);
    EXPECT_NEAR((p[2].y - p[0].y) / (p[1].y - p[0].y), 0.5, 1e-3);
    EXPECT_GT(p[1].x, p[0].x);
    EXPECT_LT(p[1].y, p[0].y);  // larger values are higher up
}

TEST(LinePlot, LogarithmicAxesTurnRatiosIntoDistances)
{
    Plot plot = plot_of({line({0.1, 1, 100}, {5, 50, 500})});
    plot.x.logarithmic = plot.y.logarithmic = true;
    const auto p = drawn(plot).clipped_polylines().at(0).points;
    EXPECT_NEAR((p[2].x - p[1].x) / (p[1].x - p[0].x), 2, 1e-3);
    EXPECT_NEAR((p[2].y - p[1].y) / (p[1].y - p[0].y), 1, 1e-3);
}

TEST(LinePlot, TicksStandAtTheirValues)
{
    Plot plot = plot_of({line({0, 4}, {0, 1})});
    const SvgFile file = drawn(plot);
    const auto p = file.clipped_polylines().at(0).points;
    const render::Rectangle two = file.text("2")->bounds();  // the middle of 0..4
    EXPECT_NEAR((two.left + two.right) / 2, (p[0].x + p[1].x) / 2, 1.5);
}

TEST(LinePlot, AutomaticRangesHoldAllDataAndTheirErrors)
{
    Plot plot = plot_of({line({0, 1, 2}, {3, 9, 4})});
    plot.series[0].y_error = {0, 5, 0};
    plot.series[0].marker = render::Marker::circle;
    const SvgFile file = drawn(plot);
    render::Rectangle frame{};
    for (const auto& element : file.polylines)
        if (element.points.size() == 6) frame = element.bounds();
    ASSERT_GT(frame.width(), 100);
    for (const auto& element : file.clipped_polylines()) {
        EXPECT_GE(element.bounds().top, frame.top);
        EXPECT_LE(element.bounds().bottom, frame.bottom);
    }
}

TEST(LinePlot, LegendStandsWhereThereAreNoData)
{
    // Lines everywhere but in the lower left corner.
    std::vector<Series> lines;
    for (int y = 0; y <= 20; ++y)
        lines.push_back(line({y > 10 ? 0.0 : 5.0, 10}, {0.5 * y, 0.5 * y}));
    Plot plot = plot_of(lines);
    plot.y.minimum = 0;
    plot.y.maximum = 10;
    plot.series[0].label = "the legend";
    const render::Rectangle text = drawn(plot).text("the legend")->bounds();
    EXPECT_LT(text.right, 0.5 * plot.width);
    EXPECT_GT(text.top, 0.5 * plot.height);
    plot.legend = render::Legend::top_right;
    EXPECT_GT(drawn(plot).text("the legend")->bounds().left, 0.5 * plot.width);
    plot.legend = render::Legend::none;
    EXPECT_EQ(drawn(plot).text("the legend"), nullptr);
}

TEST(LinePlot, NoTextIsCutOrLiesOnAnother)
{
    for (const auto& [width, height] :
         {std::pair(1920, 1080), {300, 300}, {1200, 900}, {500, 900}}) {
        for (Plot plot : {test::linear_plot(), test::log_plot()}) {
            SCOPED_TRACE(testing::Message() << width << " x " << height);
            plot.width = width;
            plot.height = height;
            const SvgFile file = drawn(plot);
            for (std::size_t i = 0; i < file.texts.size(); ++i) {
                const render::Rectangle a = file.texts[i].bounds();
                EXPECT_GE(a.left, 0) << file.texts[i].attributes.at("aria-label");
                EXPECT_GE(a.top, 0) << file.texts[i].attributes.at("aria-label");
                EXPECT_LE(a.right, width) << file.texts[i].attributes.at("aria-label");
                EXPECT_LE(a.bottom, height) << file.texts[i].attributes.at("aria-label");
                for (std::size_t j = 0; j < i; ++j) {
                    const render::Rectangle b = file.texts[j].bounds();
                    EXPECT_FALSE(a.left < b.right && b.left < a.right && a.top < b.bottom &&
                                 b.top < a.bottom)
                        << file.texts[i].attributes.at("aria-label") << " and "
                        << file.texts[j].attributes.at("aria-label");
                }
            }
        }
    }
}

TEST(LinePlot, LogarithmicAxesLeaveOutWhatTheyCannotShow)
{
    Plot plot = plot_of({line({-1, 0, 1, 10}, {1, 2, 3, 4})});
    plot.series[0].y_error = {5, 5, 5, 5};  // lower ends below zero
    plot.x.logarithmic = plot.y.logarithmic = true;
    const SvgFile file = drawn(plot);
    ASSERT_TRUE(file.well_formed);
    for (const auto& element : file.clipped_polylines())
        for (const auto& p : element.points) EXPECT_TRUE(std::isfinite(p.x) && std::isfinite(p.y));
    EXPECT_EQ(file.clipped_polylines().at(0).points.size(), 2u);
}

TEST(LinePlot, ThePictureHasTheColoursOfTheSeries)
{
    Plot plot = plot_of({line({0, 1}, {0.5, 0.5})});
    plot.series[0].colour = render::Colour{10, 200, 30};
    plot.series[0].line_width = 12;
    const auto p = drawn(plot).clipped_polylines().at(0).points;
    const render::Image image = render::render_plot(plot);
    const auto* pixel =
        image.pixel(static_cast<int>((p[0].x + p[1].x) / 2), static_cast<int>(p[0].y));
    EXPECT_EQ(int(pixel[0]), 10);
    EXPECT_EQ(int(pixel[1]), 200);
    EXPECT_EQ(int(pixel[2]), 30);
}

namespace {

/// Three columns and two rows between 0 and 3, 0 and 1.
Plot grid_plot(std::vector<double> values)
{
    Plot plot;
    plot.width = 800;
    plot.height = 600;
    plot.x.title = "x";
    plot.grid =
        render::ColourGrid{{0, 1, 2, 3}, {0, 0.5, 1}, std::move(values), "viridis", "label", 0, 1};
    return plot;
}

}

TEST(LinePlot, CellsHaveTheColoursOfTheirValues)
{
    Plot plot = grid_plot({0, 0.5, 1, std::nan(""), 7, -7});
    plot.series.push_back(line({0.5, 1.5, 2.5}, {0.25, 0.25, 0.25}));  // where the lower cells are
    plot.series.push_back(line({0.5, 1.5, 2.5}, {0.75, 0.75, 0.75}));
    const auto lines = drawn(plot).clipped_polylines();
    ASSERT_EQ(lines.size(), 2u);
    plot.series.clear();
    const render::Image image = render::render_plot(plot);
    const double shares[] = {0, 0.5, 1, std::nan(""), 1, 0};
    for (std::size_t cell = 0; cell < 6; ++cell) {
        const render::Point p = lines[cell / 3].points[cell % 3];
        const auto* pixel = image.pixel(static_cast<int>(p.x), static_cast<int>(p.y));
        const render::Colour expected = render::map_colour("viridis", shares[cell]);
        for (int c = 0; c < 3; ++c) EXPECT_EQ(int(pixel[c]), expected[c]) << cell;
    }
}

TEST(LinePlot, CellsFillTheFrameAndTheBarStandsBesideIt)
{
    const SvgFile file = drawn(grid_plot({0, 0.5, 1, 0, 0.5, 7}));
    ASSERT_TRUE(file.well_formed);
    render::Rectangle frame{};
    for (const auto& element : file.polylines)
        if (element.points.size() == 6) frame = element.bounds();
    EXPECT_GT(file.text("label")->bounds().left, frame.right);
    EXPECT_LT(file.text("label")->bounds().right, 800);
    EXPECT_NE(file.text("≥ 1.0"), nullptr);  // some value lies above the colours
    EXPECT_EQ(file.text("≤ 0.0"), nullptr);
    EXPECT_NE(file.text("3.0"), nullptr);  // the axes begin and end with the cells
}

TEST(LinePlot, EqualNeighbouringCellsAreOneShape)
{
    const auto areas = [](std::vector<double> values) {
        return drawn(grid_plot(std::move(values))).areas.size();
    };
    EXPECT_EQ(areas({0, 1, 0, 1, 0, 1}) - areas({0, 0, 0, 1, 1, 1}), 4u);
}

TEST(LinePlot, IsDrawnWithoutAnyData)
{
    Plot plot;
    EXPECT_TRUE(drawn(plot).well_formed);
    plot.x.logarithmic = plot.y.logarithmic = true;
    EXPECT_TRUE(drawn(plot).well_formed);
    plot.series.push_back(line({std::nan("")}, {std::nan("")}));
    EXPECT_TRUE(drawn(plot).well_formed);
}

TEST(LinePlot, RefusesWrongInput)
{
    Plot plot = plot_of({line({0, 1, 2}, {0, 1})});
    EXPECT_EQ(error_kind(plot), ErrorKind::input);
    plot = plot_of({line({0, 1}, {0, 1})});
    plot.series[0].x_error = {1};
    EXPECT_EQ(error_kind(plot), ErrorKind::input);
    plot = plot_of({line({0, 1}, {0, 1})});
    plot.bands.push_back({"", {0, 1}, {0}, {1, 1}, {}});
    EXPECT_EQ(error_kind(plot), ErrorKind::input);
    plot = plot_of({line({0, 1}, {0, 1})});
    plot.x.minimum = 2;
    plot.x.maximum = 1;
    EXPECT_EQ(error_kind(plot), ErrorKind::input);
    plot = plot_of({line({0, 1}, {0, 1})});
    plot.y.logarithmic = true;
    plot.y.minimum = 0;
    EXPECT_EQ(error_kind(plot), ErrorKind::input);
    plot = plot_of({line({0, 1}, {0, 1})});
    plot.width = 1;
    EXPECT_EQ(error_kind(plot), ErrorKind::input);
    EXPECT_EQ(error_kind(grid_plot({1, 2, 3})), ErrorKind::input);
    plot = grid_plot(std::vector<double>(6));
    plot.grid->x = {0, 2, 1, 3};
    EXPECT_EQ(error_kind(plot), ErrorKind::input);
    plot = grid_plot(std::vector<double>(6));
    plot.grid->maximum = 0;
    EXPECT_EQ(error_kind(plot), ErrorKind::input);
}

TEST(LinePlot, LinearPlotLooksLikeTheBaseline)
{
    // Drawn without any graphics driver: only the fonts could differ.
    EXPECT_TRUE(
        test::matches_baseline(render::render_plot(test::linear_plot()), "plot_linear", 0.98));
}

TEST(LinePlot, LogPlotLooksLikeTheBaseline)
{
    EXPECT_TRUE(test::matches_baseline(render::render_plot(test::log_plot()), "plot_log", 0.98));
}
