#include "core/simulation/motor.hpp"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

namespace teleop {
namespace {

constexpr double kPerAmpere = 0.0234 * 11.2;  // N m/A at the joint

MotorTerms pwm(double carrier_Hz) {
  return {.drive = MotorTerms::Drive::pwm, .supply_V = 12.0, .carrier_Hz = carrier_Hz};
}

/// Mean current and mean square over a second of constant duty at rest, from the second period on.
struct Steady {
  double mean = 0.0;
  double mean_square = 0.0;
};
Steady steady(const MotorTerms& terms, double duty, double speed = 0.0) {
  Motor motor{terms, kPerAmpere};
  const double stall = kPerAmpere * terms.supply_V / terms.resistance_ohm;
  const double period = 1.0 / terms.carrier_Hz;
  for (int k = 0; k < 2000; ++k) {
    motor.step(duty * stall, speed, 0.0, period);
  }
  return {motor.current(), motor.mean_square()};
}

TEST(Motor, UnderPwmHeatsByOneOverTheDutyWhereTheCurrentSettlesWithinThePulse) {
  // Slow carrier: L/R = 0.1 ms is far below the 20 ms period [Cavusoglu 2002, section 4.1.1].
  const Steady slow = steady(pwm(50.0), 0.25);
  const double stall = 12.0 / 2.32;
  EXPECT_NEAR(slow.mean, 0.25 * stall, 1e-9);
  EXPECT_NEAR(slow.mean_square / (slow.mean * slow.mean), 4.0, 0.15);
  // Fast carrier: the inductance smooths the current, and PWM heats like a linear drive.
  const Steady fast = steady(pwm(200e3), 0.25);
  EXPECT_NEAR(fast.mean, 0.25 * stall, 1e-9);
  EXPECT_NEAR(fast.mean_square / (fast.mean * fast.mean), 1.0, 0.01);
}

TEST(Motor, UnderPwmLosesTorqueToSpeedAsAVoltageDriveDoes) {
  constexpr double kSpeed = 2.0;
  const Steady moving = steady(pwm(20e3), 0.5, kSpeed);
  EXPECT_NEAR(moving.mean, (0.5 * 12.0 - kPerAmpere * kSpeed) / 2.32, 1e-9);
}

TEST(Motor, UnderPwmCogsWithTheBrushesAtConstantCommand) {
  MotorTerms terms = pwm(20e3);
  terms.commutation = {.amplitude = 0.2, .frequency = 100.0};
  Motor motor{terms, kPerAmpere};
  const auto settled = [&](double angle) {
    for (int k = 0; k < 2000; ++k) {
      motor.step(0.1, 0.0, angle, 50e-6);
    }
    return motor.step(0.1, 0.0, angle, 50e-6);
  };
  EXPECT_NEAR(settled(0.0), 0.1, 1e-9);
  EXPECT_NEAR(settled(std::numbers::pi / 200.0), 0.1 / 1.2, 1e-9);
  // A current amplifier does not care.
  terms.drive = MotorTerms::Drive::linear;
  terms.bandwidth_Hz = 1000.0;
  terms.current_limit_A = 3.0;
  terms.voltage_limit_V = 24.0;
  Motor linear{terms, kPerAmpere};
  double torque = 0.0;
  for (int k = 0; k < 1000; ++k) {
    torque = linear.step(0.1, 0.0, std::numbers::pi / 200.0, 25e-6);
  }
  EXPECT_NEAR(torque, 0.1, 1e-9);
}

TEST(Motor, BehindALinearAmplifierKeepsWithinCurrentAndVoltage) {
  const MotorTerms terms{.drive = MotorTerms::Drive::linear,
                         .bandwidth_Hz = 1000.0,
                         .current_limit_A = 2.0,
                         .voltage_limit_V = 4.0};
  Motor motor{terms, kPerAmpere};
  double highest = 0.0;
  double before = 0.0;
  for (int k = 0; k < 4000; ++k) {
    motor.step(1.0, 0.0, 0.0, 1e-6);
    const double slope = (motor.current() - before) / 1e-6;
    EXPECT_LT(slope, 4.0 / 2.4e-4 * 1.05);
    before = motor.current();
    highest = std::max(highest, before);
  }
  EXPECT_NEAR(highest, 4.0 / 2.32, 1e-3) << "the voltage gives no more than that";
  Motor strong{{.drive = MotorTerms::Drive::linear,
                .bandwidth_Hz = 1000.0,
                .current_limit_A = 2.0,
                .voltage_limit_V = 24.0},
               kPerAmpere};
  for (int k = 0; k < 4000; ++k) {
    strong.step(1.0, 0.0, 0.0, 25e-6);
  }
  EXPECT_NEAR(strong.current(), 2.0, 1e-9);
}

TEST(Motor, WarmsAsItsTwoNodesSay) {
  const MotorTerms terms{.heats = true,
                         .winding_to_housing_K_per_W = 3.1,
                         .housing_to_ambient_K_per_W = 12.0,
                         .winding_J_per_K = 10.0,
                         .housing_J_per_K = 60.0};
  Motor motor{terms, kPerAmpere};
  const double command = 1.5 * kPerAmpere;
  const double power = 1.5 * 1.5 * 2.32;
  for (int k = 0; k < 2'000'000; ++k) {
    motor.step(command, 0.0, 0.0, 0.01);
  }
  EXPECT_NEAR(motor.housing_temperature() - 25.0, 12.0 * power, 1e-3);
  EXPECT_NEAR(motor.winding_temperature() - 25.0, 15.1 * power, 1e-3);
  // The first second: the winding alone takes the heat.
  Motor cold{terms, kPerAmpere};
  cold.step(command, 0.0, 0.0, 0.01);
  EXPECT_NEAR((cold.winding_temperature() - 25.0) / 0.01, power / 10.0, 1e-3);
}

TEST(Motor, LosesTorqueWithHeatUnderAVoltageAndWithItsMagnet) {
  MotorTerms terms = pwm(20e3);
  terms.heats = true;
  terms.winding_to_housing_K_per_W = 3.1;
  terms.housing_to_ambient_K_per_W = 12.0;
  terms.winding_J_per_K = 0.01;
  terms.housing_J_per_K = 0.06;
  terms.copper_per_K = 0.0039;
  Motor motor{terms, kPerAmpere};
  double torque = 0.0;
  for (int k = 0; k < 400'000; ++k) {
    torque = motor.step(0.2, 0.0, 0.0, 50e-6);
  }
  const double hot = 1.0 + 0.0039 * (motor.winding_temperature() - 25.0);
  EXPECT_GT(hot, 1.01);
  EXPECT_NEAR(torque, 0.2 / hot, 1e-4);
}

}  // namespace
}  // namespace teleop
