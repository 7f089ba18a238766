#include "core/reporting/pairing.hpp"

#include <array>
#include <cmath>
#include <sstream>

#include <fmt/format.h>

#include "core/base/contract.hpp"
#include "core/base/error.hpp"
#include "core/reporting/tick.hpp"

namespace teleop {
namespace {

constexpr double kLongestGapTurns = 5.0;

/// `count` finite numbers and nothing else.
std::vector<double> numbers(const Log& log, const std::string& key, std::size_t count) {
  const auto entry = log.metadata.find(key);
  if (entry == log.metadata.end()) return {};
  std::string text = entry->second;
  for (char& c : text) {
    if (c == ',' || c == '[' || c == ']') c = ' ';
  }
  std::istringstream in{text};
  std::vector<double> values;
  for (double value = 0.0; in >> value;) {
    values.push_back(value);
  }
  if (!in.eof() || values.size() != count) {
    throw RecordingError{fmt::format("{}: metadata '{}' = '{}': must be {} number(s)",
                                     log.file.string(), key, entry->second, count)};
  }
  return values;
}

Vector3 displacement(const TickRecord& record) { return record.p_m - record.reference_m; }

bool engaged_in(const TickRecord& record, std::uint32_t epoch) {
  return mode_of(record) == Mode::engaged && record.epoch == epoch;
}

/// Walks the slave's records forward with the master's time.
class Follower {
 public:
  explicit Follower(const Side& side)
      : side_{side}, longest_gap_s_{kLongestGapTurns / nominal_rate(*side.log)} {}

  /// The record at or before t, when the next one is there and not too far.
  [[nodiscard]] std::optional<std::size_t> before(double t) {
    const auto& ticks = side_.log->ticks;
    while (index_ + 1 < ticks.size() && stamp(index_ + 1) <= t) {
      ++index_;
    }
    const bool inside = stamp(index_) <= t && index_ + 1 < ticks.size();
    if (!inside || stamp(index_ + 1) - stamp(index_) > longest_gap_s_) return {};
    return index_;
  }

  [[nodiscard]] Vector3 displacement_at(double t) const {
    const auto& ticks = side_.log->ticks;
    const double share = (t - stamp(index_)) / (stamp(index_ + 1) - stamp(index_));
    return (1.0 - share) * displacement(ticks[index_]) + share * displacement(ticks[index_ + 1]);
  }

 private:
  [[nodiscard]] double stamp(std::size_t i) const {
    return side_.clock.seconds(side_.log->ticks[i].stamp_ns);
  }

  const Side& side_;
  double longest_gap_s_ = 0.0;
  std::size_t index_ = 0;
};

/// Sums over one window of contact_at_rest().
struct Window {
  double begin_s = 0.0;
  double end_s = 0.0;
  double ticks = 0.0;
  Vector3 hand = Vector3::Zero();
  Vector3 wall = Vector3::Zero();
  std::array<Vector3, 2> low{Vector3::Zero(), Vector3::Zero()};
  std::array<Vector3, 2> high{Vector3::Zero(), Vector3::Zero()};
  bool measured = true;

  void add(const TickRecord& m, const TickRecord& s, double t_s) {
    const std::array<Vector3, 2> p{m.p_m, s.p_m};
    if (ticks == 0.0) {
      begin_s = t_s;
      low = p;
      high = p;
    }
    for (std::size_t i = 0; i < p.size(); ++i) {
      low.at(i) = low.at(i).cwiseMin(p.at(i));
      high.at(i) = high.at(i).cwiseMax(p.at(i));
    }
    measured = measured && has(m, ArmFlag::has_tool_force) && has(s, ArmFlag::has_tool_force);
    hand += m.tool_force_N;
    wall += s.tool_force_N;
    ticks += 1.0;
    end_s = t_s;
  }

  [[nodiscard]] bool at_rest(double tolerance) const {
    return (high[0] - low[0]).maxCoeff() <= tolerance && (high[1] - low[1]).maxCoeff() <= tolerance;
  }
};

}  // namespace

LawGeometry law_geometry(const Log& log) {
  LawGeometry law;
  if (const auto scale = numbers(log, "law_scale", 1); !scale.empty()) law.scale = scale.front();
  if (const auto R = numbers(log, "law_rotation", 9); !R.empty()) {
    law.R_SM = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>{R.data()};
  }
  return law;
}

std::vector<PairedTick> pair_ticks(const Side& master, const Side& slave) {
  std::vector<PairedTick> pairs;
  const bool comparable = !slave.clock.unknown() && nominal_rate(*slave.log) > 0.0;
  if (!comparable) return pairs;
  const LawGeometry law = law_geometry(*master.log);
  Follower follower{slave};
  for (std::size_t i = 0; i < master.log->ticks.size(); ++i) {
    const TickRecord& m = master.log->ticks[i];
    const double t_s = master.clock.seconds(m.stamp_ns);
    const std::optional<std::size_t> j = follower.before(t_s);
    if (!j || !engaged_in(m, m.epoch)) continue;
    const auto& ticks = slave.log->ticks;
    if (!engaged_in(ticks[*j], m.epoch) || !engaged_in(ticks[*j + 1], m.epoch)) continue;
    const Vector3 error = law.scale * (law.R_SM * displacement(m)) - follower.displacement_at(t_s);
    if (error.allFinite()) pairs.push_back({.master = i, .slave = *j, .t_s = t_s, .error = error});
  }
  return pairs;
}

std::optional<RestContact> contact_at_rest(const Log& master,
                                           const Log& slave,
                                           std::span<const PairedTick> pairs) {
  constexpr double kWindow = 0.1;    // s
  constexpr double kRest = 0.25e-3;  // m
  constexpr double kContact = 0.2;   // N
  const double longest_gap_s = kLongestGapTurns / nominal_rate(master);

  RestContact sum;
  double windows = 0.0;
  Window window;
  for (const PairedTick& pair : pairs) {
    if (window.ticks > 0.0 && pair.t_s - window.end_s > longest_gap_s) window = {};
    window.add(master.ticks[pair.master], slave.ticks[pair.slave], pair.t_s);
    if (pair.t_s - window.begin_s < kWindow) continue;
    const double wall = (window.wall / window.ticks).norm();
    if (window.measured && wall > kContact && window.at_rest(kRest)) {
      sum.seconds += window.end_s - window.begin_s;
      sum.hand_force_N += (window.hand / window.ticks).norm();
      sum.wall_force_N += wall;
      windows += 1.0;
    }
    window = {};
  }
  if (windows == 0.0) return {};
  sum.hand_force_N /= windows;
  sum.wall_force_N /= windows;
  sum.ratio = sum.hand_force_N / sum.wall_force_N;
  return sum;
}

}  // namespace teleop
