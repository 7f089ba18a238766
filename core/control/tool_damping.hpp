#pragma once

#include <string>

#include "core/base/settings.hpp"
#include "core/math/spatial.hpp"

namespace teleop {

/// Local damping of the tool against its own base, f = −B v, on in every mode but `faulted`. The
/// operator feels it as drag, so it is 0 unless the coupling alone leaves too little margin.
/// Thread: any. Loop: step neither allocates, blocks nor throws.
class ToolDamping {
 public:
  struct Config {
    double damping_Ns_per_m = 0.0;
  };

  explicit ToolDamping(const Config& config) noexcept : config_{config} {}

  /// Force on the tool for its velocity `v_BT`, both in B.
  [[nodiscard]] Vector3 step(const Vector3& v_BT) const noexcept {
    return -config_.damping_Ns_per_m * v_BT;
  }

 private:
  Config config_;
};

void add_settings(Settings& settings, const std::string& prefix, ToolDamping::Config& config);

}  // namespace teleop
