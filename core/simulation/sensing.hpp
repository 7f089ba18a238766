#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/effects/plant_terms.hpp"
#include "core/math/joint_vector.hpp"
#include "core/simulation/encoder_edges.hpp"

namespace teleop {

/// What the encoders make of the drives' motion: SensingTerms, then EncoderEdges. Angles are read
/// as they were a constant, not necessarily whole number of samples ago; before the start the
/// drives moved uniformly. Loop: everything but the constructor is allocation-free, noexcept.
class Sensing {
 public:
  /// @param counts_per_rev of quadrature encoders; @param m, md the drives' state at time zero.
  Sensing(const std::array<SensingTerms, kJoints>& terms,
          const JointVector& counts_per_rev,
          const JointVector& m,
          const JointVector& md = JointVector::Zero());

  /// A piece of the drives' motion. @param a delivered torques at its end, N m.
  void observe(const MotionPiece& piece, const JointVector& a) noexcept;

  /// Nothing moved until then.
  void pass(double now_s) noexcept;

  [[nodiscard]] const std::array<std::int32_t, kJoints>& counts() const noexcept {
    return edges_.counts();
  }
  /// Angles from the counts, rad.
  [[nodiscard]] JointVector angles() const noexcept { return edges_.angles(); }
  /// Angles before they are counted, rad.
  [[nodiscard]] const JointVector& exact_angles() const noexcept { return y_; }
  [[nodiscard]] std::array<std::int32_t, kJoints> period_ticks(double now_s) const noexcept {
    return edges_.period_ticks(now_s);
  }
  /// Of the encoders as fitted, interpolation included.
  [[nodiscard]] const JointVector& counts_per_rev() const noexcept { return counts_per_rev_; }

 private:
  struct Reading {
    double y = 0.0;
    double rate = 0.0;
  };

  [[nodiscard]] Reading reading(std::size_t axis, double m, double md) const noexcept;
  void show(const MotionPiece& piece) noexcept;
  void catch_up(double now_s) noexcept;

  std::array<SensingTerms, kJoints> terms_;
  JointVector counts_per_rev_;
  EncoderEdges edges_;
  bool plain_ = true;
  bool delays_ = false;
  JointVector y_;
  JointVector tendon_ = JointVector::Zero();  ///< stretch of the tendons, rad
  double now_ = 0.0;
  std::array<double, kJoints> shown_until_{};  ///< of the delayed motion, s
  std::array<std::size_t, kJoints> next_{};    ///< piece to be shown
  std::vector<MotionPiece> history_;           ///< a ring
  std::size_t pieces_ = 0;
};

}  // namespace teleop
