#include "scenarios/concealed/size_search.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace teleop::concealed {
namespace {

constexpr int kCoarse = 8;  // steps a sample
constexpr int kTrials = 9;
constexpr double kNear = 1.2;  // ratio to the target that will do
constexpr std::array<std::size_t, 3> kSearched{0, 2, 5};

std::vector<Run> calm_runs(Device device) {
  device.effects.clear();
  std::vector<Run> runs;
  runs.reserve(kSearched.size());
  for (const std::size_t index : kSearched) {
    runs.push_back(simulate(device, index, kCoarse));
  }
  return runs;
}

double judged(const Device& device, const std::vector<Run>& calm) {
  std::vector<Run> runs;
  std::vector<JudgedRun> list;
  runs.reserve(kSearched.size());
  list.reserve(kSearched.size());
  for (std::size_t k = 0; k < kSearched.size(); ++k) {
    runs.push_back(simulate(device, kSearched.at(k), kCoarse));
    if (!runs.back().usable(calm[k])) return HUGE_VAL;
    list.push_back({kSearched.at(k), &runs.back()});
  }
  return detectability(device, list, kCoarse);
}

}  // namespace

std::string_view name_of(Band band) noexcept {
  static constexpr std::array<std::string_view, 4> kNames{"obvious", "visible", "faint",
                                                          "invisible"};
  return kNames[static_cast<std::size_t>(band)];
}

Band band_of(double detectability) noexcept {
  if (detectability >= 0.10) return Band::obvious;
  if (detectability >= 0.02) return Band::visible;
  return detectability >= 0.005 ? Band::faint : Band::invisible;
}

double draw_target(Band band, Random& random) {
  const double share = random.uniform();
  switch (band) {
    case Band::obvious:
      return 0.14 * std::pow(1.2 / 0.14, share);
    case Band::visible:
      return 0.028 * std::pow(0.08 / 0.028, share);
    case Band::faint:
      return 0.007 * std::pow(0.015 / 0.007, share);
    case Band::invisible:
      break;
  }
  return 0.002;
}

Found search_size(Device device, const Sized& effect, double target) {
  const std::vector<Run> calm = calm_runs(device);
  double low = 0.0;
  double high = 0.0;
  double size = std::min(1.0, effect.largest());
  Found best{.size = size, .detectability = HUGE_VAL};
  const auto distance = [&](double x) {
    return std::abs(std::log(std::clamp(x, 1e-6, 1e6) / target));
  };
  for (int trial = 0; trial < kTrials; ++trial) {
    device.effects = {effect.at(size)};
    const double found = judged(device, calm);
    if (distance(found) <= distance(best.detectability)) {
      best = {.size = size, .detectability = found};
    }
    if (distance(found) < std::log(kNear)) break;
    (found < target ? low : high) = size;
    if (found < target && size >= effect.largest()) break;
    // Between linear and square: what a size does to an RMS that noise already fills.
    const double step = std::pow(target / std::clamp(found, 1e-3 * target, 1e3 * target), 0.6);
    const double wanted = std::clamp(size * std::clamp(step, 0.1, 8.0), 1e-3, effect.largest());
    const bool bracketed = low > 0.0 && high > 0.0;
    const bool inside =
        bracketed && wanted > 1.05 * std::min(low, high) && wanted < 0.95 * std::max(low, high);
    size = bracketed && !inside ? std::sqrt(low * high) : wanted;
  }
  return best;
}

}  // namespace teleop::concealed
