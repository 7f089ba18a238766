#pragma once

#include <optional>
#include <string_view>

#include "core/math/spatial.hpp"

namespace teleop {

/// Something that the tool touches from outside: a compliant surface without friction. With depth
/// p > 0 of the tool under the surface and outward normal n, the force on the tool is F n,
///
///     spring and damper   F = max(0, k p + d ṗ)              [Kelvin–Voigt]
///     Hunt–Crossley       F = max(0, k p^e (1 + λ ṗ))        [Hunt, Crossley 1975]
///
/// so it pushes and never pulls. Positions and forces in the arm's base B, SI.
/// Loop: allocation-free, noexcept.
class Contact {
 public:
  enum class Shape { plane, sphere };
  enum class Law { spring_damper, hunt_crossley };

  struct Config {
    Shape shape = Shape::plane;
    Law law = Law::spring_damper;
    Vector3 point_m = Vector3::Zero();  ///< on the plane, or the sphere's centre
    Vector3 normal = Vector3::UnitX();  ///< of the plane, out of the material
    double radius_m = 0.0;              ///< of the sphere
    double stiffness = 0.0;             ///< k, N/m or N/m^e
    double exponent = 1.5;              ///< e of Hunt–Crossley
    double damping = 0.0;               ///< d in N s/m, or λ in s/m
  };

  /// Where the tool is against the surface.
  struct Depth {
    double p = 0.0;                     ///< m, positive inside
    double p_rate = 0.0;                ///< m/s
    Vector3 normal = Vector3::UnitX();  ///< out of the material
  };

  /// @throws ConfigError when a number is negative or not finite, the normal has no length, the
  ///         sphere no radius, the surface no stiffness or the exponent is below 1.
  explicit Contact(const Config& config);

  [[nodiscard]] Depth depth(const Vector3& p_BT, const Vector3& v_BT) const noexcept;

  /// Positive where the surface pushes, negative where it does not; continuous, so that its zero is
  /// the instant of touching or leaving. In m.
  [[nodiscard]] double push_margin(const Depth& depth) const noexcept;

  /// F without the cut at zero: smooth across making and breaking, for use between those instants.
  [[nodiscard]] double smooth_force(const Depth& depth) const noexcept;

  /// F of the law.
  [[nodiscard]] double force(const Depth& depth) const noexcept {
    return push_margin(depth) > 0.0 ? smooth_force(depth) : 0.0;
  }

  /// Energy stored by the surface at a depth, J.
  [[nodiscard]] double stored_energy(const Depth& depth) const noexcept;

  /// Fastest rate at which a mass moves against the surface, 1/s; Hunt–Crossley down to 20 mm.
  [[nodiscard]] double rate(double mass_kg) const noexcept;

  [[nodiscard]] const Config& config() const noexcept { return config_; }

 private:
  Config config_;
};

/// Where the surfaces of environment() are: that far to the right of home, m.
inline constexpr double kSurfaceOffset = 0.02;

/// The surroundings by the name that command lines use: "free" (none), "soft" or "wall", both a
/// plane across x at kSurfaceOffset, so that yawing to the right meets it.
/// @throws ConfigError listing the names.
[[nodiscard]] std::optional<Contact> environment(std::string_view name);

}  // namespace teleop
