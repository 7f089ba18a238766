#include "core/estimation/quantum.hpp"

#include <numbers>

#include "core/base/error.hpp"

namespace teleop {

JointVector encoder_quantum(const JointVector& counts_per_rev) {
  if (!counts_per_rev.allFinite() || counts_per_rev.cwiseAbs().minCoeff() <= 0.0) {
    throw ConfigError{
        "velocity estimate: the arm does not say its encoder counts per revolution; take kind "
        "'difference' or 'mean'"};
  }
  return 2.0 * std::numbers::pi * counts_per_rev.cwiseAbs().cwiseInverse();
}

}  // namespace teleop
