#include "core/tuning/marginal_search.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

namespace teleop {
namespace {

// Only probes with a rate get as far as their oscillation is looked at: has_rate(), which the
// checker does not see through. NOLINTBEGIN(bugprone-unchecked-optional-access)

using Probes = std::span<const ProbeResult>;

constexpr double kFirstPush_N = 0.1;
constexpr double kFirstPush_s = 0.004;
constexpr double kSmallestPush_N = 0.01;
constexpr double kQuietFactor = 3.0;
constexpr double kCautiousFactor = 1.6;
constexpr double kNear = 0.12;           ///< |ln g/g*| of probes that count for the interval
constexpr double kSameFrequency = 0.15;  ///< relative
constexpr double kWorthBracketing = 1.15;
constexpr std::size_t kFewestNear = 9;
constexpr int kMostInARow = 8;      ///< probes that say nothing
constexpr double kLeastRoom = 1.1;  ///< up to a gain that is too high: less is not worth a try

bool is_stable(const ProbeResult& p) {
  return p.verdict == Verdict::quiet || p.verdict == Verdict::decays || p.verdict == Verdict::small;
}
bool says_something(const ProbeResult& p) { return is_stable(p) || p.verdict == Verdict::grows; }
bool has_rate(const ProbeResult& p) {
  const bool rated = p.verdict == Verdict::decays || p.verdict == Verdict::grows;
  return rated && p.oscillation && p.oscillation->is_rated();
}

/// Whether the rate belongs to an oscillation of about amplitude A; smaller ones feel the rounding.
bool is_at_amplitude(const ProbeResult& p) {
  return has_rate(p) && p.oscillation->amplitude_here > 0.5 * p.plan.amplitude_m;
}

/// Growth beyond doubt: three deviations at amplitude A, or a motion that ran away.
bool surely_grows(const ProbeResult& p) {
  if (p.verdict != Verdict::grows) return false;
  if (p.outcome.stop != ProbeStop::time && p.outcome.stop != ProbeStop::decayed) return true;
  return is_at_amplitude(p) && p.oscillation->growth_per_s > 3.0 * p.oscillation->growth_std_per_s;
}

/// What is known from the probes so far.
struct Knowledge {
  const ProbeResult* low = nullptr;   ///< largest stable gain below every unstable one
  const ProbeResult* high = nullptr;  ///< smallest unstable gain
  double safe_gain = 0.0;
  double too_high = std::numeric_limits<double>::infinity();  ///< even the weakest push overshot
  double arm_seconds = 0.0;
  int says_nothing = 0;  ///< at the end of the list
};

/// Rounding alone, times so high a gain, moves the arm further than any push was to.
bool no_push_is_weak_enough(const ProbeResult& p) {
  return p.verdict == Verdict::overshot && std::abs(p.plan.push_N) <= kSmallestPush_N;
}

/// How fast motion died, 1/s.
double calm_of(const ProbeResult& p, double period_s) {
  const double watched = std::max(p.outcome.watch_ticks, 1) * period_s;
  if (p.outcome.stop == ProbeStop::decayed) return 0.9 / watched;
  return p.oscillation ? -p.oscillation->growth_per_s : 0.0;
}

Knowledge look(Probes probes, double period_s) {
  Knowledge k;
  for (const ProbeResult& p : probes) {
    k.arm_seconds += p.timing.arm_seconds;
    const bool lowers = no_push_is_weak_enough(p) && p.plan.gain < k.too_high;
    if (lowers) k.too_high = p.plan.gain;
    k.says_nothing = lowers || says_something(p) ? 0 : k.says_nothing + 1;
    if (surely_grows(p) && (k.high == nullptr || p.plan.gain < k.high->plan.gain)) {
      k.high = &p;
    }
  }
  double calmest = 0.0;
  const ProbeResult* rated = nullptr;
  double not_safe = std::numeric_limits<double>::infinity();
  for (const ProbeResult& p : probes) {
    if (p.outcome.swelled && p.plan.safe_gain > 0.0) {
      not_safe = std::min(not_safe, p.plan.safe_gain);
    }
  }
  for (const ProbeResult& p : probes) {
    const bool below = k.high == nullptr || p.plan.gain < k.high->plan.gain;
    if (!is_stable(p) || !below) continue;
    if (k.low == nullptr || p.plan.gain > k.low->plan.gain) k.low = &p;
    const bool best_rated = rated == nullptr || p.plan.gain > rated->plan.gain;
    if (has_rate(p) && best_rated) rated = &p;
    const bool well_below = k.high == nullptr || p.plan.gain < 0.6 * k.high->plan.gain;
    const double calm = calm_of(p, period_s);
    if (well_below && p.plan.gain < not_safe && calm > calmest) {
      calmest = calm;
      k.safe_gain = p.plan.gain;
    }
  }
  // Near the limit an oscillation shows; a rated gain a little lower tells more than a quiet one.
  const bool trust = k.high != nullptr && rated != nullptr && !has_rate(*k.low) &&
                     rated->plan.gain > 0.8 * k.high->plan.gain;
  if (trust) k.low = rated;
  return k;
}

bool same_frequency(double fa, double fb) {
  return std::abs(fa - fb) < kSameFrequency * std::max(fa, fb);
}

bool same_mode(const ProbeResult& a, const ProbeResult& b) {
  return same_frequency(a.oscillation->frequency_Hz, b.oscillation->frequency_Hz);
}

/// The oscillation of a probe that has about this frequency: another mode may die more slowly.
const Oscillation* matching(const ProbeResult& p, double frequency_Hz) {
  if (same_frequency(p.oscillation->frequency_Hz, frequency_Hz)) return &*p.oscillation;
  for (const Oscillation& o : p.others) {
    if (o.is_rated() && same_frequency(o.frequency_Hz, frequency_Hz)) return &o;
  }
  return nullptr;
}

/// Rated probes near the smallest unstable gain, of the mode that grows there.
std::vector<GrowthPoint> near_points(Probes probes, const ProbeResult& high, double centre) {
  std::vector<GrowthPoint> points;
  for (const ProbeResult& p : probes) {
    if (!is_at_amplitude(p) || std::abs(std::log(p.plan.gain / centre)) > kNear) continue;
    const Oscillation* o = matching(p, high.oscillation->frequency_Hz);
    if (o == nullptr) continue;
    points.push_back(
        {.gain = p.plan.gain,
         .growth_per_s = o->growth_per_s,
         .std_per_s = o->growth_std_per_s,
         .log_amplitude = std::log(p.oscillation->amplitude_here / p.plan.amplitude_m)});
  }
  return points;
}

bool on_both_sides(const std::vector<GrowthPoint>& points) {
  const auto grows = [](const GrowthPoint& p) {
    return p.growth_per_s > 0.0;
  };
  return std::any_of(points.begin(), points.end(), grows) &&
         !std::all_of(points.begin(), points.end(), grows);
}

/// Gain at which the straight line through two rated probes of one mode passes zero.
std::optional<double> secant(const ProbeResult* a, const ProbeResult* b) {
  const bool rated = a != nullptr && b != nullptr && has_rate(*a) && has_rate(*b);
  if (!rated || a->plan.gain == b->plan.gain) return std::nullopt;
  // In steps of the exploration the frequency of one mode moves with the root of the gain.
  const double ratio = b->oscillation->frequency_Hz / a->oscillation->frequency_Hz;
  const double expected = std::sqrt(b->plan.gain / a->plan.gain);
  if (std::abs(std::log(ratio)) > std::abs(std::log(expected)) + 0.1) return std::nullopt;
  const double slope =
      (b->oscillation->growth_per_s - a->oscillation->growth_per_s) / (b->plan.gain - a->plan.gain);
  if (slope <= 0.0) return std::nullopt;
  return b->plan.gain - b->oscillation->growth_per_s / slope;
}

}  // namespace

std::string_view name_of(SearchEnd end) noexcept {
  switch (end) {
    case SearchEnd::goes_on:
      return "goes_on";
    case SearchEnd::found:
      return "found";
    case SearchEnd::wide:
      return "wide";
    case SearchEnd::no_limit:
      return "no_limit";
    case SearchEnd::force_limited:
      return "force_limited";
    case SearchEnd::always_unstable:
      return "always_unstable";
    case SearchEnd::gave_up:
      return "gave_up";
  }
  return "unknown";
}

double MarginalSearch::default_amplitude(double quantum_m) noexcept {
  return std::max(10.0 * quantum_m, 3e-4);
}

MarginalSearch::MarginalSearch(const Config& config) : config_{config} {
  const bool damps = config.experiment == GainExperiment::damping;
  if (config_.start_gain <= 0.0) config_.start_gain = damps ? 0.05 : 8.0;
  if (config_.most_gain <= 0.0) config_.most_gain = damps ? 200.0 : 100'000.0;
}

namespace {

/// Amplitude that the bounds leave room for, where an oscillation has been seen.
double room_for(const MarginalSearch::Config& c, const ProbeResult* seen) {
  constexpr double kRoom = 1.8;  ///< what an oscillation may pass A by
  double amplitude = c.amplitude_m;
  if (seen == nullptr || !seen->oscillation || seen->outcome.peak_swing_m <= 0.0) return amplitude;
  const double stiffness = seen->outcome.peak_force_N / seen->outcome.peak_swing_m;
  const double omega = 2.0 * std::numbers::pi * seen->oscillation->frequency_Hz;
  amplitude = std::min(amplitude, 0.9 * c.bounds.force_N / (kRoom * stiffness));
  return std::min(amplitude, 0.9 * kStopShare * c.bounds.speed_m_per_s / (kRoom * omega));
}

struct Wish {
  double gain = 0.0;
  double start_m = 0.0;  ///< amplitude right after the push
  double watch_s = 0.0;  ///< 0: of the exploration
};

/// Turns a wish into a plan: sizes the push by what the last pushes did.
ProbePlan plan_for(const MarginalSearch::Config& c,
                   Probes probes,
                   const Knowledge& k,
                   const Wish& wish) {
  const ProbeResult* last = nullptr;
  const ProbeResult* oscillating = nullptr;
  for (const ProbeResult& p : probes) {
    last = &p;
    if (has_rate(p)) oscillating = &p;
  }
  ProbePlan plan{.gain = wish.gain, .safe_gain = k.safe_gain, .memory_s = c.memory_s};
  plan.amplitude_m = room_for(c, k.high != nullptr && has_rate(*k.high) ? k.high : oscillating);
  double push_s = kFirstPush_s;
  double watch_s = 0.4 + 2.0 * c.memory_s;
  if (oscillating != nullptr) {
    plan.period_s = 1.0 / oscillating->oscillation->frequency_Hz;
    push_s = 0.25 * plan.period_s;
    watch_s = std::clamp(8.0 * plan.period_s, 0.25 + 2.0 * c.memory_s, 1.5);
  }
  plan.watch_s = wish.watch_s > 0.0 ? wish.watch_s : watch_s;
  plan.push_ticks = std::clamp(static_cast<int>(std::lround(push_s / c.period_s)), 1,
                               static_cast<int>(std::lround(0.05 / c.period_s)));
  const double start_m = wish.start_m * plan.amplitude_m / c.amplitude_m;
  double push = kFirstPush_N;
  if (last != nullptr) {
    const double seen =
        has_rate(*last) ? last->oscillation->amplitude_start : last->outcome.peak_swing_m;
    const double swing = std::max(seen, c.quantum_m);
    const double impulse = std::abs(last->plan.push_N) * last->plan.push_ticks;
    // What moved by a few counts says little about how far to go.
    const double most = swing > 3.0 * c.quantum_m ? 3.0 : 10.0;
    const bool too_strong = last->verdict == Verdict::overshot;
    const double factor = std::clamp(start_m / swing, 0.1, too_strong ? 0.3 : most);
    push = impulse * factor / plan.push_ticks;
  }
  push = std::clamp(push, kSmallestPush_N, 0.7 * c.bounds.force_N);
  plan.push_N = probes.size() % 2 == 0 ? push : -push;
  plan.ceiling_m = std::max(2.5 * plan.amplitude_m, 1.6 * start_m);
  plan.floor_m = 2.5 * c.quantum_m;
  return plan;
}

/// Two rated probes of the exploration, the last and one before it at another gain.
std::optional<double> extrapolate(Probes probes) {
  const ProbeResult* b = nullptr;
  const ProbeResult* a = nullptr;
  for (const ProbeResult& p : probes) {
    if (p.verdict != Verdict::decays || !has_rate(p)) continue;
    if (b == nullptr || p.plan.gain > b->plan.gain) {
      a = b;
      b = &p;
    }
  }
  return secant(a, b);
}

double explored_gain(const MarginalSearch::Config& c, Probes probes, const Knowledge& k) {
  if (k.low == nullptr && k.high == nullptr) return std::min(c.start_gain, k.too_high / 4.0);
  if (k.low == nullptr) return k.high->plan.gain / 4.0;
  const double gain = k.low->plan.gain;
  const double room = k.too_high / gain;
  if (room > 1.0 && room < kQuietFactor * kQuietFactor) return gain * std::sqrt(room);
  if (k.low->verdict != Verdict::decays) return kQuietFactor * gain;
  if (const std::optional<double> zero = extrapolate(probes)) {
    return std::clamp(1.03 * *zero, 1.05 * gain, 2.0 * gain);
  }
  return kCautiousFactor * gain;
}

double bracketed_gain(const Knowledge& k) {
  const double low = k.low->plan.gain;
  const double high = k.high->plan.gain;
  const double middle = std::sqrt(low * high);
  const double edge = std::pow(high / low, 0.1);
  return std::clamp(secant(k.low, k.high).value_or(middle), low * edge, high / edge);
}

/// Whether many probes next to the crossing died before they showed a rate: friction holds what
/// starts below A, so pushes have to start above it.
bool sticks(Probes probes, const std::vector<GrowthPoint>& points, double zero) {
  const auto misses = std::count_if(probes.begin(), probes.end(), [&](const ProbeResult& p) {
    const bool near = std::abs(std::log(p.plan.gain / zero)) < kNear;
    return near && (p.verdict == Verdict::quiet || p.verdict == Verdict::undershot);
  });
  return misses > 1 && 4 * misses > static_cast<std::ptrdiff_t>(points.size());
}

/// What is known near a crossing.
struct Near {
  const std::vector<GrowthPoint>& points;
  double zero = 0.0;   ///< gain at which the growth rate passes zero
  double slope = 0.0;  ///< dσ / d ln g
};

/// Where to look next around a crossing: side, distance and length of the watch.
Wish refined(const MarginalSearch::Config& c,
             Probes probes,
             const ProbeResult& high,
             const Near& near) {
  const auto& [points, zero, slope] = near;
  const double period = 1.0 / high.oscillation->frequency_Hz;
  const double amplitude = room_for(c, &high);
  const double noise = c.quantum_m / std::sqrt(12.0);
  // Cramér–Rao: std(σ) = √24 noise/A √T / watch^{3/2}; one probe alone should give half the width.
  const double wanted = 0.5 * c.width * slope;
  const double needed =
      std::pow(std::sqrt(24.0) * noise / amplitude * std::sqrt(c.period_s) / wanted, 2.0 / 3.0);
  const double watch = std::clamp(needed, std::max(12.0 * period, 0.25), 2.5);
  const double most = std::clamp(1.0 / (slope * watch), 0.015, 0.06);
  const auto above = std::count_if(points.begin(), points.end(),
                                   [&](const GrowthPoint& p) { return p.gain > zero; });
  const auto below = static_cast<std::ptrdiff_t>(points.size()) - above;
  // Distances that do not repeat: whatever depends on where the counts fall averages out.
  const double share = 0.5 + 0.5 * std::fmod(0.618 * static_cast<double>(points.size()), 1.0);
  const double away = (above > below ? -1.0 : 1.0) * share * most;
  const double start = std::clamp(std::exp(-0.5 * slope * away * watch), 0.6, 1.7);
  return {.gain = zero * std::exp(away),
          .start_m = c.amplitude_m * (sticks(probes, points, zero) ? 1.5 : start),
          .watch_s = watch};
}

}  // namespace

MarginalSearch::Step MarginalSearch::next(Probes probes) const {
  const Knowledge k = look(probes, config_.period_s);
  const auto end = [](SearchEnd why, std::optional<Crossing> crossing = {}) {
    return Step{.end = why, .crossing = crossing};
  };
  const auto ask = [&](const Wish& wish) {
    return Step{.plan = plan_for(config_, probes, k, wish)};
  };
  if (k.says_nothing >= kMostInARow) return end(SearchEnd::gave_up);
  if (!probes.empty() && !probes.back().outcome.rests && k.says_nothing > 0 &&
      probes.back().verdict == Verdict::disturbed && k.says_nothing >= 2) {
    return end(SearchEnd::gave_up);
  }

  std::vector<GrowthPoint> points;
  std::optional<Crossing> crossing;
  if (k.high != nullptr && has_rate(*k.high)) {
    const double low = k.low != nullptr ? k.low->plan.gain : k.high->plan.gain;
    points = near_points(probes, *k.high, std::sqrt(low * k.high->plan.gain));
    if (on_both_sides(points)) crossing = find_crossing(points);
  }
  if (crossing && points.size() >= kFewestNear && crossing->relative_width() <= config_.width) {
    return end(SearchEnd::found, crossing);
  }
  const bool spent = static_cast<int>(probes.size()) >= config_.most_probes ||
                     k.arm_seconds > config_.most_arm_seconds;
  if (spent) return end(crossing ? SearchEnd::wide : SearchEnd::gave_up, crossing);

  if (k.low == nullptr || k.high == nullptr) {
    const double gain = explored_gain(config_, probes, k);
    if (gain > config_.most_gain) return end(SearchEnd::no_limit);
    if (gain < config_.start_gain / 300.0) return end(SearchEnd::always_unstable);
    const double most = k.low != nullptr ? k.too_high / k.low->plan.gain : 0.0;
    const bool no_room = most > 1.0 && most < kLeastRoom;
    if (no_room || (k.low != nullptr && room_for(config_, k.low) < 4.0 * config_.quantum_m)) {
      return end(SearchEnd::force_limited);
    }
    return ask({.gain = gain, .start_m = config_.amplitude_m});
  }
  if (crossing) {
    return ask(refined(config_, probes, *k.high, {points, crossing->gain, crossing->slope_per_s}));
  }
  const double ratio = k.high->plan.gain / k.low->plan.gain;
  const std::optional<double> zero = secant(k.low, k.high);
  if (ratio < kWorthBracketing && !has_rate(*k.low)) {
    // So near the limit a stable probe shows an oscillation: what was quiet is looked at again.
    return ask({.gain = 0.97 * k.low->plan.gain, .start_m = config_.amplitude_m});
  }
  if (ratio < kWorthBracketing && zero && same_mode(*k.low, *k.high)) {
    const double slope =
        (k.high->oscillation->growth_per_s - k.low->oscillation->growth_per_s) / std::log(ratio);
    return ask(refined(config_, probes, *k.high, {points, *zero, slope}));
  }
  return ask({.gain = bracketed_gain(k), .start_m = config_.amplitude_m});
}

// NOLINTEND(bugprone-unchecked-optional-access)

}  // namespace teleop
