#include "core/experiment/scenario.hpp"

#include <atomic>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "core/base/error.hpp"
#include "core/model/dynamics.hpp"

namespace teleop {
namespace {

ScenarioText text_of(const std::string& toml) { return {.toml = toml, .file = "s.toml"}; }

std::string refusal(const std::string& toml, const std::vector<Override>& overrides = {}) {
  try {
    const Scenario scenario{text_of(toml), overrides};
  } catch (const ConfigError& error) {
    return error.what();
  }
  return "";
}

Results run(const Scenario& scenario) {
  ExperimentContext context;
  return scenario.run(context);
}

/// The number of that name; NaN where there is none.
double number(const Results& results, const std::string& name) {
  for (const Result& result : results) {
    if (result.name == name) return result.value.value_or(NAN);
  }
  ADD_FAILURE() << "no result " << name;
  return NAN;
}

struct Bad {
  const char* what;
  std::string toml;
  std::vector<std::string> names;  ///< what the one line must say
};

TEST(Scenario, IsRefusedInOneLineThatNamesPlaceAndCure) {
  const std::string teleop = "experiment = \"teleop\"\n";
  const std::string wall = "experiment = \"virtual_wall\"\n";
  const std::vector<Bad> table{
      {"not TOML", "experiment = \n", {"s.toml:1", "not TOML"}},
      {"no experiment", "seed = 1\n", {"s.toml", "experiment = "}},
      {"unknown experiment", "\nexperiment = \"dance\"\n", {"s.toml:2", "dance", "gravity"}},
      {"experiment of the wrong type", "experiment = 3\n", {"s.toml", "experiment = "}},
      {"mistyped key", teleop + "[law]\nscael = 1.0\n", {"s.toml:3", "law.scael", "law.scale"}},
      {"unknown key", teleop + "[run]\nwibble = 1\n", {"s.toml:3", "run.wibble", "run.seconds"}},
      {"unknown table", teleop + "[weather]\nrain = 1\n", {"s.toml:3", "weather.rain", "[law]"}},
      {"wrong type", teleop + "[run]\nseconds = \"long\"\n", {"s.toml:3", "run.seconds", "number"}},
      {"number for text", teleop + "[run]\nhand = 3\n", {"s.toml:3", "run.hand", "quotes"}},
      {"fraction for a count",
       "experiment = \"gravity\"\n[run]\nsteps = 1.5\n",
       {"s.toml:3", "run.steps", "whole"}},
      {"negative stiffness",
       teleop + "[law]\nstiffness_slave_N_per_m = -1.0\n",
       {"s.toml:3", "law.stiffness_slave_N_per_m", "0 or more"}},
      {"impossible bounds",
       wall + "[run]\npress_N = 8.0\npush_N = 8.0\n",
       {"s.toml:4", "run.push_N", "limits.max_force_N"}},
      {"a limit of nothing",
       wall + "[limits]\nmax_force_N = 0.0\n",
       {"s.toml:3", "limits.max_force_N", "more than 0"}},
      {"motion beyond the stops",
       "experiment = \"computed_torque\"\n[run]\namplitude_rad = [0.3, 2.5, 0.3]\n",
       {"s.toml:3", "run.amplitude_rad", "leaves the workspace"}},
      {"motion too fast",
       "experiment = \"computed_torque\"\n[run]\nfrequency_Hz = 20\n",
       {"s.toml:3", "run.frequency_Hz", "max_joint_speed"}},
      {"axis that the arm has not",
       wall + "[run]\naxis = \"w\"\n",
       {"s.toml:3", "run.axis", "no such axis", "x, y, z"}},
      {"effect on an axis that the arm has not",
       teleop + "[[plant.effect]]\nkind = \"viscous_friction\"\naxis = 4\ncoefficient = 0.1\n",
       {"s.toml:4", "axis = 4", "1, 2, 3"}},
      {"form that there is not",
       "experiment = \"frequency_response\"\n[run]\nform = \"c\"\n",
       {"s.toml:3", "run.form", "a, b"}},
      {"lines beyond what the rate can show",
       "experiment = \"frequency_response\"\n[run]\nrate_Hz = 1000\nhigh_Hz = 500\n",
       {"s.toml:4", "run.high_Hz", "0.4 of the rate"}},
      {"drive that there is not",
       "experiment = \"motor_heat\"\n[run]\ndrive = \"steam\"\n",
       {"s.toml:3", "run.drive", "linear, pwm"}},
      {"force beyond full duty",
       "experiment = \"motor_heat\"\n[run]\ndrive = \"pwm\"\nforce_N = 9\n",
       {"s.toml:4", "run.force_N", "full duty"}},
      {"unknown effect",
       teleop + "[[plant.effect]]\nkind = \"magic\"\naxis = 1\n",
       {"s.toml:3", "magic", "coulomb_friction"}},
      {"unknown key of the plant",
       teleop + "[plant.drive]\ndely = 1\n",
       {"s.toml:3", "drive.dely", "drive.delay_samples"}},
      {"unknown plant", teleop + "plant = \"phantom-9\"\n", {"s.toml:2", "phantom-9"}},
      {"unknown arm", teleop + "[plant]\narm = \"phantom-9\"\n", {"phantom-9"}},
      {"unknown hand", teleop + "[run]\nhand = \"no.csv\"\n", {"s.toml:3", "run.hand", "no.csv"}},
      {"unknown surroundings",
       teleop + "[run]\nenvironment = \"mud\"\n",
       {"s.toml:3", "run.environment", "mud", "soft"}},
      {"integrator too coarse for the friction",
       teleop + "[plant.integration]\nmax_step_ms = 1.5\n[[plant.effect]]\n"
                "kind = \"viscous_friction\"\naxis = 1\ncoefficient = 5.0\n",
       {"s.toml:3", "plant.integration.max_step_ms", "unstable", "at most"}},
      {"integrator too coarse for the hand",
       teleop + "[run]\nhand = \"hold\"\nhand_damping_Ns_per_m = 200.0\nhand_mass_kg = 0.0\n",
       {"plant.integration.max_step_ms", "unstable", "at most"}},
      {"network slower than silence",
       teleop + "[run]\nnetwork_delay_ms = 10.0\n",
       {"s.toml:3", "run.network_delay_ms", "link_timeout_ms"}},
      {"real arm for what is simulated", "device = \"usb\"\n" + teleop, {"s.toml:1", "simulated"}},
      {"second plant for one arm",
       wall + "slave_plant = \"phantom-1.5\"\n",
       {"s.toml:2", "slave_plant", "one arm"}},
  };
  for (const Bad& bad : table) {
    const std::string line = refusal(bad.toml);
    EXPECT_FALSE(line.empty()) << bad.what << ": was accepted";
    EXPECT_EQ(line.find('\n'), std::string::npos) << bad.what << ": " << line;
    for (const std::string& name : bad.names) {
      EXPECT_NE(line.find(name), std::string::npos)
          << bad.what << " names not '" << name << "': " << line;
    }
  }
}

TEST(Scenario, TakesWhatTheIntegratorCanFollow) {
  EXPECT_EQ(refusal("experiment = \"teleop\"\n[plant.integration]\nmax_step_ms = 0.1\n"
                    "[[plant.effect]]\nkind = \"viscous_friction\"\naxis = 1\ncoefficient = 5.0\n"),
            "");
}

TEST(Scenario, OfTheCatalogueLoadsAndPrintsWhatItReadsBack) {
  int files = 0;
  for (const auto& entry : std::filesystem::directory_iterator{data_file("catalogue")}) {
    const ScenarioText text = read_scenario(entry.path().string());
    const Scenario scenario{text};
    EXPECT_FALSE(scenario.text().empty()) << text.file;
    ++files;
  }
  EXPECT_GE(files, 6);
}

TEST(Scenario, OverridesReachLawRunAndEffects) {
  const ScenarioText text = text_of("experiment = \"teleop\"\n");
  const Scenario scenario{text,
                          {{"plant.effect.coulomb_friction.2.level", "0.02", "--set"},
                           {"run.seconds", "3", "--set"},
                           {"seed", "9", "--set"}}};
  EXPECT_EQ(scenario.seed(), 9U);
  EXPECT_EQ(scenario.plant().effects[4].parameters.at("level"), 0.02);
  EXPECT_EQ(scenario.slave_plant().effects[4].parameters.at("level"), 0.02);
  const Scenario other{text, {{"plant", "phantom-1.5-bare", "--set"}}};
  EXPECT_TRUE(other.plant().effects.empty());
}

TEST(Scenario, RefusesAnOverrideOfAnEffectThatThePlantHasNot) {
  const std::string line = refusal("experiment = \"teleop\"\nplant = \"phantom-1.5-bare\"\n",
                                   {{"plant.effect.coulomb_friction.2.level", "0.1", "--set"}});
  EXPECT_NE(line.find("--set: unknown key 'plant.effect.coulomb_friction.2.level'"),
            std::string::npos)
      << line;
}

TEST(Scenario, TellsTwoEffectsOfOneKindAndAxisApart) {
  const Scenario scenario{
      text_of("experiment = \"virtual_wall\"\n"
              "[[plant.effect]]\nkind = \"coulomb_friction\"\naxis = 1\nlevel = 0.01\n"
              "[[plant.effect]]\nkind = \"coulomb_friction\"\naxis = 1\nlevel = 0.02\n"),
      {{"plant.effect.coulomb_friction_2.1.level", "0.03", "--set"}}};
  EXPECT_EQ(scenario.plant().effects[0].parameters.at("level"), 0.01);
  EXPECT_EQ(scenario.plant().effects[1].parameters.at("level"), 0.03);
}

/// A response that takes as long as a test may.
constexpr const char* kQuickResponse =
    "rate_Hz = 2000\nrealisations = 4\nlow_Hz = 4\nhigh_Hz = 300\nperiods = 2\n";

TEST(Experiment, GivesTheSameNumbersTwice) {
  for (const ExperimentKind* kind : experiments()) {
    const std::string name{kind->name};
    std::string settings = "seconds = 1.5\n";
    if (name == "gravity") settings = "steps = 1\ndirections = 2\n";
    if (name == "marginal_gain") settings = "width = 0.2\n";
    if (name == "frequency_response") settings = kQuickResponse;
    const Scenario scenario{text_of("experiment = \"" + name + "\"\nseed = 7\n[run]\n" + settings)};
    const Results once = run(scenario);
    const Results again = run(scenario);
    ASSERT_EQ(once.size(), again.size()) << name;
    for (std::size_t i = 0; i < once.size(); ++i) {
      EXPECT_EQ(once[i].value, again[i].value) << name << " " << once[i].name;
      EXPECT_FALSE(once[i].unit.empty()) << name << " " << once[i].name;
    }
  }
}

TEST(Experiment, StopsWhenItIsToldTo) {
  const std::atomic<bool> stop{true};
  for (const ExperimentKind* kind : experiments()) {
    const Scenario scenario{text_of("experiment = \"" + std::string{kind->name} + "\"\n")};
    ExperimentContext context{.stop = &stop};
    EXPECT_EQ(number(scenario.run(context), kind->name == "teleop" ? "master_fault" : "fault"), 0.0)
        << kind->name;
  }
}

TEST(TeleopExperiment, TheHandFeelsTheWall) {
  const Results results = run(Scenario{read_scenario("wall")});
  EXPECT_NEAR(number(results, "wall_ratio"), 1.0, 0.1);
  EXPECT_GT(number(results, "wall_force_N"), 1.0);
  EXPECT_EQ(number(results, "slave_fault"), 0.0);
}

TEST(TeleopExperiment, FollowsAReachingHandAndLessWellWithASofterCoupling) {
  const Results stiff = run(Scenario{read_scenario("free-motion")});
  EXPECT_LT(number(stiff, "tracking_rms_mm"), 2.0);
  EXPECT_GT(number(stiff, "engaged_share"), 0.9);
  const Results soft = run(Scenario{read_scenario("free-motion"),
                                    {{"law.stiffness_master_N_per_m", "200", "test"},
                                     {"law.stiffness_slave_N_per_m", "200", "test"}}});
  EXPECT_GT(number(soft, "tracking_rms_mm"), 2.0 * number(stiff, "tracking_rms_mm"));
}

TEST(MarginalGainExperiment, FindsTheWallOfThePaperWithinATenth) {
  const Results results = run(Scenario{read_scenario("wall-margin")});
  EXPECT_NEAR(number(results, "gain") / 2700.0, 1.0, 0.1);
  EXPECT_LT(number(results, "gain_low"), number(results, "gain"));
  EXPECT_GT(number(results, "gain_high"), number(results, "gain"));
}

TEST(FrequencyResponseExperiment, FindsThePlantedStructure) {
  const Results results = run(Scenario{read_scenario("x-axis-response")});
  // What scenarios/catalogue/x-axis-response.toml plants, at the tool.
  const ArmModel arm = load_arm("phantom-1.5");
  const double lever2 = std::pow(arm.parameters().l1_m, 2);
  const double mass = mass_matrix(arm, JointVector::Zero())(0, 0) / lever2;
  const double m1 = 7.0e-4 / lever2;
  const double m2 = number(results, "m2_kg");
  const double k = number(results, "k_N_per_m");
  EXPECT_NEAR(k / (263.0 / lever2), 1.0, 0.02);
  EXPECT_NEAR(number(results, "m1_kg") / m1, 1.0, 0.02);
  EXPECT_NEAR(m2 / (mass - m1), 1.0, 0.02);
  EXPECT_NEAR(number(results, "b_Ns_per_m") / (0.0462 / lever2), 1.0, 0.1);
  const double antiresonance = std::sqrt(k / m2) / (2.0 * std::numbers::pi);
  EXPECT_NEAR(number(results, "antiresonance_Hz") / antiresonance, 1.0, 0.03);
  EXPECT_GT(number(results, "resonance_Hz"), number(results, "antiresonance_Hz"));
  EXPECT_LT(number(results, "gain_error"), 0.05);
  EXPECT_EQ(number(results, "fault"), 0.0);
}

TEST(MotorHeatExperiment, WarmsTheCasingAsTheReproductionDoes) {
  const Results linear = run(Scenario{read_scenario("motor-heat")});
  EXPECT_NEAR(number(linear, "casing_rise_K") / 14.5, 1.0, 0.1);
  EXPECT_GT(number(linear, "winding_rise_K"), number(linear, "casing_rise_K"));
  EXPECT_NEAR(number(linear, "torque_loss"), 0.0, 1e-9);  // the current is held
  const Results pwm = run(Scenario{read_scenario("motor-heat"), {{"run.drive", "pwm", "test"}}});
  EXPECT_NEAR(number(pwm, "casing_rise_K") / 34.5, 1.0, 0.1);
  EXPECT_GT(number(pwm, "torque_loss"), 0.05);  // the duty is held, the copper warms
  EXPECT_EQ(number(pwm, "seconds"), 600.0);
}

TEST(GravityExperiment, CarriesTheArmToTheEdgeAndLetsItFallWithout) {
  const Results results = run(Scenario{read_scenario("gravity")});
  EXPECT_LT(number(results, "drift_mm"), 0.1);
  EXPECT_GE(number(results, "drift_without_mm"), 20.0);
  EXPECT_EQ(number(results, "poses"), 25.0);
  EXPECT_EQ(number(results, "fault"), 0.0);
}

TEST(GravityExperiment, FindsAWeightThatIsNotCarried) {
  const Results results =
      run(Scenario{read_scenario("gravity"), {{"gravity.share", "0.5", "test"}}});
  EXPECT_GT(number(results, "drift_mm"), 10.0);
}

TEST(ComputedTorqueExperiment, BeatsPlainPdByFarOnAnArmThatIsTheModel) {
  const Results results = run(Scenario{read_scenario("computed-torque")});
  EXPECT_GT(number(results, "pd_over_computed_torque"), 5.0);
  EXPECT_LT(number(results, "error_rms_mm"), 1.0);
  EXPECT_EQ(number(results, "fault"), 0.0);
}

TEST(VirtualWallExperiment, DiesAwayWhenSoftAndSwingsWhenTooStiff) {
  const ScenarioText text = text_of("experiment = \"virtual_wall\"\n[run]\naxis = \"y\"\n");
  const Results soft = run(Scenario{text, {{"run.stiffness_N_per_m", "1000", "test"}}});
  EXPECT_LT(number(soft, "oscillation_mm"), 0.1);
  EXPECT_NEAR(number(soft, "depth_mm"), 1.0, 0.1);  // 1 N on 1 N/mm
  const Results stiff = run(Scenario{text, {{"run.stiffness_N_per_m", "6000", "test"}}});
  EXPECT_GT(number(stiff, "oscillation_mm"), 0.5);
}

}  // namespace
}  // namespace teleop
