#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/math/joint_vector.hpp"
#include "core/math/random.hpp"

namespace teleop::concealed {

inline constexpr std::size_t kRows = 8000;     ///< of a run
inline constexpr double kStatedPeriod = 1e-3;  ///< s

/// What one run asks of the arm: a path to follow and torques on top, at every sample.
struct Excitation {
  std::string text{};  ///< as the case file tells it
  std::vector<JointVector> path{};
  std::vector<JointVector> rate{};
  std::vector<JointVector> acceleration{};
  std::vector<JointVector> torque{};
};

enum class Movement : std::uint8_t {
  multisine,
  reaching,
  hand,
  sweeps,
  chirp,
  triangles,
  pulses,
  circles,
};
inline constexpr std::size_t kMovements = 8;

struct ExcitationWish {
  Movement movement = Movement::reaching;
  double size = 1.0;      ///< of path and torques, 1: as drawn
  JointVector inertia{};  ///< of the axes, kg m²: scales the torques
};

/// Paths stay within about 0.45 rad of the middle of the workspace, (0, 0.40, 0.25).
[[nodiscard]] Excitation draw_excitation(const ExcitationWish& wish, Random& random);

[[nodiscard]] inline JointVector middle_posture() { return {0.0, 0.40, 0.25}; }

}  // namespace teleop::concealed
