#include "scenarios/concealed/concealed_case.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "core/base/contract.hpp"
#include "core/base/error.hpp"
#include "scenarios/concealed/recipe.hpp"

namespace teleop::concealed {
namespace {

constexpr int kDraws = 20;
constexpr int kCorrections = 4;
constexpr int kJudgeSteps = 8;
constexpr double kStillADevice = 4.0;  // beyond this detectability the loop rattles

void record(ConcealedCase& drawn) {
  drawn.runs.clear();
  drawn.runs.reserve(kRuns);
  for (std::size_t k = 0; k < kRuns; ++k) {
    drawn.runs.push_back(simulate(drawn.device, k, drawn.device.substeps));
  }
  std::array<JudgedRun, kRuns> judged{};
  for (std::size_t k = 0; k < kRuns; ++k) {
    judged.at(k) = {k, &drawn.runs[k]};
  }
  drawn.dnr = detectability(drawn.device, judged, kJudgeSteps);
  drawn.dnr_held_out = detectability(drawn.device, std::span{judged}.last<1>(), kJudgeSteps);
  drawn.band = band_of(drawn.dnr);
}

std::vector<Run> calm_runs(Device device) {
  device.effects.clear();
  std::vector<Run> runs;
  runs.reserve(kRuns);
  for (std::size_t k = 0; k < kRuns; ++k) {
    runs.push_back(simulate(device, k, kJudgeSteps));
  }
  return runs;
}

bool usable(const ConcealedCase& drawn, const std::vector<Run>& calm) {
  for (std::size_t k = 0; k < kRuns; ++k) {
    if (!drawn.runs[k].usable(calm[k])) return false;
  }
  return true;
}

/// @returns whether the case came out as its slot wants it.
bool make(ConcealedCase& drawn, const Recipe& recipe) {
  const std::vector<Run> calm = calm_runs(drawn.device);
  std::vector<double> sizes;
  sizes.reserve(recipe.searched.size());
  drawn.dnr_alone.clear();
  for (const Recipe::Part& part : recipe.searched) {
    const Found found = search_size(drawn.device, part.effect, part.target);
    sizes.push_back(found.size);
    drawn.dnr_alone.push_back(found.detectability);
  }
  if (recipe.searched.size() < 2) drawn.dnr_alone.clear();
  for (int correction = 0; correction < kCorrections; ++correction) {
    drawn.device.effects = recipe.fixed;
    for (std::size_t i = 0; i < sizes.size(); ++i) {
      drawn.device.effects.push_back(recipe.searched[i].effect.at(sizes[i]));
    }
    complete(drawn.slot, drawn.device);
    record(drawn);
    const bool hit = !recipe.band_matters || drawn.band == drawn.slot.band;
    const bool good = usable(drawn, calm);
    if (good && hit && drawn.dnr < kStillADevice) return true;
    if (!recipe.band_matters || !good) return false;
    // Three runs searched, six judged: the size moves a little.
    const double ratio = recipe.searched.front().target / std::max(drawn.dnr, 1e-4);
    sizes.front() = std::min(sizes.front() * std::clamp(std::pow(ratio, 0.55), 0.3, 3.0),
                             recipe.searched.front().effect.largest());
  }
  return false;
}

}  // namespace

ConcealedCase draw_case(const ConcealedPlan& plan, std::size_t index) {
  expects(index < plan.cases, "a case of the plan");
  const ArmModel nominal = load_arm("phantom-1.5");
  Random mixer{plan.seed};
  const std::uint64_t seed = mixer.bits() ^ (plan.nulls ? 0xa5a5a5a5ULL : 0ULL);
  Random random{seed + 0x9e3779b9ULL * (index + 1)};
  ConcealedCase drawn{.name = fmt::format("case-{:04}", index + 1),
                      .slot = lay_out(plan)[index],
                      .device = {.arm = nominal, .nominal = nominal}};
  for (int draw = 0; draw < kDraws; ++draw) {
    Recipe recipe = draw_recipe(drawn.slot, nominal, random);
    recipe.wish.motion *= std::pow(0.93, draw);
    drawn.device = draw_device(nominal, recipe.wish, random);
    if (make(drawn, recipe)) return drawn;
  }
  throw ConfigError{
      fmt::format("{}: no device of the sort {} came out within its bounds in {} draws; "
                  "take another seed",
                  drawn.name, drawn.slot.sort, kDraws)};
}

}  // namespace teleop::concealed
