#include "core/estimation/sine_encoder.hpp"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "core/math/random.hpp"
#include "tests/estimation/encoder.hpp"

namespace teleop {
namespace {

using testing::WatchedEncoder;

TEST(SineEncoder, ReadsWhatAnEncoderThatWatchesTheMotionReads) {
  Random random{51};
  for (int n = 0; n < 20; ++n) {
    const double amplitude = random.uniform(2.0, 60.0);
    const double offset = random.uniform(-0.4, 0.4);
    const double omega = 2.0 * std::numbers::pi * random.uniform(2.0, 60.0);
    const SineEncoder encoder{
        {.amplitude_counts = amplitude, .offset_counts = offset, .omega_rad_per_s = omega}};
    WatchedEncoder watched;
    const auto motion = [&](double t) {
      return WatchedEncoder::kQuantum * (offset + amplitude * std::sin(omega * t));
    };
    for (int k = 1; k < 600; ++k) {
      const double t = 1e-3 * k;
      const VelocitySample expected = watched.read(motion, t);
      const SineEncoder::Reading reading = encoder.read(t);
      ASSERT_EQ(reading.counts, std::round(expected.q[0] / WatchedEncoder::kQuantum))
          << n << ' ' << k;
      if (t * omega < 2.0 * std::numbers::pi) continue;  // it began at rest, the other long ago
      const double off = std::abs(reading.period_ticks - expected.period_ticks[0]);
      // The watching one interpolates: near a turn its instants are a few ticks off.
      ASSERT_LE(off, 3.0 + 2e-3 * std::abs(reading.period_ticks)) << n << ' ' << k;
    }
  }
}

TEST(SineEncoder, ThatCrossesNoLineReadsNoPeriod) {
  const SineEncoder encoder{{.amplitude_counts = 0.4, .omega_rad_per_s = 100.0}};
  for (int k = 0; k < 100; ++k) {
    EXPECT_EQ(encoder.read(1e-3 * k).counts, 0.0);
    EXPECT_EQ(encoder.read(1e-3 * k).period_ticks, 0);
  }
}

}  // namespace
}  // namespace teleop
