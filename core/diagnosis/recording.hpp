#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "core/math/joint_vector.hpp"

namespace teleop {

/// One run of a machine as it was recorded: row k holds the reading taken at k · period and the
/// command that was computed from it and applied until the next one (zero-order hold).
struct Recording {
  std::string name{};                  ///< of its file, as the case lists it: "run-01.csv"
  std::string excitation{};            ///< free text
  bool held_out = false;               ///< never used for a fit
  std::vector<JointVector> tau{};      ///< commanded generalised forces, N m or N
  std::vector<JointVector> q{};        ///< readings, rad or m
  std::vector<JointVector> contact{};  ///< forces that the axes exert, as measured; empty: none

  [[nodiscard]] std::size_t rows() const noexcept { return q.size(); }
};

/// One axis of a bench of independent axes: inertia q̈ + moment sin(q) = forces.
struct BenchAxis {
  std::string name{};  ///< as answers name it
  bool prismatic = false;
  std::optional<double> inertia{};   ///< kg m² or kg; none: free
  double inertia_tolerance = 0.005;  ///< standard deviation as a share of it
  bool pendulum = false;
  std::optional<double> moment{};  ///< N m, of a pendulum; none: free
  bool free_gain = false;          ///< of its motor input: the first gain given is a start
  std::string contact_column{};    ///< of its measured contact force; empty: none
  double contact_tolerance = 0.0;  ///< standard deviation of that column's gain, 0: exact
};

/// What is to be explained: the recordings of one machine and the nominal model they are held
/// against.
struct DiagnosisCase {
  std::string name{};
  std::string plant = "phantom-1.5";             ///< name of the arm, or "rigid-axes"
  std::vector<BenchAxis> bench{};                ///< of "rigid-axes": at most three
  double period_s = 1e-3;                        ///< as stated
  JointVector resolution = JointVector::Zero();  ///< of the readings, rad or m; 0: not known
  std::vector<Recording> runs{};

  [[nodiscard]] std::size_t axes() const noexcept { return bench.empty() ? kJoints : bench.size(); }
};

}  // namespace teleop
