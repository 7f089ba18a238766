#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "core/diagnosis/recording.hpp"
#include "core/math/joint_vector.hpp"
#include "core/model/arm_model.hpp"
#include "scenarios/regression/regressor.hpp"

namespace teleop {

/// A regressor on one axis at one point of its grid, and where its columns stand in the design.
struct Form {
  const Regressor* regressor = nullptr;
  std::size_t axis = 0;
  double shape = 0.0;
  double shape_low = 0.0;  ///< the neighbours on the grid
  double shape_high = 0.0;
  Eigen::Index first = 0;
  Eigen::Index count = 0;

  [[nodiscard]] bool same_name(const Form& other) const noexcept {
    return regressor->kind == other.regressor->kind && (axis == other.axis || !regressor->per_axis);
  }
  /// Numbers that a fit chooses.
  [[nodiscard]] double freedom() const noexcept {
    return static_cast<double>(count) + (regressor->continuous ? 1.0 : 0.0);
  }
};

/// Which rows count: those of all runs but the last, those of the last, or all.
enum class Rows : std::uint8_t { training, held_out, all };

/// The recordings as one linear regression. Every column is low-passed without phase and every
/// tenth sample kept; rows are axis after axis, within an axis run after run. Columns: the
/// directions of the rigid body's prior (standard normal coefficients), the forms, and last what
/// the nominal inverse dynamics need beyond the command.
class Design {
 public:
  static constexpr double kSmooth_Hz = 80.0;  ///< of the readings, before they are differenced
  static constexpr double kCutoff_Hz = 25.0;  ///< of every column
  static constexpr double kStill_rad_per_s = 0.02;

  /// @pre arms only, at least two runs of a second
  Design(const DiagnosisCase& data, const ArmModel& arm);

  [[nodiscard]] const std::vector<Form>& forms() const noexcept { return forms_; }
  [[nodiscard]] const ArmModel& arm() const noexcept { return arm_; }
  [[nodiscard]] static Eigen::Index base_columns() noexcept;
  [[nodiscard]] Eigen::Index target() const noexcept { return columns_.cols() - 1; }

  /// Rows of one axis that count, of the kind asked for.
  [[nodiscard]] double size(Rows rows, std::size_t axis) const noexcept;
  /// Products of all columns over those rows of an axis.
  [[nodiscard]] const Eigen::MatrixXd& gram(Rows rows, std::size_t axis) const noexcept;

  /// All rows of a column of the design.
  [[nodiscard]] auto column(Eigen::Index index) const { return columns_.col(index); }
  /// All rows of columns that need not be of the design.
  [[nodiscard]] Eigen::MatrixXd columns(const Regressor& regressor,
                                        std::size_t axis,
                                        double shape) const;
  /// Rows of one axis and run, for autocorrelations.
  struct Stretch {
    std::size_t axis = 0;
    Eigen::Index first = 0;
    Eigen::Index count = 0;
  };
  [[nodiscard]] const std::vector<Stretch>& stretches() const noexcept { return stretches_; }

 private:
  void lay_out(const DiagnosisCase& data);
  void find_motion();
  void add_forms();
  void multiply();
  void put(const std::vector<Signal>& signals,
           std::size_t run,
           Eigen::Ref<Eigen::MatrixXd> into) const;

  ArmModel arm_;
  ZeroPhaseFilter filter_;
  std::vector<SmoothRun> runs_;
  std::vector<Stretch> stretches_;
  std::array<std::array<double, kJoints>, 3> sizes_{};
  std::vector<bool> moves_;    ///< row by row: it counts
  Eigen::Index rows_ = 0;      ///< of an axis
  Eigen::Index held_out_ = 0;  ///< of them, of the last run
  std::vector<Form> forms_;
  Eigen::MatrixXd columns_;
  std::array<std::array<Eigen::MatrixXd, kJoints>, 3> grams_;
};

}  // namespace teleop
