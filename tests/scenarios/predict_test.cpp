#include <cmath>
#include <fstream>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/diagnosis/made_case.hpp"
#include "tests/support/command.hpp"
#include "tests/support/temporary_folder.hpp"

namespace teleop {
namespace {

using testing::Finished;
using testing::TemporaryFolder;

/// A case whose third axis has dry friction.
void write_case(const TemporaryFolder& folder, double level) {
  const DiagnosisCase data = testing::make_case(
      {.effects = {{.kind = "coulomb_friction", .axis = 2, .parameters = {{"level", level}}}},
       .runs = 1});
  std::string toml =
      "case = \"made\"\nplant = \"phantom-1.5\"\nsample_rate_Hz = 1000\n"
      "encoder_counts_per_joint_revolution = [54476.8, 45875.2, 45875.2]\n"
      "torque_command_step_Nm = 0.00001\n[[run]]\nfile = \"run-01.csv\"\n";
  static_cast<void>(folder.write("case.toml", toml));
  std::string csv = "t_s,tau1_Nm,tau2_Nm,tau3_Nm,q1_rad,q2_rad,q3_rad\n";
  const Recording& run = data.runs.front();
  for (std::size_t k = 0; k < run.rows(); ++k) {
    csv += fmt::format("{:.3f},{:.5f},{:.5f},{:.5f},{:.7f},{:.7f},{:.7f}\n",
                       static_cast<double>(k) / 1000.0, run.tau[k][0], run.tau[k][1], run.tau[k][2],
                       run.q[k][0], run.q[k][1], run.q[k][2]);
  }
  static_cast<void>(folder.write("run-01.csv", csv));
}

nlohmann::json prediction(const TemporaryFolder& folder, const std::string& model) {
  const auto out = folder.path() / "out.json";
  const Finished finished =
      testing::run(fmt::format("teleop predict --model {} {} --json {}", model,
                               (folder.path() / "run-01.csv").string(), out.string()));
  EXPECT_EQ(finished.exit_code, 0) << finished.output;
  std::ifstream file{out};
  return nlohmann::json::parse(file).at("runs").at(0);
}

TEST(Predict, TellsTheModelThatFitsFromTheOneThatDoesNot) {
  const TemporaryFolder folder;
  write_case(folder, 0.006);
  const auto model = folder.write("model.toml",
                                  "arm = \"phantom-1.5\"\n[[effect]]\nkind = \"coulomb_friction\"\n"
                                  "axis = 3\nlevel = 0.006\n");
  const auto nominal = prediction(folder, "phantom-1.5-bare");
  const auto corrected = prediction(folder, model.string());
  const auto third = [](const nlohmann::json& run, const char* key) {
    return run.at(key).at(2).get<double>();
  };
  EXPECT_GT(third(nominal, "innovation_rms_over_floor"), 1.2);
  EXPECT_LT(third(corrected, "innovation_rms_over_floor"), 1.05);
  EXPECT_GT(third(nominal, "free_run_rmse"), 3.0 * third(corrected, "free_run_rmse"));
  EXPECT_GT(third(nominal, "nrmse"), third(corrected, "nrmse"));
}

TEST(Predict, RefusesARecordingWithoutACase) {
  const TemporaryFolder folder;
  const auto csv = folder.write("run-01.csv", "t_s\n0\n");
  const Finished finished = testing::run("teleop predict " + csv.string());
  EXPECT_EQ(finished.exit_code, 2);
  EXPECT_NE(finished.output.find("no case.toml beside it"), std::string::npos) << finished.output;
}

TEST(Diagnose, RefusesBadInputBeforeAnythingIsWritten) {
  const TemporaryFolder folder;
  write_case(folder, 0.006);
  const auto answers = folder.path() / "answers";
  std::ofstream{folder.path() / "run-01.csv", std::ios::app} << "9.000,x,0,0,0,0,0\n";
  const Finished finished = testing::run(
      fmt::format("teleop diagnose {} --json-dir {}", folder.path().string(), answers.string()));
  EXPECT_EQ(finished.exit_code, 2);
  EXPECT_NE(finished.output.find("run-01.csv"), std::string::npos) << finished.output;
  EXPECT_FALSE(std::filesystem::exists(answers));
}

}  // namespace
}  // namespace teleop
