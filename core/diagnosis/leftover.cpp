#include "core/diagnosis/leftover.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <Eigen/Cholesky>
#include <fmt/format.h>

#include "core/diagnosis/chance.hpp"
#include "core/diagnosis/parallel.hpp"
#include "core/diagnosis/predictor.hpp"
#include "core/diagnosis/probes.hpp"
#include "core/diagnosis/torque_response.hpp"
#include "core/effects/vocabulary.hpp"

namespace teleop {
namespace {

using Eigen::Index;
using States = std::vector<PredictedState>;

constexpr Index kStretch = 500;  // samples

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// How far a stretch's mean square error stands out of those of the same run, as χ². In slow motion
/// the quantisation makes all of them uneven.
double strangeness(double value, const std::vector<double>& all) {
  constexpr double kNormal = 1.4826;  // standard deviation over median deviation
  constexpr double kCautious = 4.0;   // the spread itself is known from a few stretches only
  const double middle = median(all);
  std::vector<double> apart;
  apart.reserve(all.size());
  for (const double each : all) {
    apart.push_back(std::abs(each - middle));
  }
  const double least = std::sqrt(2.0 / kStretch) * middle;
  const double spread = std::max(kNormal * median(apart), least);
  return (value - middle) * (value - middle) / (kCautious * spread * spread);
}

/// Stretches of time whose errors are larger than the others', and single ones that stand out: what
/// no torque over angle, speed or command tells.
void add_irregularities(const Likelihood& likelihood,
                        const Fit& now,
                        std::vector<Leftover>& found) {
  constexpr double kLouder = 1.3;
  constexpr float kOutlier = 5.0F;
  for (std::size_t i = 0; i < likelihood.data().axes(); ++i) {
    Leftover stretch{.axis = i};
    Leftover jumps{.axis = i};
    std::size_t count = 0;
    for (std::size_t run = 0; run < now.errors.size(); ++run) {
      const Eigen::VectorXf& w = now.errors[run];
      const Eigen::Map<const Eigen::VectorXf, 0, Eigen::InnerStride<3>> own{w.data() + i,
                                                                            w.size() / 3};
      std::vector<double> power;
      for (Index first = 0; first + kStretch <= own.size(); first += kStretch) {
        power.push_back(static_cast<double>(own.segment(first, kStretch).squaredNorm()) / kStretch);
      }
      const auto most = std::max_element(power.begin(), power.end());
      if (most == power.end()) continue;
      const double gain = strangeness(*most, power);
      if (*most > kLouder && gain > stretch.gain) {
        const auto first = static_cast<double>((most - power.begin()) * kStretch);
        stretch.gain = gain;
        stretch.quantity =
            fmt::format("one stretch of time ({}, from {:.1f} s)", likelihood.data().runs[run].name,
                        first * likelihood.data().period_s);
      }
      for (const float each : own) {
        if (std::abs(each) <= kOutlier) continue;
        jumps.gain += static_cast<double>(each * each);
        ++count;
      }
    }
    jumps.quantity = fmt::format("{} sudden jumps", count);
    found.push_back(std::move(stretch));
    if (count > 0) found.push_back(std::move(jumps));
  }
}

/// Products of columns and errors, a row each tenth of a second.
std::vector<Eigen::MatrixXd> pulls_by_stretch(const std::vector<Eigen::MatrixXf>& columns,
                                              const std::vector<Eigen::VectorXf>& errors) {
  constexpr Index kTenth = 3 * 100;  // three axes a sample
  std::vector<Eigen::MatrixXd> pulls(errors.size());
  for (std::size_t run = 0; run < errors.size(); ++run) {
    const Index count = (errors[run].size() + kTenth - 1) / kTenth;
    pulls[run].resize(count, columns[run].cols());
    for (Index i = 0; i < count; ++i) {
      const Index size = std::min(kTenth, errors[run].size() - i * kTenth);
      pulls[run].row(i) = (columns[run].middleRows(i * kTenth, size).transpose() *
                           errors[run].segment(i * kTenth, size))
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
  const ProbeScales scales = probe_scales(data, states);
  const Eigen::LDLT<Eigen::MatrixXd> known{now.information};
  const std::vector<Eigen::MatrixXd> known_pulls = pulls_by_stretch(now.slopes, now.errors);
  const std::size_t quantities = probe_count();
  Leftovers found;
  found.all.resize(quantities * data.axes());
  Pulls pulls{.by_stretch =
                  Eigen::MatrixXd::Zero(rows_of(known_pulls), static_cast<Index>(found.all.size())),
              .weight = Eigen::VectorXd::Ones(static_cast<Index>(found.all.size()))};
  for_each_index(found.all.size(), likelihood.threads(), [&](std::size_t job) {
    const std::size_t quantity = job % quantities;
    const auto axis = static_cast<Index>(job / quantities);
    Eigen::VectorXd cross = Eigen::VectorXd::Zero(now.information.rows());
    double own = 0.0;
    double power = 0.0;
    double rows = 0.0;
    std::vector<Eigen::MatrixXf> columns(runs);
    for (std::size_t run = 0; run < runs; ++run) {
      std::vector<JointVector> torque(data.runs[run].rows(), JointVector::Zero());
      for (std::size_t k = 0; k < torque.size(); ++k) {
        torque[k][axis] =
            probe_torque(quantity, probe_row(data.runs[run], states[run], k, axis, scales));
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
    result.quantity = probe_name(quantity);
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
