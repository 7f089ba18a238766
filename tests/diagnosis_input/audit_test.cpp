#include "core/diagnosis/audit.hpp"

#include <algorithm>
#include <functional>
#include <numbers>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "core/base/error.hpp"
#include "core/diagnosis/case_folder.hpp"
#include "tests/diagnosis_input/made_runs.hpp"

namespace teleop {
namespace {

using testing::complaints;
using testing::made_case;

// --- planted faults, in the second run of a sound case

using Plant = void (*)(DiagnosisCase& of, Recording& run);

struct Planted {
  const char* name;
  Plant plant;
  const char* kind;
  Severity severity;
  const char* column;
  std::size_t row;  ///< of the file; 0: whichever
};

class PlantedFault : public ::testing::TestWithParam<Planted> {
 protected:
  static DiagnosisCase sound() { return made_case(testing::ideal_plant(), 31); }
};

TEST_P(PlantedFault, IsFoundAndNothingElse) {
  const Planted& planted = GetParam();
  DiagnosisCase of = sound();
  planted.plant(of, of.runs[1]);

  const Audit found = audit(of);

  std::set<std::string> kinds;
  for (const Finding& finding : found.findings) {
    kinds.insert(finding.kind);
  }
  EXPECT_EQ(kinds, std::set<std::string>{planted.kind}) << complaints(found);
  const auto match =
      std::find_if(found.findings.begin(), found.findings.end(), [&](const Finding& finding) {
        return finding.kind == planted.kind && finding.column == planted.column &&
               finding.severity == planted.severity &&
               (planted.row == 0 || finding.row == planted.row);
      });
  EXPECT_NE(match, found.findings.end()) << complaints(found);
  EXPECT_EQ(found.fatal(), planted.severity == Severity::fatal);
  if (found.fatal()) {
    EXPECT_THROW(refuse_fatal(found), ConfigError);
  } else {
    EXPECT_NO_THROW(refuse_fatal(found));
  }
}

void swap_axes(std::vector<JointVector>& rows, Eigen::Index a, Eigen::Index b) {
  for (JointVector& row : rows) {
    std::swap(row[a], row[b]);
  }
}

void scale(std::vector<JointVector>& rows, Eigen::Index axis, double factor) {
  for (JointVector& row : rows) {
    row[axis] *= factor;
  }
}

void cut(Recording& run, std::size_t first, std::size_t last) {
  const auto erase = [&](auto& rows) {
    rows.erase(rows.begin() + static_cast<std::ptrdiff_t>(first),
               rows.begin() + static_cast<std::ptrdiff_t>(last));
  };
  erase(run.t_s);
  erase(run.q);
  erase(run.tau);
}

/// A run that stands still and whose command does too.
void freeze(Recording& run) {
  run.q.assign(run.rows(), run.q.front());
  run.tau.assign(run.rows(), run.tau.front());
}

/// The delivered torques as they would be measured: those of the row before.
std::vector<JointVector> delivered(const std::vector<JointVector>& tau) {
  std::vector<JointVector> measured{tau.begin(), tau.end() - 1};
  measured.insert(measured.begin(), tau.front());
  return measured;
}

constexpr auto kWarning = Severity::warning;
constexpr auto kFatal = Severity::fatal;

INSTANTIATE_TEST_SUITE_P(
    All,
    PlantedFault,
    ::testing::Values(
        Planted{"WrongRate", [](auto& of, auto&) { of.period_s = 2e-3; }, "wrong_rate", kFatal,
                "t_s", 3},
        Planted{"Gap", [](auto&, auto& run) { cut(run, 500, 507); }, "gap", kFatal, "t_s", 502},
        Planted{"TimeStands", [](auto&, auto& run) { run.t_s[70] = run.t_s[69]; }, "repeated_time",
                kFatal, "t_s", 72},
        Planted{"TimeGoesBack", [](auto&, auto& run) { run.t_s[70] = 0.0; }, "repeated_time", kFatal,
                "t_s", 72},
        Planted{"OneLateRow", [](auto&, auto& run) { run.t_s[70] += 0.8e-3; }, "jitter", kWarning,
                "t_s", 72},
        Planted{"Jitter",
                [](auto&, auto& run) {
                  Random random{1};
                  for (double& stamp : run.t_s) {
                    stamp += random.uniform(-2e-4, 2e-4);
                  }
                },
                "jitter", kWarning, "t_s", 0},
        Planted{"RepeatedRow",
                [](auto&, auto& run) {
                  // Where joint 1 is fast, by the file's own numbers.
                  for (std::size_t k = 1500; k + 2 < run.rows(); ++k) {
                    if (std::abs(run.q[k][0] - run.q[k - 1][0]) < 6e-4) continue;
                    run.q[k + 1] = run.q[k];
                    run.tau[k + 1] = run.tau[k];
                    return;
                  }
                },
                "repeated_rows", kWarning, "", 0},
        Planted{"Saturation",
                [](auto&, auto& run) {
                  double largest = 0.0;
                  for (const JointVector& tau : run.tau) {
                    largest = std::max(largest, std::abs(tau[0]));
                  }
                  for (JointVector& tau : run.tau) {
                    tau[0] = std::clamp(tau[0], -0.00001 * std::round(5e4 * largest),
                                        0.00001 * std::round(5e4 * largest));
                  }
                },
                "saturation", kWarning, "tau1_Nm", 0},
        Planted{"DeadEncoder",
                [](auto&, auto& run) {
                  for (JointVector& q : run.q) {
                    q[1] = run.q.front()[1];
                  }
                },
                "constant_column", kWarning, "q2_rad", 2},
        Planted{"DeadCommand", [](auto&, auto& run) { scale(run.tau, 2, 0.0); }, "constant_column",
                kWarning, "tau3_Nm", 2},
        Planted{"SwappedCommands", [](auto&, auto& run) { swap_axes(run.tau, 0, 1); },
                "swapped_columns", kFatal, "tau2_Nm", 2},
        Planted{"SwappedCommandsOfTwoAndThree", [](auto&, auto& run) { swap_axes(run.tau, 1, 2); },
                "swapped_columns", kFatal, "tau3_Nm", 2},
        Planted{"SwappedReadings", [](auto&, auto& run) { swap_axes(run.q, 1, 2); },
                "swapped_columns", kFatal, "tau3_Nm", 2},
        Planted{"RotatedCommands",
                [](auto&, auto& run) {
                  swap_axes(run.tau, 0, 1);
                  swap_axes(run.tau, 1, 2);
                },
                "swapped_columns", kFatal, "tau3_Nm", 2},
        Planted{"Millinewtonmetres", [](auto&, auto& run) { scale(run.tau, 1, 1e3); }, "wrong_units",
                kFatal, "tau2_Nm", 2},
        Planted{"Degrees",
                [](auto&, auto& run) { scale(run.q, 1, 180.0 / std::numbers::pi); },
                "wrong_readings", kFatal, "q2_rad", 0},
        Planted{"OtherEncoder", [](auto&, auto& run) { scale(run.q, 2, 1.0123); }, "wrong_readings",
                kFatal, "q3_rad", 0},
        Planted{"FarAway",
                [](auto& of, auto& run) {
                  for (JointVector& q : run.q) {
                    q[0] += 40000.0 * of.resolution[0];
                  }
                },
                "wrong_readings", kFatal, "q1_rad", 2},
        Planted{"DamagedReading", [](auto& of, auto& run) { run.q[99][0] += 0.4 * of.resolution[0]; },
                "off_grid", kWarning, "q1_rad", 101},
        Planted{"WrongSign", [](auto&, auto& run) { scale(run.tau, 0, -1.0); }, "wrong_sign", kFatal,
                "tau1_Nm", 2},
        Planted{"MeasuredForCommanded",
                [](auto&, auto& run) {
                  Random random{3};
                  for (JointVector& tau : run.tau) {
                    tau[1] += random.normal() * 1e-4;
                  }
                },
                "off_command_step", kWarning, "tau2_Nm", 0},
        Planted{"SwappedCurrents",
                [](auto&, auto& run) {
                  run.measured = delivered(run.tau);
                  std::swap(run.measured, run.tau);
                },
                "swapped_currents", kFatal, "tau1_Nm", 2},
        Planted{"ShortRun", [](auto&, auto& run) { cut(run, 300, run.rows()); }, "short_run", kWarning,
                "", 2},
        Planted{"TooShort",
                [](auto& of, auto& run) {
                  run.held_out = true;
                  cut(of.runs[0], 700, of.runs[0].rows());
                },
                "too_short", kFatal, "", 0},
        Planted{"Note", [](auto&, auto& run) { run.notes.emplace_back("not used: i1_A"); },
                "note", Severity::note, "", 0}),
    [](const auto& one) { return std::string{one.param.name}; });

TEST(Audit, NeedsNoTimeStamps) {
  DiagnosisCase of = made_case(testing::ideal_plant(), 49);
  for (Recording& run : of.runs) {
    run.t_s.clear();
  }
  EXPECT_EQ(complaints(audit(of)), "");
  scale(of.runs[0].tau, 0, -1.0);
  EXPECT_NE(complaints(audit(of)).find("wrong_sign"), std::string::npos);
}

TEST(Audit, SaysWhenNothingMoves) {
  DiagnosisCase of = made_case(testing::ideal_plant(), 41);
  for (Recording& run : of.runs) {
    freeze(run);
  }
  const Audit found = audit(of);
  EXPECT_NE(complaints(found).find("fatal no_excitation"), std::string::npos) << complaints(found);
  EXPECT_NE(complaints(found).find("constant_column"), std::string::npos);
}

TEST(Audit, SaysWhichAxisDoesNotMove) {
  DiagnosisCase of = made_case(testing::ideal_plant(), 42);
  for (Recording& run : of.runs) {
    for (JointVector& q : run.q) {
      q[2] = std::round(0.25 / of.resolution[2]) * of.resolution[2];
    }
  }
  const Audit found = audit(of);
  EXPECT_FALSE(found.fatal());
  EXPECT_NE(complaints(found).find("little_motion: made: q3_rad"), std::string::npos)
      << complaints(found);
}

TEST(Audit, NamesTheRowThatWasWrittenTwice) {
  DiagnosisCase of = made_case(testing::ideal_plant(), 46);
  Recording& run = of.runs[0];
  std::size_t k = 1500;
  while (std::abs(run.q[k][0] - run.q[k - 1][0]) < 6e-4) {
    ++k;
  }
  run.q[k + 1] = run.q[k];
  run.tau[k + 1] = run.tau[k];
  const Audit found = audit(of);
  ASSERT_EQ(found.findings.size(), 1U) << complaints(found);
  EXPECT_EQ(found.findings.front().row, run.first_row + k + 1);
}

/// Repeats at rest are nothing: a controller that sees no motion changes nothing.
TEST(Audit, LetsRowsRepeatAtRest) {
  DiagnosisCase of = made_case(testing::ideal_plant(), 47);
  Recording& run = of.runs[0];
  run.q.insert(run.q.begin(), 300, run.q.front());
  run.tau.insert(run.tau.begin(), 300, run.tau.front());
  run.q.resize(run.t_s.size());
  run.tau.resize(run.t_s.size());
  EXPECT_EQ(complaints(audit(of)), "");
}

TEST(Audit, NamesTheRowWhereACommandBeginsToSaturate) {
  DiagnosisCase of = made_case(testing::ideal_plant(), 48);
  Recording& run = of.runs[0];
  const double limit = 5.0;
  for (std::size_t k = 2000; k < 2100; ++k) {
    run.tau[k][1] = -limit;
  }
  run.tau[100][1] = limit;  // one large row is none
  const Audit found = audit(of);
  const auto saturation =
      std::find_if(found.findings.begin(), found.findings.end(),
                   [](const Finding& finding) { return finding.kind == "saturation"; });
  ASSERT_NE(saturation, found.findings.end()) << complaints(found);
  EXPECT_EQ(saturation->row, run.first_row + 2000);
  EXPECT_EQ(saturation->column, "tau2_Nm");
}

TEST(Audit, CountsRowsAsTheFileDoes) {
  DiagnosisCase of = made_case(testing::ideal_plant(), 43);
  of.runs[0].first_row = 1002;  // a window
  of.runs[0].file = "data/run.csv";
  of.runs[0].t_s[10] = of.runs[0].t_s[9];
  const Audit found = audit(of);
  ASSERT_TRUE(found.fatal());
  EXPECT_TRUE(line_of(found.findings.front()).starts_with("data/run.csv:1012: t_s: "))
      << line_of(found.findings.front());
}

TEST(Audit, TakesMeasuredTorquesThatFollowTheCommandForSound) {
  DiagnosisCase of = made_case(testing::ideal_plant(), 44);
  for (Recording& run : of.runs) {
    run.measured = delivered(run.tau);
  }
  EXPECT_EQ(complaints(audit(of)), "");
}

/// The same of benches, whose inertia may not be known.
TEST(Audit, FindsSignAndUnitsOfABench) {
  DiagnosisCase of = made_case(testing::ideal_plant(), 45);
  of.plant = "rigid-axes";
  of.command_step = 0.0;
  of.bench = {{.name = "a", .inertia = 3.7e-3, .position_column = "a_rad", .motor_column = "a_Nm"},
              {.name = "b", .position_column = "b_rad", .motor_column = "b_Nm"}};
  EXPECT_EQ(complaints(audit(of)), "");
  scale(of.runs[0].tau, 0, 1e3);
  scale(of.runs[0].tau, 1, -1e3);
  const std::string said = complaints(audit(of));
  EXPECT_NE(said.find("warning wrong_units: run-45.csv:2: a_Nm"), std::string::npos) << said;
  EXPECT_NE(said.find("fatal wrong_sign: run-45.csv:2: b_Nm"), std::string::npos) << said;
}

}  // namespace
}  // namespace teleop
