#include "scenarios/frequency_response_picture.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <numbers>
#include <string_view>

#include <fmt/format.h>

#include "scenarios/gnuplot.hpp"

namespace teleop {
namespace {

constexpr double kDegrees = 180.0 / std::numbers::pi;
constexpr double kNormal95 = 1.6449;
constexpr double kMillimetres = 1000.0;

/// 0 to −360°, so that a mass with delay does not jump between −180° and 180°.
double phase_deg(std::complex<double> gain) {
  const double phase = std::arg(gain) * kDegrees;
  return phase > 90.0 ? phase - 360.0 : phase;
}

constexpr std::string_view kStyle = R"(set encoding utf8
set minussign
set multiplot
set border 3 lw 1.5 lc rgb "#444444"
set tics out nomirror textcolor rgb "#222222"
set grid xtics ytics mxtics lc rgb "#e4e4e4" lw 1, lc rgb "#f2f2f2" lw 1
set logscale x
set lmargin at screen 0.105
set rmargin at screen 0.985
)";

constexpr std::string_view kGain = R"gp(set tmargin at screen 0.93
set bmargin at screen 0.42
set logscale y
set format y "10^{%T}"
set format x ""
set ylabel "gain (mm/N)" offset 0.5
set key top right reverse Left samplen 2 spacing 1.15
)gp";

constexpr std::string_view kPhase = R"gp(unset title
set tmargin at screen 0.38
set bmargin at screen 0.10
unset logscale y
set format x "%g"
set format y "%g"
set ylabel "phase (°)"
set xlabel "frequency (Hz)"
set yrange [-370:100]
set ytics -360,90,90
unset key
)gp";

constexpr std::array<std::string_view, 4> kLines{
    "lw 4 lc rgb \"#c0561a\"", "lw 3 lc rgb \"#2b6cb0\" dashtype (12,6)",
    "lw 2.5 lc rgb \"#2f855a\" dashtype (3,4)", "lw 2.5 lc rgb \"#6b46c1\" dashtype (8,4,2,4)"};

std::string data(const FrequencyResponse& response) {
  std::string text = "$lines << END\n";
  for (const ResponseLine& line : response.lines) {
    const double size = std::abs(line.gain);
    const double half = kNormal95 / std::numbers::sqrt2 * line.deviation;  // of one component
    const double phase = phase_deg(line.gain);
    const double turn = std::min(180.0, kDegrees * half / size);
    fmt::format_to(
        std::back_inserter(text), "{:g} {:g} {:g} {:g} {:g} {:g} {:g} {} {}\n", line.f_Hz,
        kMillimetres * size, kMillimetres * std::max(size - half, 0.05 * size),
        kMillimetres * (size + half), phase, phase - turn, phase + turn,
        kMillimetres * line.deviation,
        line.distortion > 0.0 ? fmt::format("{:g}", kMillimetres * size * line.distortion) : "NaN");
  }
  return text + "END\n";
}

std::string data(const std::vector<FittedCurve>& fits) {
  std::string text;
  for (std::size_t i = 0; i < fits.size(); ++i) {
    fmt::format_to(std::back_inserter(text), "$fit{} << END\n", i);
    for (Eigen::Index k = 0; k < fits[i].gain.size(); ++k) {
      fmt::format_to(std::back_inserter(text), "{:g} {:g} {:g}\n", fits[i].frequency_Hz(k),
                     kMillimetres * std::abs(fits[i].gain(k)), phase_deg(fits[i].gain(k)));
    }
    text += "END\n";
  }
  return text;
}

/// Room for everything that is drawn, and no more.
std::string gain_range(const FrequencyResponse& response) {
  double low = std::abs(response.lines.front().gain);
  double high = low;
  for (const ResponseLine& line : response.lines) {
    low = std::min({low, std::abs(line.gain), line.deviation});
    high = std::max(high, std::abs(line.gain));
  }
  return fmt::format("set yrange [{:g}:{:g}]\n", 0.5 * kMillimetres * low,
                     2.0 * kMillimetres * high);
}

}  // namespace

std::string frequency_response_picture(const std::string& title,
                                       const std::string& png,
                                       const FrequencyResponse& response,
                                       const std::vector<FittedCurve>& fits) {
  std::string script = fmt::format(
      "set terminal pngcairo rounded size 1500,1250 font \"DejaVu Sans,19\"\nset output \"{}\"\n",
      gnuplot_text(png));
  script += kStyle;
  fmt::format_to(std::back_inserter(script), "set xrange [{:g}:{:g}]\n",
                 0.85 * response.lines.front().f_Hz, 1.1 * response.lines.back().f_Hz);
  script += data(response);
  script += data(fits);
  fmt::format_to(std::back_inserter(script), "set title \"{}\" noenhanced\n", gnuplot_text(title));
  script += kGain;
  script += gain_range(response);
  script +=
      "plot $lines using 1:2:3:4 with yerrorbars pt 7 ps 0.9 lw 1.5 lc rgb \"#333333\" title "
      "\"measured, 90 %\"";
  for (std::size_t i = 0; i < fits.size(); ++i) {
    fmt::format_to(std::back_inserter(script), ", $fit{} using 1:2 with lines {} title \"{}\"", i,
                   kLines.at(i % kLines.size()), gnuplot_text(fits[i].name));
  }
  script +=
      ", $lines using 1:8 with lines lw 2 lc rgb \"#999999\" title \"uncertainty\""
      ", $lines using 1:9 with points pt 2 ps 0.9 lw 1.5 lc rgb \"#d53f8c\" title \"distortion\"\n";
  script += kPhase;
  script +=
      "plot $lines using 1:5:6:7 with yerrorbars pt 7 ps 0.9 lw 1.5 lc rgb \"#333333\" notitle";
  for (std::size_t i = 0; i < fits.size(); ++i) {
    fmt::format_to(std::back_inserter(script), ", $fit{} using 1:3 with lines {} notitle", i,
                   kLines.at(i % kLines.size()));
  }
  return script + "\nunset multiplot\n";
}

}  // namespace teleop
