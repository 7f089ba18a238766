#pragma once

#include <array>
#include <cstddef>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/settings.hpp"
#include "core/effects/plant_terms.hpp"
#include "core/math/joint_vector.hpp"

namespace teleop {

/// Where an effect sits.
enum class Channel { actuation, joint, load, sensing, timing, environment };

/// One parameter of an effect: its key in files, what it may be and what it means.
struct EffectParameter {
  /// What a search for the effect does with it.
  enum class Role {
    fitted,
    on_evidence,  ///< stays at its standard value unless a better fit pays for it
    given,        ///< a whole number, or a thing that no recording tells
  };

  std::string_view name{};
  std::string_view unit{};
  std::string_view text{};
  Range range{};
  std::optional<double> standard{};  ///< taken when a file leaves it out; none: it must be given
  std::optional<double> neutral{};   ///< at which the effect is not there; infinity counts
  Role role = Role::fitted;
};

/// What one axis did in recordings: it tells which sizes of an effect are worth a try.
struct AxisUse {
  double torque_peak = 0.0;    ///< N m, largest command
  double torque = 0.0;         ///< N m, RMS of commands
  double speed = 0.0;          ///< rad/s, RMS
  double low = 0.0;            ///< rad, least and
  double high = 0.0;           ///< largest angle
  double inertia = 0.0;        ///< kg m²
  double drive_inertia = 0.0;  ///< kg m², share of the drive
  double ratio = 1.0;          ///< motor turns a joint turn
};
using MachineUse = std::array<AxisUse, kJoints>;

/// One place where a search starts: vectors of parameter values in the order of
/// EffectKind::parameters, each a small departure from the ideal arm in a direction of its own.
using EffectTrial = std::vector<std::vector<double>>;

/// One effect as somebody asks for it: a [[effect]] table of a plant file.
struct EffectSpec {
  std::string kind{};
  std::optional<std::size_t>
      axis{};  ///< 0 to 2; none for an effect of the whole arm. 1 to 3 in files
  std::map<std::string, double> parameters{};

  [[nodiscard]] bool operator==(const EffectSpec&) const = default;
};

class EffectValues;

/// One kind of physical effect: its name, its parameters and what it adds to the plant. Each kind
/// is one file that defines one constant of this type; kinds.hpp and vocabulary.cpp list them.
struct EffectKind {
  std::string_view name{};
  std::string_view law{};  ///< in text mathematics
  bool per_axis = true;
  bool repeatable = false;  ///< several on one axis add up; else the second one is refused
  Channel channel = Channel::joint;
  std::span<const EffectParameter> parameters{};

  /// Adds the effect to the terms; `values` are in the order of `parameters` and in their ranges.
  /// @throws ConfigError when they do not fit each other or what is there already.
  void (*plug)(PlantTerms& terms, std::size_t axis, std::span<const double> values) = nullptr;

  /// Where a search for the effect starts; none: diagnosis does not look for it.
  std::vector<EffectTrial> (*trials)(const MachineUse& use, std::size_t axis) = nullptr;

  /// The parameter values that stand for so many times each departure of a trial; none: every
  /// parameter that has a neutral value departs from it by the share of the first departure.
  std::vector<double> (*sized)(const EffectTrial& trial, std::span<const double> shares) = nullptr;

  /// The effect in one plain sentence; every kind has its own. See effect_words.hpp.
  std::string (*words)(const EffectValues& of) = nullptr;
};

/// EffectKind::sized or what stands for it. The values may be out of their ranges.
[[nodiscard]] std::vector<double> sized(const EffectKind& kind,
                                        const EffectTrial& trial,
                                        std::span<const double> shares);

[[nodiscard]] std::string_view text_of(Channel channel) noexcept;

}  // namespace teleop
