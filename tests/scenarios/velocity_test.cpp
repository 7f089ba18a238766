#include "scenarios/velocity.hpp"

#include <cmath>
#include <fstream>
#include <map>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/base/error.hpp"
#include "core/estimation/velocity_estimator.hpp"
#include "core/recording/log_writer.hpp"
#include "core/simulation/pair.hpp"
#include "tests/support/temporary_folder.hpp"

namespace teleop {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::TemporaryFolder;

/// Runs the verb and gives its numbers, rows by name. Pictures need gnuplot; numbers do not.
struct Ran {
  json all{};
  std::map<std::string, json> rows{};
};

Ran run(VelocityOptions options, const TemporaryFolder& folder) {
  options.out = folder.path();
  options.json = folder.path() / "velocity.json";
  EXPECT_LE(run_velocity(options), 1);
  std::ifstream in{options.json};
  Ran ran{.all = json::parse(in)};
  for (const json& row : ran.all.at("rows")) {
    ran.rows[row.at("name")] = row;
  }
  return ran;
}

/// A simulated pair's master, recorded as a live one.
std::string record_master(const TemporaryFolder& folder, const std::string& arm) {
  const PlantSpec plant = load_plant("phantom-1.5");
  SimulatedPair pair{{.master = {.plant = plant, .hand = "reach"}, .slave = {.plant = plant}}};
  const fs::path file = folder.path() / "master.mcap";
  LogWriter writer{{.file = file, .role = Role::master, .metadata = {{"arm", arm}}}};
  for (int i = 0; i < 4000; ++i) {
    pair.step();
    writer.append(pair.master());
  }
  writer.close({});
  return file.string();
}

TEST(Velocity, OfASimulatedMotionShowsEveryKindAgainstTheTruth) {
  const TemporaryFolder folder;

  const Ran ran = run({.seed = 5, .seconds = 5.0}, folder);

  EXPECT_EQ(ran.all.at("reference"), "truth");
  for (const std::string_view kind : velocity_kinds()) {
    int found = 0;
    for (const auto& [name, row] : ran.rows) {
      found += row.at("kind") == kind ? 1 : 0;
    }
    EXPECT_GE(found, 1) << kind;
  }
  for (const auto& [name, row] : ran.rows) {
    EXPECT_TRUE(std::isfinite(row.at("noise_mm_per_s").get<double>())) << name;
    EXPECT_TRUE(row.at("max_damping_Ns_per_m").is_number()) << name;
    EXPECT_EQ(row.at("worst_error_by_speed").size(), 4U) << name;
  }
}

TEST(Velocity, ShowsThePapersLagAndThatThePeriodCounterIsCalmerAndSooner) {
  const TemporaryFolder folder;

  const Ran ran = run({.seed = 6, .seconds = 10.0}, folder);

  const json& mean = ran.rows.at("mean of 100");
  const json& period = ran.rows.at("period, mean of 16");
  const json& first = ran.rows.at("first difference");
  EXPECT_NEAR(mean.at("lag_ms").get<double>(), 50.0, 2.0);
  EXPECT_NEAR(mean.at("stated_lag_ms").get<double>(), 50.0, 1e-6);
  EXPECT_NEAR(period.at("lag_ms").get<double>(), 7.5, 2.5);
  EXPECT_LT(period.at("noise_mm_per_s").get<double>(),
            0.1 * first.at("noise_mm_per_s").get<double>());
  EXPECT_GT(period.at("max_damping_Ns_per_m").get<double>(),
            1.5 * mean.at("max_damping_Ns_per_m").get<double>());
}

TEST(Velocity, OfARecordingFindsTheLagsWithoutTheTruth) {
  const TemporaryFolder folder;
  const std::string log = record_master(folder, "phantom-1.5");

  const Ran ran = run({.logs = {log, log}}, folder);

  EXPECT_EQ(ran.all.at("reference"), "zero-phase smoother");
  EXPECT_EQ(ran.all.at("sources").size(), 2U);
  EXPECT_TRUE(ran.all.at("period_counter").get<bool>());
  EXPECT_NEAR(ran.rows.at("mean of 100").at("lag_ms").get<double>(), 50.0, 3.0);
  EXPECT_NEAR(ran.rows.at("first difference").at("lag_ms").get<double>(), 0.5, 0.3);
}

TEST(Velocity, TakesTheStationsSettings) {
  const TemporaryFolder folder;

  const Ran ran = run(
      {.seconds = 2.0, .settings = {"velocity.mean.samples=20", "velocity.cutoff_Hz=0"}}, folder);

  EXPECT_TRUE(ran.rows.contains("mean of 20"));
  EXPECT_EQ(ran.rows.size(), velocity_kinds().size()) << "one first difference is enough";
}

TEST(Velocity, RefusesWhatItCannotLookAt) {
  const TemporaryFolder folder;
  const std::string out = folder.path();
  const std::string unknown_arm = record_master(folder, "no-such-arm");
  EXPECT_THROW((void)run_velocity({.logs = {unknown_arm}, .out = out}), ConfigError);
  EXPECT_THROW((void)run_velocity({.settings = {"velocity.mean.samples=0"}, .out = out}),
               ConfigError);
  EXPECT_THROW((void)run_velocity({.settings = {"velocity.guess=1"}, .out = out}), ConfigError);
  EXPECT_THROW((void)run_velocity({.settings = {"velocity.mean.samples"}, .out = out}),
               ConfigError);
  EXPECT_THROW((void)run_velocity({.device = "teapot", .out = out}), DeviceError);
  EXPECT_TRUE(!fs::exists(folder.path() / "velocity-error.png"));
}

}  // namespace
}  // namespace teleop
