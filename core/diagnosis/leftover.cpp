#include "core/diagnosis/leftover.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <Eigen/Cholesky>
#include <fmt/format.h>

#include "core/diagnosis/chance.hpp"
#include "core/diagnosis/parallel.hpp"
#include "core/diagnosis/predictor.hpp"
#include "core/diagnosis/torque_response.hpp"
#include "core/effects/vocabulary.hpp"

namespace teleop {
namespace {

using Eigen::Index;

/// What a probe may look at, at one row.
struct Row {
  double q = 0.0;       ///< −1 to 1 over the range of the axis
  double v = 0.0;       ///< in units of its RMS
  double sign = 0.0;    ///< of v, smooth where v is within the noise
  double u = 0.0;       ///< in units of its RMS
  double u_rate = 0.0;  ///< in units of its RMS
  double t = 0.0;       ///< −1 to 1 over the run
  double q_other = 0.0;
  double v_other = 0.0;
  double sign_other = 0.0;
  double u_other = 0.0;
};

struct Probe {
  const char* quantity;
  double (*torque)(const Row&);
};

constexpr std::array kProbes{
    Probe{"constant",
          [](const Row&) {
            return 1.0;
          }},
    Probe{"angle",
          [](const Row& r) {
            return r.q;
          }},
    Probe{"angle squared",
          [](const Row& r) {
            return r.q * r.q;
          }},
    Probe{"angle cubed",
          [](const Row& r) {
            return r.q * r.q * r.q;
          }},
    Probe{"speed",
          [](const Row& r) {
            return r.v;
          }},
    Probe{"size of speed",
          [](const Row& r) {
            return std::abs(r.v);
          }},
    Probe{"speed squared, signed",
          [](const Row& r) {
            return r.v * std::abs(r.v);
          }},
    Probe{"speed cubed",
          [](const Row& r) {
            return r.v * r.v * r.v;
          }},
    Probe{"direction",
          [](const Row& r) {
            return r.sign;
          }},
    Probe{"direction in forward motion",
          [](const Row& r) {
            return std::max(r.sign, 0.0);
          }},
    Probe{"direction in slow motion",
          [](const Row& r) {
            return r.sign * std::exp(-r.v * r.v * 9.0);
          }},
    Probe{"direction × angle",
          [](const Row& r) {
            return r.sign * r.q;
          }},
    Probe{"direction × angle squared",
          [](const Row& r) {
            return r.sign * r.q * r.q;
          }},
    Probe{"direction × time",
          [](const Row& r) {
            return r.sign * r.t;
          }},
    Probe{"speed × angle",
          [](const Row& r) {
            return r.v * r.q;
          }},
    Probe{"speed × time",
          [](const Row& r) {
            return r.v * r.t;
          }},
    Probe{"command",
          [](const Row& r) {
            return r.u;
          }},
    Probe{"size of command",
          [](const Row& r) {
            return std::abs(r.u);
          }},
    Probe{"command squared, signed",
          [](const Row& r) {
            return r.u * std::abs(r.u);
          }},
    Probe{"command cubed",
          [](const Row& r) {
            return r.u * r.u * r.u;
          }},
    Probe{"command × time",
          [](const Row& r) {
            return r.u * r.t;
          }},
    Probe{"command × angle",
          [](const Row& r) {
            return r.u * r.q;
          }},
    Probe{"rate of command",
          [](const Row& r) {
            return r.u_rate;
          }},
    Probe{"direction × size of command",
          [](const Row& r) {
            return r.sign * std::abs(r.u);
          }},
    Probe{"time",
          [](const Row& r) {
            return r.t;
          }},
    Probe{"angle × time",
          [](const Row& r) {
            return r.q * r.t;
          }},
    Probe{"the next axis's angle",
          [](const Row& r) {
            return r.q_other;
          }},
    Probe{"the next axis's angle squared",
          [](const Row& r) {
            return r.q_other * r.q_other;
          }},
    Probe{"the next axis's angle × angle",
          [](const Row& r) {
            return r.q_other * r.q;
          }},
    Probe{"the next axis's speed",
          [](const Row& r) {
            return r.v_other;
          }},
    Probe{"the next axis's direction",
          [](const Row& r) {
            return r.sign_other;
          }},
    Probe{"the next axis's command",
          [](const Row& r) {
            return r.u_other;
          }},
    Probe{"direction × the next axis's angle",
          [](const Row& r) {
            return r.sign * r.q_other;
          }},
};

/// Scales of the rows, from all runs together.
struct Scales {
  JointVector middle = JointVector::Zero();
  JointVector half_range = JointVector::Ones();
  JointVector speed = JointVector::Ones();
  JointVector torque = JointVector::Ones();
  JointVector torque_rate = JointVector::Ones();
};

/// The range of an axis in so many places, each of which is a quantity by itself and together with
/// the direction.
constexpr std::size_t kPlaces = 10;
constexpr std::size_t kQuantities = kProbes.size() + 2 * kPlaces;

/// 1 at a place, falling off to its neighbours.
double nearness(std::size_t place, double q) {
  const double middle = (2.0 * static_cast<double>(place) + 1.0) / kPlaces - 1.0;
  const double x = (q - middle) * 0.6 * kPlaces;
  return std::exp(-x * x);
}

double torque_of(std::size_t quantity, const Row& row) {
  if (quantity < kProbes.size()) return kProbes[quantity].torque(row);
  const std::size_t place = quantity - kProbes.size();
  if (place < kPlaces) return nearness(place, row.q);
  return row.sign * nearness(place - kPlaces, row.q);
}

std::string name_of(std::size_t quantity) {
  if (quantity < kProbes.size()) return kProbes[quantity].quantity;
  const std::size_t place = quantity - kProbes.size();
  if (place < kPlaces) return fmt::format("angle near place {} of {}", place + 1, kPlaces);
  return fmt::format("direction near place {} of {}", place - kPlaces + 1, kPlaces);
}

using States = std::vector<PredictedState>;

Scales scales_of(const DiagnosisCase& data, const std::vector<States>& states) {
  JointVector low = JointVector::Constant(1e9);
  JointVector high = JointVector::Constant(-1e9);
  JointVector speed = JointVector::Zero();
  JointVector torque = JointVector::Zero();
  JointVector rate = JointVector::Zero();
  double rows = 0.0;
  for (std::size_t run = 0; run < states.size(); ++run) {
    const Recording& recording = data.runs[run];
    for (std::size_t k = 1; k < states[run].size(); ++k) {
      low = low.cwiseMin(states[run][k].q);
      high = high.cwiseMax(states[run][k].q);
      speed += states[run][k].qd.cwiseAbs2();
      torque += recording.tau[k].cwiseAbs2();
      rate += (recording.tau[k] - recording.tau[k - 1]).cwiseAbs2();
      rows += 1.0;
    }
  }
  const double tiny = 1e-12;
  return {.middle = (low + high) / 2.0,
          .half_range = ((high - low) / 2.0).cwiseMax(tiny),
          .speed = (speed / rows).cwiseSqrt().cwiseMax(tiny),
          .torque = (torque / rows).cwiseSqrt().cwiseMax(tiny),
          .torque_rate = (rate / rows).cwiseSqrt().cwiseMax(tiny)};
}

Row row_of(const Recording& run, const States& states, std::size_t k, Index i, const Scales& s) {
  constexpr double kSpeedNoise = 0.02;  // rad/s, of the tethered simulation, about
  const Index o = (i + 1) % 3;
  const PredictedState& at = states[k];
  const double rate = k > 0 ? run.tau[k][i] - run.tau[k - 1][i] : 0.0;
  return {.q = (at.q[i] - s.middle[i]) / s.half_range[i],
          .v = at.qd[i] / s.speed[i],
          .sign = std::tanh(at.qd[i] / kSpeedNoise),
          .u = run.tau[k][i] / s.torque[i],
          .u_rate = rate / s.torque_rate[i],
          .t = 2.0 * static_cast<double>(k) / static_cast<double>(run.rows()) - 1.0,
          .q_other = (at.q[o] - s.middle[o]) / s.half_range[o],
          .v_other = at.qd[o] / s.speed[o],
          .sign_other = std::tanh(at.qd[o] / kSpeedNoise),
          .u_other = run.tau[k][o] / s.torque[o]};
}

/// Stretches of time whose errors are larger than the others', and single ones that stand out: what
/// no torque over angle, speed or command tells.
void add_irregularities(const Likelihood& likelihood,
                        const Fit& now,
                        std::vector<Leftover>& found) {
  constexpr Index kStretch = 500;  // samples
  constexpr float kOutlier = 5.0F;
  for (std::size_t i = 0; i < likelihood.data().axes(); ++i) {
    Leftover stretch{.axis = i};
    Leftover jumps{.axis = i};
    std::size_t count = 0;
    for (std::size_t run = 0; run < now.errors.size(); ++run) {
      const Eigen::VectorXf& w = now.errors[run];
      const Eigen::Map<const Eigen::VectorXf, 0, Eigen::InnerStride<3>> own{w.data() + i,
                                                                            w.size() / 3};
      for (Index first = 0; first + kStretch <= own.size(); first += kStretch) {
        const double power = static_cast<double>(own.segment(first, kStretch).squaredNorm()) /
                             static_cast<double>(kStretch);
        const double gain = (power - 1.0) * (power - 1.0) * kStretch / 2.0;
        if (power <= 1.0 || gain <= stretch.gain) continue;
        const double start = static_cast<double>(first) * likelihood.data().period_s;
        stretch.gain = gain;
        stretch.quantity = fmt::format("one stretch of time ({}, from {:.1f} s)",
                                       likelihood.data().runs[run].name, start);
      }
      for (const float each : own) {
        if (std::abs(each) <= kOutlier) continue;
        jumps.gain += static_cast<double>(each * each);
        ++count;
      }
    }
    jumps.quantity = fmt::format("{} sudden jumps", count);
    // Quantised readings of slow motion are uneven by themselves: only half of it counts.
    stretch.gain /= 2.0;
    found.push_back(std::move(stretch));
    if (count > 0) found.push_back(std::move(jumps));
  }
}

/// Products of columns and errors, a row each tenth of a second.
std::vector<Eigen::MatrixXd> pulls_by_stretch(const std::vector<Eigen::MatrixXf>& columns,
                                              const std::vector<Eigen::VectorXf>& errors) {
  constexpr Index kStretch = 3 * 100;  // three axes a sample
  std::vector<Eigen::MatrixXd> pulls(errors.size());
  for (std::size_t run = 0; run < errors.size(); ++run) {
    const Index count = (errors[run].size() + kStretch - 1) / kStretch;
    pulls[run].resize(count, columns[run].cols());
    for (Index i = 0; i < count; ++i) {
      const Index size = std::min(kStretch, errors[run].size() - i * kStretch);
      pulls[run].row(i) = (columns[run].middleRows(i * kStretch, size).transpose() *
                           errors[run].segment(i * kStretch, size))
                              .transpose()
                              .cast<double>();
    }
  }
  return pulls;
}

Index rows_of(const std::vector<Eigen::MatrixXd>& pulls) {
  Index rows = 0;
  for (const Eigen::MatrixXd& each : pulls) {
    rows += each.rows();
  }
  return rows;
}

}  // namespace

Leftovers leftovers(const Likelihood& likelihood, const Fit& now) {
  const DiagnosisCase& data = likelihood.data();
  const std::size_t runs = likelihood.runs();
  std::vector<States> states(runs);
  std::vector<std::vector<JointMatrix>> mobility(runs);
  for_each_index(runs, likelihood.threads(), [&](std::size_t run) {
    states[run] = likelihood.states(run, now.model);
    mobility[run] = mobilities(likelihood.arm(), data.runs[run]);
  });
  const Scales scales = scales_of(data, states);
  const Eigen::LDLT<Eigen::MatrixXd> known{now.information};
  const std::vector<Eigen::MatrixXd> known_pulls = pulls_by_stretch(now.slopes, now.errors);
  Leftovers found;
  found.all.resize(kQuantities * data.axes());
  Pulls pulls{.by_stretch =
                  Eigen::MatrixXd::Zero(rows_of(known_pulls), static_cast<Index>(found.all.size())),
              .weight = Eigen::VectorXd::Ones(static_cast<Index>(found.all.size()))};
  for_each_index(found.all.size(), likelihood.threads(), [&](std::size_t job) {
    const std::size_t quantity = job % kQuantities;
    const auto axis = static_cast<Index>(job / kQuantities);
    Eigen::VectorXd cross = Eigen::VectorXd::Zero(now.information.rows());
    double own = 0.0;
    double power = 0.0;
    double rows = 0.0;
    std::vector<Eigen::MatrixXf> columns(runs);
    for (std::size_t run = 0; run < runs; ++run) {
      std::vector<JointVector> torque(data.runs[run].rows(), JointVector::Zero());
      for (std::size_t k = 0; k < torque.size(); ++k) {
        torque[k][axis] = torque_of(quantity, row_of(data.runs[run], states[run], k, axis, scales));
        power += torque[k][axis] * torque[k][axis];
        rows += 1.0;
      }
      columns[run] = torque_response(likelihood.tether(run), mobility[run], data.period_s, torque,
                                     Likelihood::kSettling);
      cross += (now.slopes[run].transpose() * columns[run]).cast<double>();
      own += static_cast<double>(columns[run].squaredNorm());
    }
    const double before = own;
    const Eigen::VectorXd explained = known.solve(cross);
    own -= cross.dot(explained);
    constexpr double kNew = 1e-3;  // share of a probe that the parameters must leave
    Leftover& result = found.all[job];
    result.axis = static_cast<std::size_t>(axis);
    result.quantity = name_of(quantity);
    if (own < kNew * before) return;
    const std::vector<Eigen::MatrixXd> own_pulls = pulls_by_stretch(columns, now.errors);
    Index first = 0;
    for (std::size_t run = 0; run < runs; ++run) {
      pulls.by_stretch.col(static_cast<Index>(job)).segment(first, own_pulls[run].rows()) =
          own_pulls[run].col(0) - known_pulls[run] * explained;
      first += own_pulls[run].rows();
    }
    pulls.weight[static_cast<Index>(job)] = own;
    const double pull = pulls.by_stretch.col(static_cast<Index>(job)).sum();
    result.gain = pull * pull / own;
    result.amplitude = std::abs(pull / own) * std::sqrt(power / rows);
  });
  const auto by_gain = [](const Leftover& a, const Leftover& b) {
    return a.gain > b.gain;
  };
  const auto largest = std::min_element(found.all.begin(), found.all.end(), by_gain);
  constexpr std::uint64_t kSeed = 1;
  found.p_value = chance_of(largest->gain, pulls, kSeed);
  add_irregularities(likelihood, now, found.all);
  std::stable_sort(found.all.begin(), found.all.end(), by_gain);
  return found;
}

}  // namespace teleop
