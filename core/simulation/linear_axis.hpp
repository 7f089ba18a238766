#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include <Eigen/Core>

#include "core/base/time.hpp"

namespace teleop {

/// One axis of an arm as the paper's linear models have it [Cavusoglu 2002, section 3.3, forms (a)
/// and (b)], behind a delay and an amplifier:
///
///     lag Ḟ = u(t − delay) − F                  (F = u(t − delay) where the lag is zero)
///     m₁ ẍ₁ = F − b ẋ₁ − k (x₁ − x₂) − c (ẋ₁ − ẋ₂) − friction
///     m₂ ẍ₂ =           k (x₁ − x₂) + c (ẋ₁ − ẋ₂)
///     y     = x₁ + F / k_t                      (y = x₁ without tendon)
///
/// u is held from one command to the next. Between the instants at which u(t − delay) changes the
/// motion is a matrix exponential, exact over any span, so delays need not be whole samples.
/// Coulomb friction on m₁ is set-valued: the instants at which m₁ stops or comes loose are located
/// to 1e-12 s, and at rest it stays there; with friction pieces are at most ¼ ms, which is how
/// short a turn back and forth may be to be overlooked.
///
/// Thread: one. Loop: everything but the constructor is allocation-free, noexcept and bounded.
class LinearAxis {
 public:
  struct Config {
    double mass_kg = 0.05;                ///< m₁, with motor and encoder
    double damping_Ns_per_m = 1.0;        ///< b, to ground
    double delay_s = 0.0;                 ///< 0 to 25 ms
    double lag_s = 0.0;                   ///< of the amplifier
    double second_mass_kg = 0.0;          ///< m₂, 0: one mass
    double joint_N_per_m = 0.0;           ///< k
    double joint_damping_Ns_per_m = 0.0;  ///< c
    double tendon_N_per_m = 0.0;          ///< k_t, 0: no tendon
    double coulomb_N = 0.0;               ///< on m₁
  };

  /// @throws ConfigError unless the axis is passive: masses positive, the rest not negative.
  explicit LinearAxis(const Config& config);

  /// Commands the force u from now on; it acts a delay later. Of more than kQueue commands within a
  /// delay the last ones are merged.
  void command(double force_N) noexcept;

  /// Forgets what is commanded: the force is zero at once.
  void release() noexcept;

  /// Time until a command in the queue begins to act; Duration::max() when none waits.
  [[nodiscard]] Duration until_switch() const noexcept;

  /// Lets time pass. @pre span <= until_switch()
  void advance(Duration span) noexcept;

  [[nodiscard]] double reading() const noexcept {
    return z_[kX1] + z_[kF] * tendon_m_per_N_;
  }  ///< y
  [[nodiscard]] double reading_rate() const noexcept;                              ///< ẏ
  [[nodiscard]] double position() const noexcept { return z_[kX1]; }               ///< x₁, m
  [[nodiscard]] double velocity() const noexcept { return z_[kV1] * kPerSecond; }  ///< ẋ₁, m/s
  [[nodiscard]] double force() const noexcept { return z_[kF]; }                   ///< F, N
  [[nodiscard]] double kinetic_energy() const noexcept;                            ///< J
  [[nodiscard]] const Config& config() const noexcept { return config_; }

  static constexpr std::size_t kQueue = 256;

 private:
  // Time in ms inside, so that the matrix has entries of like size.
  static constexpr double kPerSecond = 1e3;
  // Rows of the state.
  static constexpr Eigen::Index kX1 = 0;
  static constexpr Eigen::Index kV1 = 1;
  static constexpr Eigen::Index kX2 = 2;
  static constexpr Eigen::Index kV2 = 3;
  static constexpr Eigen::Index kF = 4;
  static constexpr Eigen::Index kU = 5;
  static constexpr Eigen::Index kFriction = 6;
  static constexpr Eigen::Index kRows = 7;
  using State = Eigen::Matrix<double, kRows, 1>;
  using Transition = Eigen::Matrix<double, kRows, kRows>;

  struct Cached {
    double span_ms = -1.0;
    Transition phi = Transition::Identity();
  };
  struct Form {  ///< of the equation: m₁ free, or held by friction
    Transition A = Transition::Zero();
    std::array<Cached, 8> cache{};
    std::size_t next = 0;
  };
  struct Waiting {
    Duration at{};
    double force_N = 0.0;
  };

  [[nodiscard]] const Transition& transition(double span_ms) noexcept;
  void switch_commands() noexcept;
  void flow_with_friction(double span_ms) noexcept;
  [[nodiscard]] double locate(double span_ms) const noexcept;
  [[nodiscard]] double net_force() const noexcept;
  [[nodiscard]] double margin(const State& z) const noexcept;
  void choose_form() noexcept;

  Config config_;
  double tendon_m_per_N_ = 0.0;
  Duration delay_;
  std::array<Form, 2> forms_{};
  bool stuck_ = false;
  State z_ = State::Zero();
  Duration now_{0};
  std::array<Waiting, kQueue> queue_{};
  std::size_t first_ = 0;
  std::size_t waiting_ = 0;
};

}  // namespace teleop
