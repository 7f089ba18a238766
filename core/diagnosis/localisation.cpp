#include "core/diagnosis/localisation.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include "core/diagnosis/miss_words.hpp"
#include "core/diagnosis/missing_means.hpp"
#include "core/diagnosis/parallel.hpp"
#include "core/effects/vocabulary.hpp"
#include "core/model/dynamics.hpp"

namespace teleop {
namespace {

using Eigen::Index;
using Rows = std::vector<TorqueSmoother::Row>;

constexpr std::size_t kFirst = 200;  // rows after which the tether knows the state
constexpr std::size_t kEvery = 2;    // rows are alike from one to the next
constexpr double kBlock_s = 0.25;    // longer than what is left is correlated
constexpr std::size_t kColumns = 18;
constexpr std::size_t kSpeeds = 14;
constexpr std::size_t kBins = 16;

/// What one row says of one axis.
struct Seen {
  std::size_t run = 0;
  std::size_t block = 0;
  double q = 0.0;
  double v = 0.0;
  double u = 0.0;
  double u_rate = 0.0;
  double a = 0.0;
  double t_s = 0.0;
  double heat = 0.0;
  double missing = 0.0;
};

struct Seens {
  std::vector<Seen> list{};
  std::size_t blocks = 0;
};

struct Quantity {
  const char* name;
  const char* unit;
  double Seen::* of;
};

constexpr std::array kQuantities{
    Quantity{"speed", "rad/s", &Seen::v},
    Quantity{"angle", "rad", &Seen::q},
    Quantity{"command", "Nm", &Seen::u},
    Quantity{"acceleration", "rad/s²", &Seen::a},
    Quantity{"rate of command", "Nm/s", &Seen::u_rate},
    Quantity{"time", "s", &Seen::t_s},
    Quantity{"heat", "(Nm)²", &Seen::heat},
};

Seens seens_of(const Likelihood& likelihood, const std::vector<Rows>& rows, Index axis) {
  constexpr double kWarming_s = 2.0;
  const DiagnosisCase& data = likelihood.data();
  const auto block_rows = static_cast<std::size_t>(std::max(1.0, kBlock_s / data.period_s));
  Seens seens;
  for (std::size_t run = 0; run < rows.size(); ++run) {
    const Recording& recording = data.runs[run];
    const std::size_t first_block = seens.blocks;
    double heat = 0.0;
    for (std::size_t k = 1; k < rows[run].size(); ++k) {
      const double u = recording.tau[k][axis];
      heat += data.period_s / kWarming_s * (u * u - heat);
      if (k < kFirst || k % kEvery != 0) continue;
      const TorqueSmoother::Row& row = rows[run][k];
      const std::size_t block = first_block + (k - kFirst) / block_rows;
      const JointVector qdd = forward_dynamics(likelihood.arm(), row.q, row.qd, recording.tau[k]);
      seens.list.push_back({.run = run,
                            .block = block,
                            .q = row.q[axis],
                            .v = row.qd[axis],
                            .u = u,
                            .u_rate = (u - recording.tau[k - 1][axis]) / data.period_s,
                            .a = qdd[axis],
                            .t_s = static_cast<double>(k) * data.period_s,
                            .heat = heat,
                            .missing = row.torque[axis]});
      seens.blocks = block + 1;
    }
  }
  return seens;
}

/// Means in cells; rows for which `cell` gives nothing are passed over.
std::vector<MissingMean> means_in(const Seens& seens,
                                  std::size_t cells,
                                  const std::function<std::size_t(const Seen&)>& cell) {
  std::vector<CellSample> samples;
  samples.reserve(seens.list.size());
  for (const Seen& each : seens.list) {
    const std::size_t place = cell(each);
    if (place >= cells) continue;
    samples.push_back({.cell = place, .block = each.block, .value = each.missing});
  }
  return block_means(samples, cells, seens.blocks);
}

double quantile(std::vector<double> values, double share) {
  if (values.empty()) return 0.0;
  const auto place = static_cast<std::size_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(place),
                   values.end());
  return values[place];
}

std::vector<double> values_of(const Seens& seens, double Seen::* member, bool size = false) {
  std::vector<double> values;
  values.reserve(seens.list.size());
  for (const Seen& each : seens.list) {
    values.push_back(size ? std::abs(each.*member) : each.*member);
  }
  return values;
}

MissingMap map_of(const Seens& seens) {
  const std::vector<double> q = values_of(seens, &Seen::q);
  const double v_most = std::max(quantile(values_of(seens, &Seen::v, true), 0.995), 1e-9);
  MissingMap map{.q_low = *std::min_element(q.begin(), q.end()),
                 .q_high = *std::max_element(q.begin(), q.end()),
                 .v_most = v_most,
                 .columns = kColumns,
                 .rows = kSpeeds};
  const double width = std::max(map.q_high - map.q_low, 1e-9);
  map.cells = means_in(seens, kColumns * kSpeeds, [&](const Seen& each) -> std::size_t {
    const double x = (each.q - map.q_low) / width * kColumns;
    const double y = (each.v + v_most) / (2.0 * v_most) * kSpeeds;
    if (y < 0.0 || y >= kSpeeds) return kColumns * kSpeeds;
    const auto column = std::min(static_cast<std::size_t>(std::max(x, 0.0)), kColumns - 1);
    return static_cast<std::size_t>(y) * kColumns + column;
  });
  return map;
}

MissingProfile profile_of(const Seens& seens, const Quantity& quantity) {
  MissingProfile profile{.quantity = quantity.name, .unit = quantity.unit};
  const std::vector<double> edges = even_edges(values_of(seens, quantity.of), kBins);
  const std::size_t bins = edges.size() + 1;
  const auto bin_of = [&](const Seen& each) {
    const auto place = std::upper_bound(edges.begin(), edges.end(), each.*quantity.of);
    return static_cast<std::size_t>(place - edges.begin());
  };
  profile.means = means_in(seens, bins, bin_of);
  profile.middles.assign(bins, 0.0);
  double mean = 0.0;
  double power = 0.0;
  for (const Seen& each : seens.list) {
    const std::size_t bin = bin_of(each);
    profile.middles[bin] += each.*quantity.of / static_cast<double>(profile.means[bin].rows);
    mean += each.missing;
    power += each.missing * each.missing;
  }
  const auto rows = static_cast<double>(seens.list.size());
  mean /= rows;
  const double variance = power / rows - mean * mean;
  double followed = 0.0;
  for (const MissingMean& each : profile.means) {
    const double off = each.mean - mean;
    followed += static_cast<double>(each.rows) / rows *
                std::max(0.0, off * off - each.deviation * each.deviation);
  }
  profile.share = variance > 0.0 ? std::clamp(followed / variance, 0.0, 1.0) : 0.0;
  return profile;
}

/// Torque against the direction, in slow and in fast motion.
void look_at_direction(const Seens& seens, AxisMiss& miss) {
  constexpr double kNoise = 0.02;  // rad/s, of the tethered simulation, about
  std::vector<double> moving;
  for (const Seen& each : seens.list) {
    if (std::abs(each.v) > kNoise) moving.push_back(std::abs(each.v));
  }
  const double middle = quantile(moving, 0.5);
  std::array<double, 2> sum{};
  std::array<double, 2> rows{};
  for (const Seen& each : seens.list) {
    if (std::abs(each.v) <= kNoise) continue;
    const std::size_t half = std::abs(each.v) > middle ? 1 : 0;
    sum[half] -= each.v > 0.0 ? each.missing : -each.missing;
    rows[half] += 1.0;
  }
  miss.slow = sum[0] / std::max(rows[0], 1.0);
  miss.fast = sum[1] / std::max(rows[1], 1.0);
}

/// Torques of one axis under one model.
AxisMiss torque_miss(const Likelihood& likelihood, const std::vector<Rows>& rows, Index axis) {
  AxisMiss miss;
  const Seens seens = seens_of(likelihood, rows, axis);
  if (seens.list.empty()) return miss;
  double power = 0.0;
  for (const Seen& each : seens.list) {
    power += each.missing * each.missing;
  }
  miss.torque = std::sqrt(power / static_cast<double>(seens.list.size()));
  miss.mean = means_in(seens, 1, [](const Seen&) { return std::size_t{0}; }).front();
  miss.map = map_of(seens);
  miss.profiles.reserve(kQuantities.size());
  for (const Quantity& quantity : kQuantities) {
    miss.profiles.push_back(profile_of(seens, quantity));
  }
  look_at_direction(seens, miss);
  return miss;
}

/// Whitened innovations of one axis, a run each.
std::vector<std::vector<double>> whitened_of(const std::vector<Eigen::VectorXf>& errors,
                                             std::size_t axis) {
  std::vector<std::vector<double>> runs;
  runs.reserve(errors.size());
  for (const Eigen::VectorXf& w : errors) {
    std::vector<double> own;
    own.reserve(static_cast<std::size_t>(w.size()) / kJoints);
    for (Index k = static_cast<Index>(axis); k < w.size(); k += 3) {
      own.push_back(static_cast<double>(w[k]));
    }
    runs.push_back(std::move(own));
  }
  return runs;
}

std::vector<double> frequencies(double period_s) {
  constexpr int kCount = 60;
  constexpr double kLowest = 1.0;
  const double highest = 0.45 / period_s;
  std::vector<double> f_Hz;
  f_Hz.reserve(kCount);
  for (int i = 0; i < kCount; ++i) {
    f_Hz.push_back(kLowest * std::pow(highest / kLowest, static_cast<double>(i) / (kCount - 1)));
  }
  return f_Hz;
}

std::array<AxisMiss, kJoints> miss_of(const Likelihood& likelihood,
                                      const Fit& fit,
                                      const std::vector<Rows>& rows,
                                      const std::vector<double>& f_Hz) {
  std::array<AxisMiss, kJoints> all;
  const std::vector<Eigen::VectorXf> errors = likelihood.errors(fit.model);
  for_each_index(kJoints, likelihood.threads(), [&](std::size_t i) {
    AxisMiss& miss = all.at(i);
    miss = torque_miss(likelihood, rows, static_cast<Index>(i));
    const auto runs = whitened_of(errors, i);
    miss.spectrum = whitened_spectrum(runs, likelihood.data().period_s, f_Hz);
    for (const std::vector<double>& w : runs) {
      double power = 0.0;
      for (const double each : w) {
        power += each * each / static_cast<double>(w.size());
      }
      miss.run_power.push_back(power);
    }
  });
  return all;
}

}  // namespace

Localisation localise(const Likelihood& likelihood, const SearchResult& found) {
  const DiagnosisCase& data = likelihood.data();
  Localisation result;
  result.nominal_rows.resize(likelihood.runs());
  result.corrected_rows.resize(likelihood.runs());
  for_each_index(likelihood.runs(), likelihood.threads(), [&](std::size_t run) {
    const TorqueSmoother smoother{likelihood.arm(), data.runs[run], data.period_s,
                                  found.nominal.noise};
    const auto rows_of = [&](const MachineModel& model) {
      const PlantTerms terms = terms_of(model.effects);
      return smoother.smooth({likelihood.prior().arm(model.base), terms});
    };
    result.nominal_rows[run] = rows_of(found.nominal.fit.model);
    result.corrected_rows[run] = rows_of(found.best.fit.model);
  });
  result.f_Hz = frequencies(data.period_s);
  result.nominal = miss_of(likelihood, found.nominal.fit, result.nominal_rows, result.f_Hz);
  result.corrected = miss_of(likelihood, found.best.fit, result.corrected_rows, result.f_Hz);
  std::vector<std::string> names;
  names.reserve(data.runs.size());
  for (const Recording& run : data.runs) {
    names.push_back(run.name);
  }
  put_in_words(result, names);
  return result;
}

}  // namespace teleop
