#pragma once

#include <vector>

#include "scenarios/concealed/law.hpp"

namespace teleop::concealed {

/// What becomes of the commands of one axis on their way to the drive: ActuationLaw up to the lag.
/// Works on averages over short spans, so that a command that arrives in the middle of one, late by
/// any real delay, gives exactly its impulse; heat and lag are solved in closed form over a span.
class Delivery {
 public:
  /// @param period of the commands, s of true time
  Delivery(const ActuationLaw& law, double period);

  /// The next command; the first one held before the start as well.
  void command(double u);

  /// Mean torque over [t, t + span] and lets that time pass. @pre spans follow each other.
  [[nodiscard]] double mean(double t, double span) noexcept;

  [[nodiscard]] double heat() const noexcept { return heat_; }

 private:
  [[nodiscard]] double arrived(double t) const noexcept;

  ActuationLaw law_;
  double period_ = 1e-3;
  bool plain_ = true;
  double last_ = 0.0;
  double heat_ = 0.0;
  double lagged_ = 0.0;
  std::vector<double> shaped_{};  ///< commands behind saturation and deadzone
};

}  // namespace teleop::concealed
