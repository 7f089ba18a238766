#include <algorithm>
#include <cmath>
#include <iterator>

#include <fmt/format.h>

#include "core/model/arm_model.hpp"
#include "core/model/kinematics.hpp"
#include "scenarios/gnuplot.hpp"
#include "scenarios/tune_report.hpp"

namespace teleop {

// Only points with a crossing are drawn, which the checker does not see through.
// NOLINTBEGIN(bugprone-unchecked-optional-access)
namespace {

template <typename... Values>
void add(std::string& text, fmt::format_string<Values...> format, Values&&... values) {
  fmt::format_to(std::back_inserter(text), format, std::forward<Values>(values)...);
}

std::string page(const char* file, int width, int height) {
  return fmt::format(
      "set terminal pngcairo rounded size {},{} font \"DejaVu Sans,16\"\nset output \"{}\"\n"
      "set encoding utf8\nset minussign\nset border 3 lw 1.5 lc rgb \"#444444\"\n"
      "set tics out nomirror textcolor rgb \"#222222\"\n",
      width, height, file);
}

std::string_view unit_text(const TuneOptions& options) {
  return options.experiment == "damping" ? "N s/m" : "N/m";
}

std::string title_of(const TuneOptions& options) {
  const bool pair = options.experiment == "teleop";
  return gnuplot_text(options.experiment + ", " +
                      (pair ? options.master + " and " + options.slave : options.device));
}

void add_probes(std::string& script, const TunedPoint& point, bool growing) {
  add(script, "${} << END\n", growing ? "grows" : "dies");
  for (const ProbeResult& p : point.result.probes) {
    const bool rated = p.oscillation && p.oscillation->is_rated() &&
                       (p.verdict == Verdict::grows || p.verdict == Verdict::decays);
    if (!rated || (p.verdict == Verdict::grows) != growing) continue;
    add(script, "{:.8g} {:.6g} {:.6g}\n", p.plan.gain, p.oscillation->growth_per_s,
        1.645 * p.oscillation->growth_std_per_s);
  }
  add(script, "END\n");
}

}  // namespace

std::string search_picture(const TuneOptions& options, const TunedPoint& point) {
  const Crossing c = point.result.crossing.value();
  std::string script = page("search.png", 1500, 720);
  add_probes(script, point, true);
  add_probes(script, point, false);
  const std::string unit{unit_text(options)};
  add(script, "set style line 1 lc rgb \"#d55e00\" pt 7 ps 1.4 lw 2\n");
  add(script, "set style line 2 lc rgb \"#0072b2\" pt 7 ps 1.4 lw 2\n");
  add(script, "set multiplot layout 1,2 title \"{}, axis {}: {:.5g} {} at {:.3g} Hz\"\n",
      title_of(options), axis_name(point.job.axis), c.gain, unit, point.result.frequency_Hz);
  add(script,
      "set xlabel \"gain ({})\"\nset ylabel \"growth rate (1/s)\"\nset grid lc rgb "
      "\"#dddddd\"\nset xzeroaxis lw 2 lc rgb \"#666666\"\nset key bottom right\n",
      unit);
  const auto draw = [&](bool near) {
    add(script,
        "unset object\nset object 1 rectangle from {:.8g}, graph 0 to {:.8g}, graph 1 "
        "fillcolor rgb \"#009e73\" fillstyle solid 0.25 noborder behind\n",
        c.low, c.high);
    const char* line = near ? ", f(x) lw 2 lc rgb \"#009e73\" title \"fit\"" : "";
    // An empty block is an error to gnuplot, a point outside the page is not.
    add(script,
        "plot $dies using 1:2:3 with yerrorbars ls 2 title \"dies\", $grows using 1:2:3 "
        "with yerrorbars ls 1 title \"grows\"{}\n",
        line);
  };
  add(script, "set title \"every probe with an oscillation\"\nset logscale x\n");
  draw(false);
  add(script, "unset logscale x\nf(x) = {:.8g} * log(x / {:.8g})\n", c.slope_per_s, c.gain);
  add(script,
      "set title \"about the crossing; the band is its 90 % interval\"\nset xrange "
      "[{:.8g}:{:.8g}]\nset yrange [{:.6g}:{:.6g}]\n",
      c.gain * 0.92, c.gain * 1.08, -0.1 * c.slope_per_s, 0.1 * c.slope_per_s);
  draw(true);
  add(script, "unset multiplot\n");
  return script;
}

std::string workspace_gains_picture(const TuneOptions& options,
                                    const std::vector<TunedPoint>& points,
                                    const std::vector<Vector3>& outline) {
  const ArmModel model = load_arm("phantom-1.5");
  const std::size_t worst = worst_of(points);
  std::string script = page("gains.png", 1050, 1000);
  add(script, "$points << END\n");
  for (const TunedPoint& p : points) {
    if (!p.result.crossing) continue;
    const Vector3 at = tool_position(model, p.job.q);
    add(script, "{:.3f} {:.3f} {:.6g}\n", 1e3 * at.z(), 1e3 * at.y(), p.result.crossing->gain);
  }
  add(script, "END\n$outline << END\n");
  for (const Vector3& p : outline) {
    add(script, "{:.3f} {:.3f}\n", 1e3 * p.z(), 1e3 * p.y());
  }
  add(script, "END\n");
  const Vector3 at = tool_position(model, points[worst].job.q);
  add(script,
      "set size ratio -1\nset xlabel \"z (mm), towards the user\"\nset ylabel \"y (mm), up\"\n"
      "set title \"{}, axis {}: gain of marginal stability\"\n"
      "set cblabel \"{}\"\nset palette defined (0 \"#d55e00\", 0.5 \"#f0e442\", 1 \"#0072b2\")\n"
      "unset key\nset xtics 100\nset ytics 100\n",
      title_of(options), gnuplot_text(options.axis), unit_text(options));
  add(script, "set label 1 \"worst: {:.4g}\" at {:.2f},{:.2f} left offset 2.0,-1.4 front\n",
      points[worst].result.crossing->gain, 1e3 * at.z(), 1e3 * at.y());
  add(script,
      "plot $outline with lines lw 3 lc rgb \"#222222\", $points using 1:2:3 with points pt 7 "
      "ps 4 lc palette, $points using 1:2:(sprintf(\"%.0f\", $3)) with labels font \",11\" "
      "offset 0,1.5, \"+\" every ::0::0 using ({:.2f}):({:.2f}) with points pt 6 ps 6 lw 3 lc "
      "rgb \"#222222\"\n",
      1e3 * at.z(), 1e3 * at.y());
  return script;
}

std::string kb_picture(const TuneOptions& options,
                       const std::vector<TunedPoint>& points,
                       const std::vector<std::pair<double, double>>& theory) {
  std::string script = page("kb.png", 1100, 800);
  add(script, "$found << END\n");
  for (const TunedPoint& p : points) {
    if (!p.result.crossing) continue;
    add(script, "{:.6g} {:.6g} {:.6g} {:.6g}\n", p.job.damping_Ns_per_m, p.result.crossing->gain,
        p.result.crossing->low, p.result.crossing->high);
  }
  add(script, "END\n$theory << END\n");
  for (const auto& [B, K] : theory) {
    add(script, "{:.6g} {:.6g}\n", B, K);
  }
  add(script,
      "END\nset title \"{}, axis {}: largest stable stiffness over damping\"\n"
      "set xlabel \"virtual damping B (N s/m)\"\nset ylabel \"virtual stiffness K (N/m)\"\n"
      "set yrange [0:*]\nset grid lc rgb \"#dddddd\"\nset key top left\n",
      title_of(options), gnuplot_text(options.axis));
  add(script, "plot ");
  if (!theory.empty()) {
    add(script,
        "$theory using 1:2 with lines lw 3 lc rgb \"#0072b2\" title \"theory: rigid arm with "
        "its friction\", ");
  }
  add(script,
      "$found using 1:2:3:4 with yerrorbars pt 7 ps 1.8 lw 2 lc rgb \"#d55e00\" title "
      "\"measured, 90 % interval\"\n");
  return script;
}

// NOLINTEND(bugprone-unchecked-optional-access)

}  // namespace teleop
