#include <chrono>
#include <csignal>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/ports/peer.hpp"
#include "core/recording/log.hpp"
#include "scenarios/child.hpp"
#include "tests/support/command.hpp"
#include "tests/support/temporary_folder.hpp"

namespace teleop {
namespace {

using nlohmann::json;
using testing::Finished;
using testing::TemporaryFolder;

json read_json(const std::filesystem::path& file) { return json::parse(std::ifstream{file}); }

TEST(Loopback, TeleoperatesInFreeMotionAndSaysSo) {
  const TemporaryFolder folder;
  const auto out = folder.path() / "run";

  const Finished finished = testing::run("teleop loopback --seconds 4 --out " + out.string() +
                                         " --json " + (folder.path() / "s.json").string());

  ASSERT_EQ(finished.exit_code, 0) << finished.output;
  const json summary = read_json(folder.path() / "s.json");
  for (const char* key : {"/rate_Hz",
                          "/ticks/master",
                          "/ticks/slave",
                          "/tracking_rms_mm",
                          "/tracking_peak_mm",
                          "/force_rms_N",
                          "/rtt_us/p50",
                          "/rtt_us/p99",
                          "/rtt_us/p999",
                          "/lateness_us/p50",
                          "/lateness_us/p90",
                          "/lateness_us/p99",
                          "/lateness_us/p999",
                          "/lateness_us/max",
                          "/compute_us/p50",
                          "/compute_us/p99",
                          "/age_ms/p50",
                          "/age_ms/p99",
                          "/packets/sent",
                          "/packets/received",
                          "/packets/lost",
                          "/packets/duplicated",
                          "/packets/reordered",
                          "/recordings/1",
                          "/report",
                          "/faults"}) {
    EXPECT_TRUE(summary.contains(json::json_pointer{key})) << key;
  }
  EXPECT_LT(summary["tracking_rms_mm"].get<double>(), 2.0);
  EXPECT_GT(summary["tracking_rms_mm"].get<double>(), 0.01) << "nothing moved";
  EXPECT_EQ(summary["faults"].size(), 0U);
  EXPECT_GT(std::filesystem::file_size(out / "report.html"), 100'000U);
  for (const char* side : {"master.mcap", "slave.mcap"}) {
    const Log log = read_log(out / side);
    EXPECT_TRUE(log.complete) << side << ": " << log.damage;
    EXPECT_EQ(log.metadata.count("realtime"), 1U);
    EXPECT_EQ(log.ticks.back().tau_Nm, JointVector::Zero()) << side << " ended with torque on";
  }
}

TEST(Loopback, CarriesTheContactForceToTheHandAtRest) {
  const TemporaryFolder folder;

  const Finished finished = testing::run(
      "teleop loopback --seconds 6 --environment wall --no-report --out " +
      (folder.path() / "run").string() + " --json " + (folder.path() / "s.json").string());

  ASSERT_EQ(finished.exit_code, 0) << finished.output;
  const json summary = read_json(folder.path() / "s.json");
  ASSERT_TRUE(summary["contact_at_rest"].is_object()) << summary.dump(2);
  EXPECT_NEAR(summary["contact_at_rest"]["ratio"].get<double>(), 1.0, 0.1);
}

/// A pair of processes with a slave that the test may kill.
class LostPeer : public ::testing::Test {
 protected:
  std::unique_ptr<Child> start_slave(const std::string& address, const std::string& out) {
    auto child = std::make_unique<Child>(
        "slave", std::vector<std::string>{sibling_program("teleop-slave"), "--status_json", "true",
                                          "--link.bind", address, "--hand", "none", "--out",
                                          (folder_.path() / out).string()});
    address_ = address_of(*child);
    return child;
  }

  std::unique_ptr<Child> start_master() {
    auto child = std::make_unique<Child>(
        "master", std::vector<std::string>{sibling_program("teleop-master"), "--status_json",
                                           "true", "--link.peer", address_, "--hand", "reach",
                                           "--out", folder_.path().string()});
    (void)address_of(*child);
    return child;
  }

  static std::string address_of(Child& child) {
    const auto line = child.next_line(5000);
    return line ? json::parse(*line).at("address").get<std::string>() : std::string{};
  }

  /// Reads status lines until the mode is seen. @returns whether it was.
  static bool reaches(Child& child, const std::string& mode) {
    for (int i = 0; i < 100; ++i) {
      const auto line = child.next_line(5000);
      if (!line) return false;
      if (json::parse(*line).value("mode", "") == mode) return true;
    }
    return false;
  }

  TemporaryFolder folder_;
  std::string address_;
};

TEST_F(LostPeer, IsHeldWithin20MillisecondsAndEngagedAgainWithoutAJump) {
  auto slave = start_slave("127.0.0.1:0", "first");
  auto master = start_master();
  ASSERT_TRUE(reaches(*master, "engaged"));

  kill(slave->id(), SIGKILL);
  ASSERT_TRUE(reaches(*master, "holding"));
  slave = start_slave(address_, "second");
  ASSERT_TRUE(reaches(*master, "engaged"));
  slave->ask_to_end();
  EXPECT_EQ(slave->end(5000), 0);
  master->ask_to_end();
  EXPECT_EQ(master->end(5000), 0);

  const Log log = read_log(folder_.path() / "master.mcap");
  EXPECT_TRUE(log.complete);
  bool was_engaged = false;
  bool came_back = false;
  double first_step_N = 0.0;
  for (std::size_t i = 1; i < log.ticks.size(); ++i) {
    const TickRecord& now = log.ticks[i];
    const TickRecord& before = log.ticks[i - 1];
    const auto mode = static_cast<Mode>(now.mode);
    came_back = came_back || (was_engaged && static_cast<Mode>(before.mode) == Mode::engaging &&
                              mode == Mode::engaged);
    was_engaged = was_engaged || mode == Mode::engaged;
    const double silent_ms = 1e-6 * static_cast<double>(now.stamp_ns - now.peer_received_ns);
    // A turn can only act when it comes: the machine's own lateness is not the supervisor's.
    if (was_engaged && silent_ms > 20.0 + now.elapsed_ms) {
      EXPECT_EQ(now.coupling_N, Vector3::Zero()) << "silent for " << silent_ms << " ms";
      EXPECT_NE(mode, Mode::engaged);
    }
    if (mode == Mode::engaging && now.ramp < 0.2) {
      first_step_N = std::max(first_step_N, (now.coupling_N - before.coupling_N).norm());
    }
  }
  EXPECT_TRUE(came_back);
  // With everything on, encoder counts alone make steps of up to 0.3 N: a fifth of that is noise.
  EXPECT_LT(first_step_N, 0.1) << "a jump of force on engaging";
}

}  // namespace
}  // namespace teleop
