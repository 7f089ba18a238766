#pragma once

#include <optional>

#include "core/base/time.hpp"
#include "core/diagnosis/recording.hpp"
#include "core/effects/plant_terms.hpp"
#include "core/math/joint_vector.hpp"
#include "core/simulation/sensing.hpp"

namespace teleop {

/// Readings of the drives' angles, scaled, bent and late as the encoders make them, before they are
/// counted.
class ExactReading {
 public:
  /// @param m, md the drives' state at the start
  ExactReading(const PlantTerms& terms, const JointVector& m, const JointVector& md);

  /// Who has to see the plant move; none where nothing is late.
  [[nodiscard]] Sensing* observer() noexcept { return late_ ? &*late_ : nullptr; }

  /// @param m the drives' angles now
  [[nodiscard]] JointVector of(const JointVector& m) const noexcept;

 private:
  const PlantTerms* terms_;
  std::optional<Sensing> late_;
};

/// Angles of drives at rest whose reading is y, about.
[[nodiscard]] JointVector drive_angle(const PlantTerms& terms, const JointVector& y) noexcept;

/// Speed at the start of a run, from its first readings by a straight line.
[[nodiscard]] JointVector start_speed(const Recording& run, double period_s);

/// The true sample period of a machine whose stated one is period_s.
[[nodiscard]] Duration true_period(double period_s, const PlantTerms& terms);

}  // namespace teleop
