#pragma once

#include <atomic>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/base/settings.hpp"
#include "core/ports/arm.hpp"
#include "core/realtime/clock.hpp"

namespace teleop {

class Scenario;

/// One number that an experiment found. The name ends in its unit, as columns of tables do.
struct Result {
  std::string name{};
  std::optional<double> value{};  ///< none: there was nothing to measure
  std::string unit{};
};
using Results = std::vector<Result>;

/// Whether an arm had a fault: a number whose name ends in "fault" is not 0.
[[nodiscard]] bool has_fault(const Results& results);

/// Curves for a picture; x and y in the units of the labels.
struct Figure {
  struct Curve {
    std::string label{};
    std::vector<std::pair<double, double>> points{};
    bool marks = false;  ///< separate marks instead of a line
  };
  std::string name{};  ///< of the files
  std::string title{};
  std::string x_label{};
  std::string y_label{};
  std::vector<Curve> curves{};
  bool log_x = false;
};

/// An arm that is not computed from the scenario: opened by the program, alive on its clock.
struct OpenArm {
  Arm& arm;
  Clock& clock;
};

/// What surrounds a run of an experiment.
struct ExperimentContext {
  const OpenArm* arm = nullptr;             ///< none: the scenario's plant on simulated time
  const std::atomic<bool>* stop = nullptr;  ///< set by whoever wants the run to end at once
  std::vector<Figure>* figures = nullptr;   ///< where pictures are wanted

  [[nodiscard]] bool stopped() const noexcept {
    return stop != nullptr && stop->load(std::memory_order_relaxed);
  }
};

/// One experiment with its settings. The same object may run on several threads at once.
class Experiment {
 public:
  Experiment() = default;
  Experiment(const Experiment&) = delete;
  Experiment& operator=(const Experiment&) = delete;
  Experiment(Experiment&&) = delete;
  Experiment& operator=(Experiment&&) = delete;
  virtual ~Experiment() = default;

  /// Its keys, "run." before those that are nobody else's.
  virtual void add_settings(Settings& settings) = 0;

  /// Everything that can be known to be wrong before anything moves.
  /// @throws ConfigError, best made by Scenario::refuse().
  virtual void check(const Scenario& scenario) const = 0;

  /// Numbers always in the same order, whatever the settings.
  [[nodiscard]] virtual Results run(const Scenario& scenario, ExperimentContext& context) const = 0;
};

/// One kind of experiment. Each is one file that defines one constant of this type; registry.cpp
/// lists them.
struct ExperimentKind {
  std::string_view name{};
  std::string_view text{};
  int arms = 1;           ///< 2: the scenario may give the slave a plant of its own
  bool hardware = false;  ///< it also runs on an arm that is reached through the port
  std::unique_ptr<Experiment> (*make)() = nullptr;
};

[[nodiscard]] std::span<const ExperimentKind* const> experiments() noexcept;

/// @throws ConfigError listing the names.
[[nodiscard]] const ExperimentKind& find_experiment(std::string_view name);

}  // namespace teleop
