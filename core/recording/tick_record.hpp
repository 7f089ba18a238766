#pragma once

#include <array>
#include <cstdint>

#include "core/math/joint_vector.hpp"
#include "core/math/spatial.hpp"
#include "core/ports/arm.hpp"

namespace teleop {

/// Everything that one turn of one side's loop saw and did. A plain value: copied into a ring by
/// the loop and written outside it. for_each_field() below is the only list of its fields.
struct TickRecord {
  std::uint64_t tick = 0;
  std::int64_t stamp_ns = 0;
  double elapsed_ms = 0.0;
  double lateness_us = 0.0;
  double compute_us = 0.0;
  std::uint32_t mode = 0;
  std::uint32_t fault = 0;
  std::uint32_t limits = 0;
  std::uint32_t arm_flags = 0;
  std::uint32_t switches = 0;
  std::array<std::int32_t, kJoints> counts{};
  std::array<std::int32_t, kJoints> period_ticks{};
  JointVector q_rad = JointVector::Zero();
  JointVector qd_rad_per_s = JointVector::Zero();
  JointVector tau_Nm = JointVector::Zero();
  JointVector motor_current_A = JointVector::Zero();
  JointVector motor_temperature_C = JointVector::Zero();
  Vector3 p_m = Vector3::Zero();
  Vector3 v_m_per_s = Vector3::Zero();
  Vector3 reference_m = Vector3::Zero();
  Vector3 error_m = Vector3::Zero();
  Vector3 coupling_N = Vector3::Zero();
  Vector3 tool_force_N = Vector3::Zero();
  std::uint32_t epoch = 0;
  double ramp = 0.0;
  double energy_J = 0.0;
  std::uint64_t peer_session = 0;
  std::uint64_t peer_sequence = 0;
  std::uint64_t peer_tick = 0;
  std::int64_t peer_sent_ns = 0;
  std::int64_t peer_received_ns = 0;
  std::uint32_t peer_mode = 0;
  std::uint32_t peer_epoch = 0;
  Vector3 peer_p_m = Vector3::Zero();
  Vector3 peer_v_m_per_s = Vector3::Zero();
  Vector3 peer_coupling_N = Vector3::Zero();
  double peer_age_ms = 0.0;
  double peer_age_bound_ms = 0.0;
  double round_trip_us = 0.0;
  std::uint64_t packets_sent = 0;
  std::uint64_t packets_received = 0;
  std::uint64_t packets_lost = 0;
  std::uint64_t packets_duplicated = 0;
  std::uint64_t packets_reordered = 0;
  Vector3 tool_acceleration_m_per_s2 = Vector3::Zero();
};

/// What a reader of a log needs to know about a field. The number is its Protobuf tag: never reuse
/// one. Names carry the unit.
struct Field {
  int number = 0;
  const char* name = "";
  const char* text = "";
  std::uint32_t only_with = 0;  ///< bits of arm_flags: tables leave it out where no record has them
};

/// Calls visit(Field, member) for every field in order. `Record` is TickRecord or const TickRecord.
template <class Record, class Visitor>
constexpr void for_each_field(Record& r, Visitor&& visit) {
  visit(Field{1, "tick", "turn of the loop"}, r.tick);
  visit(Field{2, "stamp_ns", "monotonic time at which the encoders were latched"}, r.stamp_ns);
  visit(Field{3, "elapsed_ms", "time since the previous turn began"}, r.elapsed_ms);
  visit(Field{4, "lateness_us", "this turn began so much after its time"}, r.lateness_us);
  visit(Field{5, "compute_us", "read to send, time inside a simulated arm excluded"}, r.compute_us);
  visit(Field{6, "mode", "0 idle, 1 engaging, 2 engaged, 3 holding, 4 faulted"}, r.mode);
  visit(Field{7, "fault", "fault number, 0 none"}, r.fault);
  visit(Field{8, "limits", "limit bits: bit n is limit 100 + n"}, r.limits);
  visit(Field{9, "arm_flags", "device flag bits"}, r.arm_flags);
  visit(Field{10, "switches", "device switches, bit 0 clutch"}, r.switches);
  visit(Field{11, "counts", "encoder counts"}, r.counts);
  visit(Field{12, "period_ticks", "10 MHz ticks between encoder edges, 0 overflow"},
        r.period_ticks);
  visit(Field{13, "q_rad", "joint angles"}, r.q_rad);
  visit(Field{14, "qd_rad_per_s", "joint speeds, estimated"}, r.qd_rad_per_s);
  visit(Field{15, "tau_Nm", "joint torques commanded"}, r.tau_Nm);
  visit(Field{16, "motor_current_A", "motor currents measured"}, r.motor_current_A);
  visit(Field{17, "motor_temperature_C", "motor casings measured"}, r.motor_temperature_C);
  visit(Field{18, "p_m", "tool position in the own base"}, r.p_m);
  visit(Field{19, "v_m_per_s", "tool velocity, estimated"}, r.v_m_per_s);
  visit(Field{20, "reference_m", "tool position at engaging"}, r.reference_m);
  visit(Field{21, "error_m", "position error of the law, in the slave's base"}, r.error_m);
  visit(Field{22, "coupling_N", "coupling force commanded at the own tool"}, r.coupling_N);
  visit(Field{23, "tool_force_N", "force of hand or surroundings on the tool"}, r.tool_force_N);
  visit(Field{24, "epoch", "number of the engagement"}, r.epoch);
  visit(Field{25, "ramp", "share of the coupling that is on, 0 to 1"}, r.ramp);
  visit(Field{26, "energy_J", "energy that the coupling gave to the own tool"}, r.energy_J);
  visit(Field{27, "peer_session", "session of the peer"}, r.peer_session);
  visit(Field{28, "peer_sequence", "sequence of the newest peer packet"}, r.peer_sequence);
  visit(Field{29, "peer_tick", "turn of the peer's loop"}, r.peer_tick);
  visit(Field{30, "peer_sent_ns", "when the peer sent it, peer's clock"}, r.peer_sent_ns);
  visit(Field{31, "peer_received_ns", "when it arrived, own clock"}, r.peer_received_ns);
  visit(Field{32, "peer_mode", "mode of the peer"}, r.peer_mode);
  visit(Field{33, "peer_epoch", "engagement of the peer"}, r.peer_epoch);
  visit(Field{34, "peer_p_m", "tool position of the peer, in its base"}, r.peer_p_m);
  visit(Field{35, "peer_v_m_per_s", "tool velocity of the peer"}, r.peer_v_m_per_s);
  visit(Field{36, "peer_coupling_N", "coupling force at the peer's tool"}, r.peer_coupling_N);
  visit(Field{37, "peer_age_ms", "age of the peer's state, estimated"}, r.peer_age_ms);
  visit(Field{38, "peer_age_bound_ms", "upper bound of that age"}, r.peer_age_bound_ms);
  visit(Field{39, "round_trip_us", "network round trip, 0 unknown"}, r.round_trip_us);
  visit(Field{40, "packets_sent", "since the start"}, r.packets_sent);
  visit(Field{41, "packets_received", "since the start"}, r.packets_received);
  visit(Field{42, "packets_lost", "since the start"}, r.packets_lost);
  visit(Field{43, "packets_duplicated", "since the start"}, r.packets_duplicated);
  visit(Field{44, "packets_reordered", "since the start"}, r.packets_reordered);
  visit(Field{45, "tool_acceleration_m_per_s2", "tool accelerometer, weight not included",
              static_cast<std::uint32_t>(ArmFlag::has_acceleration)},
        r.tool_acceleration_m_per_s2);
}

}  // namespace teleop
