#include "core/experiment/arm_rig.hpp"

#include <filesystem>
#include <map>
#include <string>

#include <gtest/gtest.h>

#include "core/base/error.hpp"
#include "core/experiment/sweep.hpp"
#include "core/simulation/arm_sim.hpp"
#include "tests/support/no_allocation.hpp"
#include "tests/support/temporary_folder.hpp"

namespace teleop {
namespace {

using testing::NoAllocation;
using testing::TemporaryFolder;

/// A simulated arm that says it is hardware, with motors that warm up while the amplifiers are on
/// and cool down while they are off; simulated time stands in for the machine's.
class ScriptedArm final : public Arm {
 public:
  struct Script {
    bool tells_temperature = true;
    double heating_C_per_s = 5.0;
    double cooling_C_per_s = 1.0;
    double coldest_C = 20.0;
    Fault fault = Fault::none;
    int faulty_start = 0;  ///< the fault shows while it is on for the n-th time
  };

  ScriptedArm(const Script& script, Clock& clock)
      : script_{script},
        clock_{clock},
        arm_{{.plant = load_plant("phantom-1.5")}, clock},
        info_{arm_.info()},
        temperature_C_{script.coldest_C},
        last_{clock.now()} {
    info_.name = "scripted";
    info_.simulated = false;
  }

  [[nodiscard]] const ArmInfo& info() const noexcept override { return info_; }
  [[nodiscard]] ArmState read() noexcept override {
    const double dt = seconds(clock_.now() - last_);
    last_ = clock_.now();
    temperature_C_ += dt * (on_ ? script_.heating_C_per_s : -script_.cooling_C_per_s);
    temperature_C_ = std::max(temperature_C_, script_.coldest_C);
    ArmState state = arm_.read();
    if (script_.tells_temperature) {
      state.set(ArmFlag::has_temperatures);
      state.motor_temperature = JointVector::Constant(temperature_C_);
    }
    if (on_ && starts_ == script_.faulty_start) state.fault = script_.fault;
    return state;
  }
  void write(const JointVector& tau) noexcept override { arm_.write(tau); }
  void amplifiers(bool on) noexcept override {
    if (on && !on_) {
      ++starts_;
      warmest_start_C_ = std::max(warmest_start_C_, temperature_C_);
      fastest_start_ = std::max(fastest_start_, arm_.true_state().qd.cwiseAbs().maxCoeff());
    }
    on_ = on;
    arm_.amplifiers(on);
  }

  [[nodiscard]] bool on() const noexcept { return on_; }
  [[nodiscard]] int starts() const noexcept { return starts_; }
  [[nodiscard]] double warmest_start_C() const noexcept { return warmest_start_C_; }
  [[nodiscard]] double fastest_start() const noexcept { return fastest_start_; }

 private:
  Script script_;
  Clock& clock_;
  SimulatedArm arm_;
  ArmInfo info_;
  double temperature_C_;
  Instant last_;
  bool on_ = false;
  int starts_ = 0;
  double warmest_start_C_ = 0.0;
  double fastest_start_ = 0.0;
};

ScenarioText text_of(const std::string& toml) { return {.toml = toml, .file = "s.toml"}; }

const std::string kSweep =
    "device = \"usb\"\nexperiment = \"virtual_wall\"\n[run]\nseconds = 2.0\n[sweep]\n"
    "[[sweep.axis]]\nkey = \"run.stiffness_N_per_m\"\nvalues = [500, 700, 900, 1100]\n"
    "[sweep.rest]\nmax_temperature_C = 25.0\npause_s = 4.0\ntimeout_s = 600.0\n";

TEST(SweepOnAnArm, BeginsEveryPointAtRestAndCool) {
  const TemporaryFolder folder;
  const SweepPlan plan{text_of(kSweep)};
  SimulatedClock clock;
  ScriptedArm arm{{.cooling_C_per_s = 0.2}, clock};
  SweepStore store{folder.path(), plan, {}};
  EXPECT_TRUE(run_sweep_on_arm(plan, store, {.arm = arm, .clock = clock}, {}));
  EXPECT_EQ(store.lines().size(), 4U);
  EXPECT_GE(arm.starts(), 4);
  EXPECT_LE(arm.warmest_start_C(), 25.0);
  EXPECT_LT(arm.fastest_start(), 1e-3);
  EXPECT_FALSE(arm.on());
}

TEST(SweepOnAnArm, PausesWhereNoTemperatureIsTold) {
  SimulatedClock clock;
  ScriptedArm arm{{.tells_temperature = false}, clock};
  EXPECT_TRUE(wait_for_rest({.arm = arm, .clock = clock}, {.pause_s = 4.0}, nullptr));
  EXPECT_GE(seconds(clock.now().time_since_epoch()), 4.0);
  EXPECT_LT(seconds(clock.now().time_since_epoch()), 60.0);  // an arm let go slides for long
}

TEST(SweepOnAnArm, GivesUpOnOneThatStaysHot) {
  SimulatedClock clock;
  ScriptedArm arm{{.coldest_C = 70.0}, clock};
  try {
    (void)wait_for_rest({.arm = arm, .clock = clock}, {.timeout_s = 60.0}, nullptr);
    FAIL() << "began on a hot arm";
  } catch (const DeviceError& error) {
    EXPECT_NE(std::string{error.what()}.find("above 45 C"), std::string::npos) << error.what();
  }
}

TEST(SweepOnAnArm, EndsAtAFaultKeepsThePointAndLeavesTheArmLimp) {
  const TemporaryFolder folder;
  const SweepPlan plan{text_of(kSweep)};
  SimulatedClock clock;
  ScriptedArm arm{{.tells_temperature = false, .fault = Fault::encoder_jump, .faulty_start = 2},
                  clock};
  {
    SweepStore store{folder.path(), plan, {}};
    EXPECT_FALSE(run_sweep_on_arm(plan, store, {.arm = arm, .clock = clock}, {}));
    EXPECT_EQ(store.lines().size(), 2U);
    EXPECT_NE(store.lines().at(1).find("\"fault\":6"), std::string::npos) << store.lines().at(1);
  }
  EXPECT_FALSE(arm.on());

  ScriptedArm mended{{.tells_temperature = false}, clock};
  SweepStore again{folder.path(), plan, {}};
  EXPECT_TRUE(run_sweep_on_arm(plan, again, {.arm = mended, .clock = clock}, {}));
  EXPECT_EQ(again.lines().size(), 4U);
}

TEST(SweepOnAnArm, FindsWhatTheSimulationOfTheSamePlantFinds) {
  const Scenario scenario{text_of("experiment = \"computed_torque\"\n")};
  SimulatedClock clock;
  ScriptedArm arm{{}, clock};
  const OpenArm open{.arm = arm, .clock = clock};
  ExperimentContext through_port{.arm = &open};
  ExperimentContext simulated;
  const Results there = scenario.run(through_port);
  const Results here = scenario.run(simulated);
  for (std::size_t i = 0; i < here.size(); ++i) {
    EXPECT_EQ(here[i].value, there[i].value) << here[i].name;
  }
}

TEST(ArmRig, CutsTheTorqueWhenAJointRunsAway) {
  const Scenario scenario{text_of("experiment = \"virtual_wall\"\nplant = \"phantom-1.5-bare\"\n")};
  SimulatedClock clock;
  ScriptedArm arm{{}, clock};
  const OpenArm open{.arm = arm, .clock = clock};
  const ExperimentContext context{.arm = &open};
  ArmRig rig{{.max_joint_speed_rad_per_s = 5.0}, scenario, context};
  const auto ending = rig.run(2.0, [](const ArmTurn&) noexcept {
    return std::optional<JointVector>{JointVector{1.0, 0.0, 0.0}};
  });
  EXPECT_EQ(ending, ArmRig::Ending::fault);
  EXPECT_EQ(rig.fault(), Fault::joint_speed_exceeded);
  EXPECT_FALSE(arm.on());
  EXPECT_EQ(rig.move_to(JointVector::Zero(), 0.5, 0.0), ArmRig::Ending::fault);
}

TEST(ArmRig, AllocatesNothingInItsLoop) {
  if (!NoAllocation::is_armed()) GTEST_SKIP() << "a sanitizer owns malloc";
  const Scenario scenario{text_of("experiment = \"virtual_wall\"\n")};
  const ExperimentContext context;
  ArmRig rig{{}, scenario, context};
  const NoAllocation guard;
  (void)rig.move_to({0.1, 0.1, -0.1}, 0.5, 0.2);
  EXPECT_EQ(guard.count(), 0U);
  EXPECT_LT((rig.q() - JointVector{0.1, 0.1, -0.1}).norm(), 1e-2);  // friction holds it there
}

}  // namespace
}  // namespace teleop
