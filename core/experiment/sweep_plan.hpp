#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "core/experiment/scenario.hpp"

namespace teleop {

/// A value of a key, as TOML (text stays bare) and as JSON.
struct SweepValue {
  std::string toml{};
  std::string json{};
};

/// Keys that move together, and the values that they take.
struct SweepAxis {
  std::vector<std::string> keys{};
  std::vector<SweepValue> values{};  ///< one a step; of a Latin hypercube one a point
  bool logarithmic = false;
  std::string place{};  ///< "FILE:LINE"
};

/// Between two points on a real arm it has to rest, and to be cool where it tells its temperature.
struct SweepRest {
  double max_temperature_C = 45.0;  ///< casing; begins no point above it
  double pause_s = 10.0;            ///< where the arm tells no temperature
  double timeout_s = 1800.0;        ///< then the sweep ends
};

/// The [sweep] table of a scenario: which keys take which values.
///
///     [sweep]
///     method = "grid"          # every combination; "list": the first values of all axes, then
///                              # the second …; "latin_hypercube": `points` spread evenly
///                              // [McKay 1979]
///     [[sweep.axis]]
///     key = "law.scale"        # or keys = ["…", "…"], which move together
///     values = [1, 2, 4]       # or from = 1, to = 4, points = 3, spacing = "linear" or "log"
///
/// Everything random in point i grows from the scenario's seed and i alone, so that no result
/// depends on order, jobs or shards. With seeds = "same" every point has the scenario's own seed;
/// an axis over the key "seed" sets it.
class SweepPlan {
 public:
  enum class Method : std::uint8_t { grid, list, latin_hypercube };

  /// Makes every point's scenario once, so that a bad one is refused before any is run.
  /// @throws ConfigError naming file and line.
  explicit SweepPlan(ScenarioText text);

  [[nodiscard]] std::size_t size() const noexcept { return size_; }
  [[nodiscard]] Method method() const noexcept { return method_; }
  [[nodiscard]] const std::vector<SweepAxis>& axes() const noexcept { return axes_; }
  [[nodiscard]] const SweepRest& rest() const noexcept { return rest_; }
  [[nodiscard]] const ScenarioText& text() const noexcept { return text_; }

  /// The value of an axis at a point. @pre index < size()
  [[nodiscard]] const SweepValue& value(std::size_t axis, std::size_t index) const;

  [[nodiscard]] std::uint64_t seed(std::size_t index) const;

  /// What makes the scenario of a point. @pre index < size()
  [[nodiscard]] std::vector<Override> overrides(std::size_t index) const;

  /// Changes whenever a result could: over the file, the plants and arms it names, the program's
  /// version.
  [[nodiscard]] const std::string& fingerprint() const noexcept { return fingerprint_; }

 private:
  ScenarioText text_;
  Method method_ = Method::grid;
  std::vector<SweepAxis> axes_;
  SweepRest rest_{};
  std::size_t size_ = 0;
  std::uint64_t scenario_seed_ = 1;
  bool seed_is_swept_ = false;
  bool same_seed_ = false;
  std::string fingerprint_;
};

}  // namespace teleop
