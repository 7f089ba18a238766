#pragma once

#include <optional>
#include <string_view>

#include "core/math/joint_vector.hpp"
#include "core/math/random.hpp"
#include "core/model/arm_model.hpp"
#include "scenarios/concealed/effect.hpp"

namespace teleop::concealed {

/// A kind with everything drawn but its size: which is found by search. Size 1 is a usual one,
/// larger is more visible.
class Sized {
 public:
  /// @param axis none: drawn where the kind has one.
  Sized(std::string_view kind,
        std::optional<std::size_t> axis,
        const ArmModel& arm,
        Random& random);

  [[nodiscard]] Effect at(double size) const;
  /// Sizes beyond make no device that one would still drive.
  [[nodiscard]] double largest() const noexcept { return largest_; }
  [[nodiscard]] Effect& shape() noexcept { return one_; }

 private:
  Effect one_{};
  double largest_ = 30.0;
};

}  // namespace teleop::concealed
