#include "core/reporting/metrics.hpp"

#include <limits>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/base/error.hpp"
#include "tests/reporting/run_of.hpp"

namespace teleop {
namespace {

using testing::log_of;
using testing::LogOf;
using testing::set;
using testing::set_tool_force;
using testing::sine;
using testing::there;

SideMetrics master_of(const LogOf& of) { return measure(std::vector<Log>{log_of(of)}).first(); }

TEST(SideMetrics, CountTurnsAndTheirRate) {
  const SideMetrics side = master_of({.seconds = 2.0, .rate_Hz = 500.0});
  EXPECT_EQ(side.ticks, 1001U);
  EXPECT_DOUBLE_EQ(side.rate_Hz, 500.0);
  EXPECT_DOUBLE_EQ(side.nominal_rate_Hz, 500.0);
  EXPECT_DOUBLE_EQ(side.tick_share, 1.0);
}

TEST(SideMetrics, TellASlowLoopFromItsConfiguredRate) {
  Log log = log_of({.seconds = 2.0, .rate_Hz = 900.0});
  log.metadata["rate_Hz"] = "1000";
  const SideMetrics side = measure(std::vector<Log>{log}).first();
  EXPECT_NEAR(side.rate_Hz, 900.0, 1e-6);
  EXPECT_NEAR(side.tick_share, 0.9, 1e-3);
}

TEST(SideMetrics, TakeTheMedianTurnWhereTheRateIsNotRecorded) {
  Log log = log_of({.rate_Hz = 250.0});
  log.metadata.erase("rate_Hz");
  EXPECT_DOUBLE_EQ(measure(std::vector<Log>{log}).first().nominal_rate_Hz, 250.0);
}

TEST(SideMetrics, CountTurnsThatTheRecordingDropped) {
  Log log = log_of({.seconds = 1.0});
  log.ticks.erase(log.ticks.begin() + 100, log.ticks.begin() + 107);
  const SideMetrics side = measure(std::vector<Log>{log}).first();
  EXPECT_EQ(side.ticks, 1001U);
  EXPECT_EQ(side.dropped_records, 7U);
}

TEST(SideMetrics, CountARoundTripOnceAPacketAndAgesOnlyWhileCoupled) {
  const SideMetrics side =
      master_of({.seconds = 0.999, .change = [](TickRecord& r, double t) {
                   r.peer_sequence = r.tick / 4;
                   r.round_trip_us = r.tick < 4 ? 0.0 : 50.0 + static_cast<double>(r.peer_sequence);
                   r.peer_age_ms = 1.0;
                   if (t >= 0.5) set(r, Mode::holding);
                   if (t >= 0.5) r.peer_age_ms = 500.0;
                 }});
  EXPECT_EQ(side.round_trip_us.count, 249U);
  EXPECT_EQ(side.round_trip_us.max, 299.0);
  EXPECT_EQ(side.age_ms.count, 500U);
  EXPECT_EQ(side.age_ms.max, 1.0);
}

TEST(SideMetrics, SumForceAndEnergyOfCouplingAndPort) {
  // A force of 2 N along a velocity of 0.1 m/s for 2 s is 0.4 J.
  const SideMetrics side = master_of({.seconds = 2.0, .change = [](TickRecord& r, double t) {
                                        r.coupling_N = Vector3{0.0, 3.0, -4.0};
                                        r.v_m_per_s = Vector3{0.1, 0.0, 0.0};
                                        r.energy_J = -0.25 * t;
                                        set_tool_force(r, Vector3{2.0, 0.0, 0.0});
                                      }});
  EXPECT_DOUBLE_EQ(side.coupling_rms_N, 5.0);
  EXPECT_DOUBLE_EQ(side.coupling_peak_N, 5.0);
  EXPECT_DOUBLE_EQ(side.coupling_energy_J, -0.5);
  EXPECT_NEAR(there(side.port_energy_J), 0.4, 1e-9);
  EXPECT_DOUBLE_EQ(there(side.tool_force_peak_N), 2.0);
}

TEST(SideMetrics, ListEachAppearanceOfAFaultAndCountLimits) {
  const SideMetrics side = master_of({.seconds = 1.0, .change = [](TickRecord& r, double t) {
                                        if (t > 0.2 && t < 0.3) r.fault = 51;
                                        if (t > 0.6) r.fault = 1;
                                        if (t > 0.6) r.p_m.setConstant(std::nan(""));
                                        if (r.tick % 100 == 0) set(r, Limit::overrun);
                                        if (r.tick < 20) set(r, Limit::force);
                                      }});
  ASSERT_EQ(side.faults.size(), 2U);
  EXPECT_EQ(side.faults[0].name, "peer_faulted");
  EXPECT_NEAR(side.faults[0].t_s, 0.201, 1e-9);
  EXPECT_EQ(side.faults[1].code, 1);
  ASSERT_EQ(side.limits.size(), 2U);
  EXPECT_EQ(side.limits[0].name, "force");
  EXPECT_EQ(side.limits[0].ticks, 20U);
  EXPECT_EQ(side.overruns, 11U);
}

TEST(SideMetrics, SeeAnOutageButNotTheWaitBeforeThePeerNorTheCloseAfterIt) {
  const SideMetrics side = master_of({.seconds = 3.0, .change = [](TickRecord& r, double t) {
                                        if (t < 0.5) r.peer_session = 0;
                                        const bool silent =
                                            t < 0.5 || (t >= 1.0 && t < 1.25) || t > 2.8;
                                        if (silent) set(r, Limit::peer_silent);
                                      }});
  ASSERT_EQ(side.outages.size(), 1U);
  EXPECT_NEAR(side.outages[0].t_s, 1.0, 1e-9);
  EXPECT_NEAR(side.outages[0].length_s, 0.25, 1e-9);
  EXPECT_TRUE(side.outages[0].ended);
}

TEST(SideMetrics, SeeAPeerThatDidNotReturn) {
  const SideMetrics side = master_of({.seconds = 3.0, .change = [](TickRecord& r, double t) {
                                        if (t >= 1.0) set(r, Limit::peer_silent);
                                      }});
  ASSERT_EQ(side.outages.size(), 1U);
  EXPECT_FALSE(side.outages[0].ended);
}

TEST(PairMetrics, RefuseLogsThatDoNotMakeARun) {
  const Log master = log_of({.role = Role::master});
  Log nameless = master;
  nameless.metadata.erase("role");
  Log empty = log_of({.role = Role::slave});
  empty.ticks.clear();
  EXPECT_THROW((void)measure(std::vector<Log>{}), RecordingError);
  EXPECT_THROW((void)measure(std::vector<Log>{master, master}), RecordingError);
  EXPECT_THROW((void)measure(std::vector<Log>{nameless}), RecordingError);
  EXPECT_THROW((void)measure(std::vector<Log>{master, empty}), RecordingError);
}

TEST(PairMetrics, MeasureTimeFromTheFirstTurnOfEitherSide) {
  const PairMetrics metrics = measure(
      std::vector<Log>{log_of({.role = Role::slave, .seconds = 3.0, .begin_ns = 4'000'000'000}),
                       log_of({.role = Role::master, .seconds = 3.0, .begin_ns = 5'000'000'000})});
  EXPECT_NEAR(metrics.seconds, 4.0, 1e-9);
  EXPECT_NEAR(metrics.overlap_s, 2.0, 1e-9);
  EXPECT_NEAR(metrics.first().begin_s, 1.0, 1e-9);
  EXPECT_NEAR(metrics.engaged_share, 1.0, 2e-3);
}

TEST(PairMetrics, PoolBothSides) {
  const auto lateness = [](double value) {
    return [value](TickRecord& r, double) {
      r.lateness_us = value;
      r.packets_lost = 2;
    };
  };
  const PairMetrics metrics =
      measure(std::vector<Log>{log_of({.role = Role::master, .change = lateness(10.0)}),
                               log_of({.role = Role::slave, .change = lateness(30.0)})});
  EXPECT_EQ(metrics.lateness_us.count, 4002U);
  EXPECT_EQ(metrics.lateness_us.p50, 10.0);
  EXPECT_EQ(metrics.lateness_us.p90, 30.0);
  EXPECT_EQ(metrics.packets.lost, 4U);
  EXPECT_EQ(metrics.packets.sent, 4002U);
}

TEST(MetricsJson, HasEveryNameThatScriptsRelyOn) {
  const PairMetrics metrics =
      measure(std::vector<Log>{log_of({.role = Role::master, .position = sine(0.05, 1.0)}),
                               log_of({.role = Role::slave, .position = sine(0.05, 1.0, 0.003)})});

  const nlohmann::json json = to_json(metrics);

  for (const char* place :
       {"/rate_Hz",          "/ticks/master",     "/ticks/slave",        "/tracking_rms_mm",
        "/tracking_peak_mm", "/force_rms_N",      "/lateness_us/p50",    "/lateness_us/p90",
        "/lateness_us/p99",  "/lateness_us/p999", "/lateness_us/max",    "/compute_us/p50",
        "/compute_us/p99",   "/age_ms/p50",       "/age_ms/p99",         "/packets/sent",
        "/packets/received", "/packets/lost",     "/packets/duplicated", "/packets/reordered"}) {
    const nlohmann::json::json_pointer pointer{place};
    ASSERT_TRUE(json.contains(pointer)) << place;
    EXPECT_TRUE(json[pointer].is_number()) << place;
  }
  for (const char* place : {"/rtt_us/p50", "/rtt_us/p99", "/rtt_us/p999"}) {
    EXPECT_TRUE(json.contains(nlohmann::json::json_pointer{place})) << place;
  }
  EXPECT_TRUE(json["faults"].is_array());
  EXPECT_TRUE(json["faults"].empty());
  EXPECT_NEAR(json["tracking_rms_mm"].get<double>(), there(metrics.tracking).rms_mm, 1e-12);
}

TEST(MetricsJson, OfOneSideIsNullWhereItNeedsBoth) {
  const nlohmann::json json = to_json(measure(std::vector<Log>{log_of({.role = Role::slave})}));
  EXPECT_TRUE(json["tracking_rms_mm"].is_null());
  EXPECT_TRUE(json["ticks"]["master"].is_null());
  EXPECT_EQ(json["ticks"]["slave"], 2001);
  EXPECT_TRUE(json["rtt_us"]["p50"].is_null());
}

}  // namespace
}  // namespace teleop
