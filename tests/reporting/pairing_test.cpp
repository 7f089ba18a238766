#include "core/reporting/pairing.hpp"

#include <numbers>

#include <gtest/gtest.h>

#include "core/base/error.hpp"
#include "core/reporting/metrics.hpp"
#include "tests/reporting/run_of.hpp"

namespace teleop {
namespace {

using testing::log_of;
using testing::LogOf;
using testing::set;
using testing::set_tool_force;
using testing::sine;
using testing::there;

constexpr double kPi = std::numbers::pi;

std::vector<PairedTick> pairs_of(const std::vector<Log>& logs) {
  const Run run = arrange(logs);
  return pair_ticks(there(run.master), there(run.slave));
}

TEST(Tracking, OfASineThatLagsHasTheErrorOfTheLag) {
  constexpr double kAmplitude = 0.05;
  constexpr double kLag = 0.003;
  const PairMetrics metrics = measure(
      std::vector<Log>{log_of({.role = Role::master, .position = sine(kAmplitude, 1.0)}),
                       log_of({.role = Role::slave, .position = sine(kAmplitude, 1.0, kLag)})});

  // sin(wt) − sin(w(t − d)) has the amplitude 2 sin(wd/2).
  const double amplitude = 2.0 * kAmplitude * std::sin(kPi * kLag);
  EXPECT_NEAR(there(metrics.tracking).rms_mm, 1e3 * amplitude / std::sqrt(2.0),
              1e-3 * amplitude * 1e3);
  EXPECT_NEAR(there(metrics.tracking).peak_mm, 1e3 * amplitude, 1e-3 * amplitude * 1e3);
}

TEST(Tracking, ComparesEqualTimesWhereStampsAndRatesDiffer) {
  const auto pairs = pairs_of({log_of({.role = Role::master, .position = sine(0.05, 1.0)}),
                               log_of({.role = Role::slave,
                                       .rate_Hz = 730.0,
                                       .begin_ns = 5'000'317'000,
                                       .position = sine(0.05, 1.0)})});
  ASSERT_GT(pairs.size(), 1900U);
  // Linear interpolation: a (2 π f)² dt² / 8.
  const double bound = 0.05 * 4.0 * kPi * kPi / (730.0 * 730.0) / 8.0;
  for (const PairedTick& pair : pairs) {
    EXPECT_LE(pair.error.norm(), 1.01 * bound);
  }
}

TEST(Tracking, TakesDisplacementsFromTheReferencesThroughScaleAndRotation) {
  const Vector3 m_reference{0.1, 0.2, 0.3};
  const Vector3 s_reference{-0.4, 0.0, 0.1};
  Log master =
      log_of({.role = Role::master,
              .seconds = 0.1,
              .position = [&](double) { return Vector3{m_reference + Vector3::UnitX() * 0.01}; },
              .change =
                  [&](TickRecord& r, double) {
                    r.reference_m = m_reference;
                  }});
  const Log slave =
      log_of({.role = Role::slave,
              .seconds = 0.1,
              .position = [&](double) { return Vector3{s_reference + Vector3::UnitY() * 0.02}; },
              .change =
                  [&](TickRecord& r, double) {
                    r.reference_m = s_reference;
                  }});
  master.metadata["law_scale"] = "2.5";
  master.metadata["law_rotation"] = "0 -1 0  1 0 0  0 0 1";  // x of the master is y of the slave

  const auto pairs = pairs_of({master, slave});

  ASSERT_FALSE(pairs.empty());
  EXPECT_NEAR((pairs.front().error - Vector3{0.0, 0.005, 0.0}).norm(), 0.0, 1e-12);
}

TEST(Tracking, CountsOnlyTurnsAtWhichBothAreEngagedInTheSameEpoch) {
  const auto far_outside = [](TickRecord& r) {
    r.p_m.x() = 1.0;
  };
  const Log master =
      log_of({.role = Role::master, .seconds = 1.0, .change = [&](TickRecord& r, double t) {
                r.epoch = t < 0.5 ? 1 : 2;
                if (t > 0.9) set(r, Mode::holding);
                if (t > 0.9) far_outside(r);
              }});
  const Log slave =
      log_of({.role = Role::slave, .seconds = 1.0, .change = [&](TickRecord& r, double t) {
                r.epoch = t < 0.55 ? 1 : 2;
                if (t >= 0.5 && t < 0.55) far_outside(r);
                if (t < 0.1) set(r, Mode::engaging);
                if (t < 0.1) far_outside(r);
              }});
  const auto pairs = pairs_of({master, slave});

  EXPECT_NEAR(static_cast<double>(pairs.size()), 400.0 + 350.0, 4.0);
  for (const PairedTick& pair : pairs) {
    EXPECT_EQ(pair.error.norm(), 0.0);
  }
}

TEST(Tracking, IsAbsentAcrossAHoleInTheRecording) {
  const Log master = log_of({.role = Role::master, .seconds = 1.0});
  Log slave = log_of({.role = Role::slave, .seconds = 1.0});
  slave.ticks.erase(slave.ticks.begin() + 300, slave.ticks.begin() + 500);

  const auto pairs = pairs_of({master, slave});

  for (const PairedTick& pair : pairs) {
    EXPECT_FALSE(0.3 < pair.t_s && pair.t_s < 0.4985) << pair.t_s;
  }
}

TEST(Tracking, RefusesALawThatIsNoNumbers) {
  std::vector<Log> logs{log_of({.role = Role::master}), log_of({.role = Role::slave})};
  logs[0].metadata["law_scale"] = "twice";
  EXPECT_THROW((void)measure(logs), RecordingError);
  logs[0].metadata["law_scale"] = "2";
  logs[0].metadata["law_rotation"] = "1 0 0 0 1 0 0 0";
  EXPECT_THROW((void)measure(logs), RecordingError);
}

/// Two machines: the slave's clock is `ahead` of the master's and drifts; the packets need 200 µs
/// there and 300 µs back at least.
struct TwoMachines {
  double ahead_s = 1234.5;
  double drift = 20e-6;
  std::vector<Log> logs{};

  TwoMachines() {
    const auto slave_clock = [this](double t) {
      return (1.0 + drift) * t + ahead_s;
    };
    const auto ns = [](double t) {
      return std::llround(1e9 * t);
    };
    LogOf master{.role = Role::master, .seconds = 60.0, .position = sine(0.05, 1.0)};
    master.change = [&](TickRecord& r, double since) {
      const double t = 5.0 + since;
      const double delay = 300e-6 + 1e-3 * std::abs(std::sin(37.0 * t));
      r.peer_received_ns = ns(t);
      r.peer_sent_ns = ns(slave_clock(t - delay));
    };
    LogOf slave{.role = Role::slave, .seconds = 60.0};
    slave.change = [&](TickRecord& r, double since) {
      const double t = 5.0 + since;
      const double delay = 200e-6 + 1e-3 * std::abs(std::cos(29.0 * t));
      r.stamp_ns = ns(slave_clock(t));
      r.peer_received_ns = r.stamp_ns;
      r.peer_sent_ns = ns(t - delay);
      r.p_m = sine(0.05, 1.0)(t);
    };
    logs = {log_of(master), log_of(slave)};
    logs[0].metadata["host"] = "left";
    logs[1].metadata["host"] = "right";
  }
};

TEST(Tracking, OnTwoMachinesFindsTheClocksOffsetAndDriftFromThePackets) {
  const TwoMachines machines;
  const PairMetrics metrics = measure(machines.logs);

  // Half the asymmetry of the way (50 µs) and the drift in half a window (100 µs) at 0.31 m/s.
  EXPECT_LT(there(metrics.tracking).peak_mm, 0.31 * 0.17);
  EXPECT_GE(metrics.clock_error_bound_us, 250.0 - 1.0);
  EXPECT_LT(metrics.clock_error_bound_us, 400.0);
  EXPECT_NEAR(metrics.seconds, 60.0, 0.01);
}

TEST(Tracking, OnTwoMachinesThatNeverHeardEachOtherIsAbsent) {
  TwoMachines machines;
  for (Log& log : machines.logs) {
    for (TickRecord& record : log.ticks) {
      record.peer_session = 0;
    }
  }
  const PairMetrics metrics = measure(machines.logs);
  EXPECT_FALSE(metrics.tracking);
  EXPECT_TRUE(metrics.clocks_unknown);
  EXPECT_NEAR(metrics.seconds, 60.0, 0.01);
}

/// A master's hand that presses with `hand`, a wall that answers with `wall`, at rest after 0.5 s.
std::vector<Log> pressing(double hand_N, double wall_N) {
  const auto settle = [](double t) {
    return Vector3{0.01 * std::min(2.0 * (t - 5.0), 1.0), 0.0, 0.0};
  };
  return {log_of({.role = Role::master,
                  .position = settle,
                  .change =
                      [=](TickRecord& r, double t) {
                        set_tool_force(r, Vector3{t < 0.5 ? 9.0 : hand_N, 0.0, 0.0});
                      }}),
          log_of({.role = Role::slave, .position = settle, .change = [=](TickRecord& r, double) {
                    set_tool_force(r, Vector3{-wall_N, 0.0, 0.0});
                  }})};
}

TEST(RestContact, IsHandOverWallWhileBothRest) {
  const PairMetrics metrics = measure(pressing(2.1, 2.0));
  EXPECT_NEAR(there(metrics.rest_contact).ratio, 1.05, 1e-9);
  EXPECT_NEAR(there(metrics.rest_contact).seconds, 1.45, 0.1);
}

TEST(RestContact, IsAbsentInFreeMotionAndWhereNothingIsMeasured) {
  EXPECT_FALSE(measure(pressing(0.1, 0.1)).rest_contact);
  std::vector<Log> blind = pressing(2.0, 2.0);
  for (TickRecord& record : blind[0].ticks) {
    record.arm_flags = 0;
  }
  EXPECT_FALSE(measure(blind).rest_contact);
}

}  // namespace
}  // namespace teleop
