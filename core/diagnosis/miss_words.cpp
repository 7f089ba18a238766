#include "core/diagnosis/miss_words.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "core/effects/effect_words.hpp"

namespace teleop {
namespace {

/// Mean excess of the whitened innovations' power over all runs.
double excess_of(const std::vector<double>& power, const std::vector<double>& floor) {
  double sum = 0.0;
  for (std::size_t run = 0; run < power.size(); ++run) {
    sum += power[run] - floor[run];
  }
  return sum / static_cast<double>(std::max<std::size_t>(power.size(), 1));
}

/// Powers below which nothing is said: a share of the noise's own.
constexpr double kWorthMention = 0.005;

std::string axes_text(const std::vector<double>& excess) {
  constexpr double kShare = 0.2;  // of the largest
  const double most = *std::max_element(excess.begin(), excess.end());
  std::vector<std::size_t> axes;
  for (std::size_t i = 0; i < excess.size(); ++i) {
    if (excess[i] > std::max(kShare * most, kWorthMention)) axes.push_back(i + 1);
  }
  if (axes.size() == 1) return fmt::format("axis {}", axes.front());
  if (axes.size() == 2) return fmt::format("axes {} and {}", axes[0], axes[1]);
  return "all axes";
}

/// +1 where the torque rises with the quantity, −1 where it falls, 0 where it does neither.
int slope_sign(const MissingProfile& of) {
  const double x = std::accumulate(of.middles.begin(), of.middles.end(), 0.0) /
                   static_cast<double>(of.middles.size());
  double xy = 0.0;
  double xx = 0.0;
  double yy = 0.0;
  double mean = 0.0;
  for (const MissingMean& each : of.means) {
    mean += each.mean / static_cast<double>(of.means.size());
  }
  for (std::size_t i = 0; i < of.means.size(); ++i) {
    const double dx = of.middles[i] - x;
    const double dy = of.means[i].mean - mean;
    xy += dx * dy;
    xx += dx * dx;
    yy += dy * dy;
  }
  constexpr double kStraight = 0.8;
  const double correlation = xy / std::sqrt(std::max(xx * yy, 1e-300));
  return std::abs(correlation) < kStraight ? 0 : (correlation > 0.0 ? 1 : -1);
}

/// "between 0.1 and 0.4 rad", where most of what follows an angle is at few of them.
std::optional<std::string> region_of(const MissingProfile& angle) {
  double most = 0.0;
  for (const MissingMean& each : angle.means) {
    most = std::max(most, std::abs(each.mean));
  }
  std::optional<std::size_t> first;
  std::size_t last = 0;
  std::size_t inside = 0;
  for (std::size_t i = 0; i < angle.means.size(); ++i) {
    if (std::abs(angle.means[i].mean) < 0.4 * most) continue;
    if (!first) first = i;
    last = i;
    ++inside;
  }
  const bool narrow = first && last - *first + 1 == inside && inside <= angle.means.size() / 3;
  if (!narrow) return std::nullopt;
  const double low = angle.middles[*first > 0 ? *first - 1 : 0];
  const double high = angle.middles[std::min(last + 1, angle.middles.size() - 1)];
  return fmt::format("between {:.2f} and {:.2f} rad", low, high);
}

std::string direction_text(const AxisMiss& miss) {
  const std::string against =
      miss.slow + miss.fast > 0.0 ? "against the direction of motion" : "along the motion";
  const double ratio = miss.fast / (miss.slow == 0.0 ? 1e-12 : miss.slow);
  if (ratio > 0.7 && ratio < 1.4) return against + " at every speed";
  return against + (ratio > 1.0 || ratio < 0.0 ? ", more the faster" : ", more the slower");
}

/// What the missing torque of an axis goes with.
std::string pattern_of(const AxisMiss& miss) {
  constexpr double kFollows = 0.25;  // share of the variance
  const double spread =
      std::sqrt(std::max(0.0, miss.torque * miss.torque - miss.mean.mean * miss.mean.mean));
  if (miss.mean.significant() && std::abs(miss.mean.mean) > spread) {
    return fmt::format("a constant push in {} direction",
                       miss.mean.mean > 0.0 ? "positive" : "negative");
  }
  const MissingProfile* best = &miss.profiles.front();
  for (const MissingProfile& each : miss.profiles) {
    if (each.share > 1.05 * best->share) best = &each;
  }
  if (best->share < kFollows) return "with no single quantity";
  if (best->quantity == "speed") return direction_text(miss);
  if (best->quantity == "angle") {
    const auto region = region_of(*best);
    return region ? *region : "depending on the angle";
  }
  const int sign = slope_sign(*best);
  if (best->quantity == "command" || best->quantity == "acceleration") {
    if (sign == 0) return fmt::format("depending on the {}", best->quantity);
    return fmt::format("{} the {}", sign > 0 ? "along" : "against", best->quantity);
  }
  if (best->quantity == "time") return "changing in the course of a run";
  if (best->quantity == "heat") return "changing as the motor warms up";
  return fmt::format("with the {}", best->quantity);
}

std::string runs_text(const std::vector<double>& power,
                      const std::vector<double>& floor,
                      const std::vector<std::string>& names) {
  constexpr double kFew = 0.2;  // of the excess of the worst run
  double most = 0.0;
  for (std::size_t run = 0; run < power.size(); ++run) {
    most = std::max(most, power[run] - floor[run]);
  }
  std::vector<std::string> with;
  for (std::size_t run = 0; run < power.size(); ++run) {
    if (power[run] - floor[run] >= kFew * most) with.push_back(names[run]);
  }
  if (with.size() == names.size()) return names.size() == 1 ? names.front() : "all runs";
  if (with.size() <= 2) return fmt::format("mostly {}", fmt::join(with, " and "));
  return fmt::format("{} of {} runs", with.size(), names.size());
}

/// Two digits.
std::string hertz(double f) {
  return fmt::format("{:.0f} Hz", f < 10.0 ? f : 5.0 * std::round(f / 5.0));
}

/// The band that holds nine tenths of the excess.
std::string band_text(const std::vector<double>& f_Hz,
                      const std::vector<double>& power,
                      const std::vector<double>& floor) {
  std::vector<double> sum;
  sum.reserve(f_Hz.size());
  double total = 0.0;
  for (std::size_t i = 0; i < f_Hz.size(); ++i) {
    const double width = f_Hz[std::min(i + 1, f_Hz.size() - 1)] - f_Hz[i > 0 ? i - 1 : 0];
    total += std::max(0.0, power[i] - floor[i]) * width;
    sum.push_back(total);
  }
  const auto place = [&](double share) {
    const auto at = std::lower_bound(sum.begin(), sum.end(), share * total);
    return f_Hz[std::min(static_cast<std::size_t>(at - sum.begin()), f_Hz.size() - 1)];
  };
  const double low = place(0.05);
  const double high = place(0.9);
  const bool from_start = low < 4.0 || low < 0.1 * high;
  const bool to_end = high > 0.7 * f_Hz.back();
  if (from_start && to_end) return "at every frequency";
  if (from_start) return "below " + hertz(high);
  if (to_end) return "above " + hertz(low);
  return fmt::format("from {} to {}", hertz(low), hertz(high));
}

}  // namespace

void put_in_words(Localisation& found, const std::vector<std::string>& runs) {
  std::vector<double> taken_away;
  std::vector<double> left;
  const std::vector<double> noise(runs.size(), 1.0);
  for (std::size_t i = 0; i < kJoints; ++i) {
    taken_away.push_back(excess_of(found.nominal.at(i).run_power, found.corrected.at(i).run_power));
    left.push_back(excess_of(found.corrected.at(i).run_power, noise));
  }
  const auto most = std::max_element(taken_away.begin(), taken_away.end());
  found.axis = static_cast<std::size_t>(most - taken_away.begin());
  const AxisMiss& before = found.nominal.at(found.axis);
  const AxisMiss& after = found.corrected.at(found.axis);
  if (taken_away[found.axis] > kWorthMention && !before.profiles.empty()) {
    found.where = fmt::format("{}, {}, {}, {}", axes_text(taken_away), pattern_of(before),
                              runs_text(before.run_power, after.run_power, runs),
                              band_text(found.f_Hz, before.spectrum, after.spectrum));
  }
  for (std::size_t i = 0; i < kJoints; ++i) {
    if (left[i] <= kWorthMention) continue;
    const AxisMiss& miss = found.corrected.at(i);
    const std::vector<double> flat(found.f_Hz.size(), 1.0);
    found.left_over.at(i) = fmt::format("{}, {}", runs_text(miss.run_power, noise, runs),
                                        band_text(found.f_Hz, miss.spectrum, flat));
  }
}

std::string text_of(const Leftover& leftover) {
  if (leftover.amplitude <= 0.0) return leftover.quantity;
  const std::string size = quantity_text(leftover.amplitude, 0.0, "N m");
  if (leftover.quantity == "constant") return fmt::format("a constant torque of about {}", size);
  return fmt::format("a torque of about {} that follows {}", size, leftover.quantity);
}

}  // namespace teleop
