#include "scenarios/velocity_picture.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <numeric>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "scenarios/gnuplot.hpp"

namespace teleop {
namespace {

constexpr double kMilli = 1000.0;  // m to mm, s to ms
constexpr double kStretch_s = 0.4;
constexpr double kSlow_m_per_s = 0.006;
constexpr double kLeastLag_ms = 0.1;  // of the logarithmic axis

// Okabe and Ito: told apart by every eye.
constexpr std::array<std::string_view, 7> kColours{"#b8b8b8", "#0072b2", "#d55e00", "#009e73",
                                                   "#cc79a7", "#56b4e9", "#e69f00"};

std::string_view colour(std::size_t row) { return kColours.at(row % kColours.size()); }

template <typename... Values>
void add(std::string& text, fmt::format_string<Values...> format, Values&&... values) {
  fmt::format_to(std::back_inserter(text), format, std::forward<Values>(values)...);
}

/// Samples first … end − 1 of the first trace, along the axis that moves most.
struct Stretch {
  std::size_t first = 0;
  std::size_t end = 0;
  Eigen::Index axis = 0;
};

/// The stretch for which `merit` of mean square speed is largest.
template <class Merit>
Stretch find_stretch(const VelocityTrace& trace, Merit&& merit) {
  const double dt =
      (trace.time_s.back() - trace.time_s.front()) / static_cast<double>(trace.time_s.size() - 1);
  const std::size_t length =
      std::min(static_cast<std::size_t>(kStretch_s / dt), trace.v.size() / 2);
  const auto begin = static_cast<std::size_t>(trace.skip_s / dt);
  Stretch best{.first = begin, .end = begin + length};
  double most = -1e300;
  for (std::size_t first = begin; first + length < trace.v.size(); first += length / 8 + 1) {
    Vector3 square = Vector3::Zero();
    for (std::size_t k = first; k < first + length; ++k) {
      square += trace.v[k].cwiseAbs2() / static_cast<double>(length);
    }
    const double here = merit(square.sum());
    if (here <= most) continue;
    most = here;
    best = {.first = first, .end = first + length};
    square.maxCoeff(&best.axis);
  }
  return best;
}

void add_stretch_data(std::string& text,
                      std::string_view name,
                      const VelocityStudy& study,
                      const Stretch& stretch) {
  const VelocityTrace& trace = study.source.traces.front();
  add(text, "${} << END\n", name);
  for (std::size_t k = stretch.first; k < stretch.end; ++k) {
    add(text, "{:.3f} {:.4f}", trace.time_s[k], kMilli * trace.v[k][stretch.axis]);
    for (const VelocityRow& row : study.rows) {
      add(text, " {:.4f}", kMilli * row.estimates.front()[k][stretch.axis]);
    }
    text += '\n';
  }
  text += "END\n";
}

/// Rows in two groups, the noisier ones first: in one picture they would hide the others.
std::array<std::vector<std::size_t>, 2> by_noise(const VelocityStudy& study) {
  std::vector<std::size_t> order(study.rows.size());
  std::iota(order.begin(), order.end(), 0U);
  const auto noise = [&](std::size_t i) {
    return study.rows[i].score.noise_m_per_s;
  };
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return noise(a) > noise(b); });
  const auto middle = order.begin() + static_cast<std::ptrdiff_t>(order.size() / 2);
  return {std::vector<std::size_t>{order.begin(), middle},
          std::vector<std::size_t>{middle, order.end()}};
}

void add_stretch_plot(std::string& text,
                      std::string_view name,
                      const VelocityStudy& study,
                      const std::vector<std::size_t>& rows) {
  text += "plot ";
  for (const std::size_t i : rows) {
    add(text, "${} using 1:{} with steps lw 1.8 lc rgb '{}' title \"{}\", \\\n", name, i + 3,
        colour(i), gnuplot_text(study.rows[i].name));
  }
  add(text, "  ${} using 1:2 with lines lw 3 dt (8,4) lc rgb 'black' title '{}'\n", name,
      study.source.has_truth ? "truth" : "zero-phase reference");
}

/// The lowest and highest reference of a stretch with room for an estimate's errors, mm/s.
std::pair<double, double> range_of(const VelocityTrace& trace,
                                   const Stretch& stretch,
                                   double room) {
  double low = 1e300;
  double high = -1e300;
  for (std::size_t k = stretch.first; k < stretch.end; ++k) {
    low = std::min(low, kMilli * trace.v[k][stretch.axis]);
    high = std::max(high, kMilli * trace.v[k][stretch.axis]);
  }
  return {low - room, high + room};
}

std::string stretches(const VelocityStudy& study) {
  const VelocityTrace& trace = study.source.traces.front();
  const Stretch fast = find_stretch(trace, [](double square) { return square; });
  const Stretch slow = find_stretch(trace, [](double square) {
    return -std::abs(std::log((square + 1e-12) / (kSlow_m_per_s * kSlow_m_per_s)));
  });
  constexpr std::string_view kAxes = "xyz";
  std::string text;
  add_stretch_data(text, "fast", study, fast);
  add_stretch_data(text, "slow", study, slow);
  text += R"(set terminal pngcairo rounded size 2000,1500 font "DejaVu Sans,19"
set output "velocity-stretch.png"
set grid lc rgb '#e0e0e0' lt 1
set border 3
set tics nomirror
set xlabel 'time, s' offset 0,0.4
set xtics 0.1
set key below center samplen 2
set multiplot layout 2,2
)";
  const auto groups = by_noise(study);
  const auto add_row = [&](std::string_view name, const Stretch& stretch, double room) {
    const auto [low, high] = range_of(trace, stretch, room);
    add(text, "set ylabel \"tool velocity along {}, mm/s\"\nset yrange [{:.1f}:{:.1f}]\n",
        kAxes[static_cast<std::size_t>(stretch.axis)], low, high);
    add(text, "set xrange [{}:{}]\n", trace.time_s[stretch.first], trace.time_s[stretch.end - 1]);
    for (const auto& group : groups) {
      add_stretch_plot(text, name, study, group);
    }
  };
  add_row("fast", fast, 40.0);
  add_row("slow", slow, 22.0);
  text += "unset multiplot\n";
  return text;
}

std::string errors(const VelocityStudy& study) {
  std::string text = R"(set terminal pngcairo rounded size 1800,1000 font "DejaVu Sans,20"
set output "velocity-error.png"
set grid ytics lc rgb '#e0e0e0' lt 1
set border 3
set tics nomirror
set logscale y
set ylabel 'error of the tool velocity, mm/s'
set xlabel 'speed of the tool'
set key outside right center Left reverse samplen 1 spacing 1.3
set xrange [-0.5:3.5]
set xtics ('below 5 mm/s' 0, '5 to 20' 1, '20 to 100' 2, 'above 100 mm/s' 3)
set title 'Bars: RMS error; marks: worst error'
)";
  const double width = 0.8 / static_cast<double>(study.rows.size());
  add(text, "set boxwidth {:.4f}\nset style fill solid\n", 0.9 * width);
  for (std::size_t i = 0; i < study.rows.size(); ++i) {
    add(text, "$e{} << END\n", i);
    for (std::size_t c = 0; c < study.rows[i].score.classes.size(); ++c) {
      const SpeedClass& of = study.rows[i].score.classes.at(c);
      if (of.samples == 0) continue;
      add(text, "{:.4f} {:.5f} {:.5f}\n",
          static_cast<double>(c) - 0.4 + (static_cast<double>(i) + 0.5) * width,
          kMilli * of.rms_m_per_s, kMilli * of.worst_m_per_s);
    }
    text += "END\n";
  }
  text += "plot ";
  for (std::size_t i = 0; i < study.rows.size(); ++i) {
    add(text,
        "{}$e{} using 1:2 with boxes lc rgb '{}' title \"{}\", \\\n  $e{} using 1:3 with points pt "
        "7 "
        "ps 1.6 lc rgb '{}' notitle",
        i == 0 ? "" : ", \\\n  ", i, colour(i), gnuplot_text(study.rows[i].name), i, colour(i));
  }
  return text + '\n';
}

std::string least_damping(const VelocityRow& row) {
  double least = 1e300;
  for (const auto& limit : row.limits) {
    if (limit) least = std::min(least, limit->damping_Ns_per_m);
  }
  return least < 1e300 ? fmt::format("{:.3g} N s/m", least) : "no limit";
}

/// Where a point is drawn, in decades.
Eigen::Vector2d place(const VelocityRow& row) {
  return {std::log10(std::max(kMilli * row.score.lag_s, kLeastLag_ms)),
          std::log10(std::max(kMilli * row.score.noise_m_per_s, 1e-3))};
}

/// A point whose right-hand neighbour is near has its label on the left.
bool is_crowded(const VelocityStudy& study, std::size_t i) {
  const Eigen::Vector2d own = place(study.rows[i]);
  return std::any_of(study.rows.begin(), study.rows.end(), [&](const VelocityRow& other) {
    const Eigen::Vector2d off = place(other) - own;
    return off.x() > 0.0 && off.x() < 0.5 && std::abs(off.y()) < 0.2;
  });
}

std::string scatter(const VelocityStudy& study) {
  std::string text = R"(set terminal pngcairo rounded size 1500,1000 font "DejaVu Sans,20"
set output "velocity-lag-noise.png"
set grid lc rgb '#e0e0e0' lt 1
set border 3
set tics nomirror
set logscale xy
set xlabel 'lag, ms'
set title 'Lag, noise, and the largest damping that each allows along its worst axis'
unset key
)";
  add(text, "set xrange [{}:200]\n", 0.7 * kLeastLag_ms);
  add(text, "set ylabel 'noise above {:g} Hz, mm/s'\n", study.rows.front().score.noise_above_Hz);
  double low = 1e300;
  double high = 0.0;
  for (std::size_t i = 0; i < study.rows.size(); ++i) {
    const VelocityRow& row = study.rows[i];
    const double lag = kMilli * row.score.lag_s;
    const double noise = std::max(kMilli * row.score.noise_m_per_s, 1e-3);
    low = std::min(low, noise);
    high = std::max(high, noise);
    add(text, "$p{} << END\n{:.4f} {:.5f}\nEND\n", i, std::max(lag, kLeastLag_ms), noise);
    add(text,
        "set label \"{}\\n{}{}\" at {:.4f},{:.5f} {} front font ',17' tc rgb "
        "'#303030'\n",
        gnuplot_text(row.name), least_damping(row),
        lag < kLeastLag_ms ? fmt::format(", lag {:.2f} ms", lag) : "", std::max(lag, kLeastLag_ms),
        noise, is_crowded(study, i) ? "right offset -1.2,0.4" : "left offset 1.2,0.4");
  }
  add(text, "set yrange [{}:{}]\nplot ", low / 1.6, high * 1.8);
  for (std::size_t i = 0; i < study.rows.size(); ++i) {
    add(text, "{}$p{} with points pt 7 ps 3 lc rgb '{}'", i == 0 ? "" : ", ", i, colour(i));
  }
  return text + '\n';
}

}  // namespace

std::vector<VelocityPicture> velocity_pictures(const VelocityStudy& study) {
  return {{.name = "velocity-stretch", .script = stretches(study)},
          {.name = "velocity-error", .script = errors(study)},
          {.name = "velocity-lag-noise", .script = scatter(study)}};
}

}  // namespace teleop
