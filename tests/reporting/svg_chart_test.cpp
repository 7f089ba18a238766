#include "core/reporting/svg_chart.hpp"

#include <limits>

#include <gtest/gtest.h>

namespace teleop {
namespace {

std::size_t count(const std::string& text, const std::string& what) {
  std::size_t times = 0;
  for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + 1)) {
    ++times;
  }
  return times;
}

TEST(RoundTicks, AreRoundAndWithinTheEnds) {
  const std::vector<double> ticks = round_ticks(0.0, 1.0, 5);
  ASSERT_EQ(ticks.size(), 6U);
  for (std::size_t i = 0; i < ticks.size(); ++i) {
    EXPECT_NEAR(ticks[i], 0.2 * static_cast<double>(i), 1e-12);
  }
  EXPECT_TRUE(round_ticks(1.0, 1.0, 5).empty());
  for (const double tick : round_ticks(-0.37, 0.92, 6)) {
    EXPECT_GE(tick, -0.37);
    EXPECT_LE(tick, 0.92);
  }
}

TEST(SvgPlot, LiftsThePenWhereThereIsNoNumber) {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  SvgPlot plot{.x_label = "t", .y_label = "y"};
  plot.lines.push_back({.color = "x", .x = {0, 1, 2, 3, 4}, .y = {0, 1, kNone, 1, 0}});
  const std::string svg = svg_of(plot);
  const std::string path = svg.substr(svg.find("class=\"curve"));
  EXPECT_EQ(count(path, "M"), 2U) << path;
  EXPECT_EQ(svg.find("nan"), std::string::npos);
}

TEST(SvgPlot, EscapesWhatItIsNamed) {
  SvgPlot plot{.x_label = "a<b"};
  plot.lines.push_back({.label = "<script>", .color = "x", .x = {0, 1}, .y = {0, 1}});
  EXPECT_EQ(svg_of(plot).find("<script"), std::string::npos);
}

TEST(SvgPlot, OfNothingSaysSo) {
  EXPECT_NE(svg_of(SvgPlot{}).find("Nothing to draw"), std::string::npos);
}

TEST(SvgMap, DrawsCellsThatArePresentAndPalerWhereNotSure) {
  SvgMap map{.columns = 3, .rows = 1, .scale = 2.0};
  map.cells = {{.value = 2.0, .present = true, .sure = true},
               {.value = -2.0, .present = true, .sure = false},
               {.value = 1.0}};
  const std::string svg = svg_of(map);
  EXPECT_EQ(count(svg, "class=\"cell\""), 2U);
  EXPECT_EQ(count(svg, "var(--plus)"), 1U);
  EXPECT_NE(svg.find("var(--minus)\" fill-opacity=\"0.45\""), std::string::npos);
}

}  // namespace
}  // namespace teleop
