#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "scenarios/concealed/judge.hpp"
#include "tests/concealed/loops.hpp"

namespace teleop::concealed {
namespace {

namespace fs = std::filesystem;
using testing::phantom;

Device device_of(const nlohmann::json& truth) {
  Device device{.arm = phantom(), .nominal = phantom()};
  const nlohmann::json& noise = truth.at("disturbance");
  for (std::size_t i = 0; i < kJoints; ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    device.disturbance.white_Nm[k] = noise.at("white_Nm").at(i);
    device.disturbance.coloured_Nm[k] = noise.at("coloured_Nm").at(i);
    device.disturbance.coloured_time_s[k] = noise.at("coloured_time_s").at(i);
  }
  device.disturbance.encoder_noise_counts = noise.at("encoder_noise_counts");
  for (const nlohmann::json& each : truth.at("effects")) {
    Effect effect{.kind = each.at("kind")};
    if (!each.at("axis").is_null()) effect.axis = each.at("axis").get<std::size_t>() - 1;
    for (const auto& [name, value] : each.at("parameters").items()) {
      effect.parameters.emplace_back(name, value);
    }
    device.effects.push_back(effect);
  }
  return device;
}

concealed::Run run_of(const fs::path& file) {
  const JointVector count = count_rad(phantom());
  Run run;
  std::ifstream stream{file};
  std::string line;
  std::getline(stream, line);
  while (std::getline(stream, line)) {
    std::array<double, 7> cells{};
    std::istringstream text{line};
    for (double& cell : cells) {
      std::string word;
      std::getline(text, word, ',');
      cell = std::strtod(word.c_str(), nullptr);
    }
    run.logged.emplace_back(cells[1], cells[2], cells[3]);
    std::array<std::int32_t, kJoints> counts{};
    for (std::size_t i = 0; i < kJoints; ++i) {
      counts.at(i) = static_cast<std::int32_t>(
          std::lround(cells.at(4 + i) / count[static_cast<Eigen::Index>(i)]));
    }
    run.counts.push_back(counts);
  }
  run.applied = run.logged;
  return run;
}

/// Recordings of another generator, made from the same definitions: with their effects this plant
/// has to predict them as well as rounding allows, without it must not.
TEST(ConcealedLaws, ExplainRecordingsOfAnotherGeneratorDownToTheirNoise) {
  const fs::path folder = fs::path{TELEOP_SOURCE_DIR} / "../shared/challenge/practice";
  if (!fs::exists(folder)) GTEST_SKIP() << "no recordings at " << folder;
  const JointVector count = count_rad(phantom());
  for (const auto& entry : fs::directory_iterator{folder}) {
    const auto truth = nlohmann::json::parse(std::ifstream{entry.path() / "truth.json"});
    Device device = device_of(truth);
    SCOPED_TRACE(entry.path().filename().string());
    std::vector<concealed::Run> runs;
    std::vector<JudgedRun> judged;
    runs.reserve(5);
    judged.reserve(5);
    for (std::size_t k = 0; k < 5; ++k) {
      runs.push_back(run_of(entry.path() / ("run-0" + std::to_string(k + 1) + ".csv")));
      const concealed::Run& run = runs.back();
      for (std::size_t i = 0; i < kJoints; ++i) {
        const auto axis = static_cast<Eigen::Index>(i);
        device.runs.at(k).q[axis] = run.counts[0].at(i) * count[axis];
        device.runs.at(k).v[axis] =
            200.0 * (run.counts[5].at(i) - run.counts[0].at(i)) * count[axis];
      }
      judged.push_back({k, &run});
      const JointVector rms = innovations(device, judged.back(), true, 8).cwiseQuotient(count);
      // Rounding alone gives 0.29; disturbances, inertias that are off and rest at the edge of a
      // count add to it.
      EXPECT_LT(rms.maxCoeff(), 1.4 / std::sqrt(12.0)) << "run " << k + 1;
    }
    const double least = device.effects.empty() ? -0.001 : 0.1;
    EXPECT_GT(detectability(device, judged, 8), least);
  }
}

}  // namespace
}  // namespace teleop::concealed
