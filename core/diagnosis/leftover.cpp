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
  constexpr Index kTenth = 300;  // of three axes, a sample each
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

/// The probes of one model: what a torque that follows a quantity would do to its errors.
class Probing {
 public:
  Probing(const Likelihood& likelihood, const Fit& now)
      : likelihood_{&likelihood},
        now_{&now},
        states_(likelihood.runs()),
        mobility_(likelihood.runs()),
        known_{now.information},
        known_pulls_{pulls_by_stretch(now.slopes, now.errors)} {
    for_each_index(likelihood.runs(), likelihood.threads(), [&](std::size_t run) {
      states_[run] = likelihood.states(run, now.model);
      mobility_[run] = mobilities(likelihood.arm(), likelihood.data().runs[run]);
    });
    scales_ = probe_scales(likelihood.data(), states_);
  }

  [[nodiscard]] Index stretches() const { return rows_of(known_pulls_); }

  struct Result {
    Leftover leftover{};
    Eigen::VectorXd pulls{};  ///< of each stretch; none where the parameters leave nothing of it
    double weight = 1.0;
  };

  [[nodiscard]] Result of(std::size_t quantity, Index axis) const {
    constexpr double kNew = 1e-3;  // share of a probe that the parameters must leave
    Eigen::VectorXd cross = Eigen::VectorXd::Zero(now_->information.rows());
    double before = 0.0;
    double power = 0.0;
    double rows = 0.0;
    std::vector<Eigen::MatrixXf> columns(states_.size());
    for (std::size_t run = 0; run < columns.size(); ++run) {
      const std::vector<JointVector> torque = torque_of(quantity, axis, run);
      for (const JointVector& each : torque) {
        power += each.squaredNorm();
      }
      rows += static_cast<double>(torque.size());
      columns[run] = torque_response(likelihood_->tether(run), mobility_[run],
                                     likelihood_->data().period_s, torque, Likelihood::kSettling);
      cross += (now_->slopes[run].transpose() * columns[run]).cast<double>();
      before += static_cast<double>(columns[run].squaredNorm());
    }
    const Eigen::VectorXd explained = known_.solve(cross);
    Result result{
        .leftover = {.axis = static_cast<std::size_t>(axis), .quantity = probe_name(quantity)}};
    const double own = before - cross.dot(explained);
    if (own < kNew * before) return result;
    result.weight = own;
    result.pulls.resize(stretches());
    const std::vector<Eigen::MatrixXd> own_pulls = pulls_by_stretch(columns, now_->errors);
    Index first = 0;
    for (std::size_t run = 0; run < own_pulls.size(); ++run) {
      result.pulls.segment(first, own_pulls[run].rows()) =
          own_pulls[run].col(0) - known_pulls_[run] * explained;
      first += own_pulls[run].rows();
    }
    const double pull = result.pulls.sum();
    result.leftover.gain = pull * pull / own;
    result.leftover.amplitude = std::abs(pull / own) * std::sqrt(power / rows);
    return result;
  }

 private:
  [[nodiscard]] std::vector<JointVector> torque_of(std::size_t quantity,
                                                   Index axis,
                                                   std::size_t run) const {
    const Recording& recording = likelihood_->data().runs[run];
    std::vector<JointVector> torque(recording.rows(), JointVector::Zero());
    for (std::size_t k = 0; k < torque.size(); ++k) {
      torque[k][axis] =
          probe_torque(quantity, probe_row(recording, states_[run], k, axis, scales_));
    }
    return torque;
  }

  const Likelihood* likelihood_;
  const Fit* now_;
  std::vector<States> states_;
  std::vector<std::vector<JointMatrix>> mobility_;
  Eigen::LDLT<Eigen::MatrixXd> known_;
  std::vector<Eigen::MatrixXd> known_pulls_;
  ProbeScales scales_{};
};

}  // namespace

Leftovers leftovers(const Likelihood& likelihood, const Fit& now) {
  const Probing probing{likelihood, now};
  Leftovers found;
  found.all.resize(probe_count() * likelihood.data().axes());
  const auto count = static_cast<Index>(found.all.size());
  Pulls pulls{.by_stretch = Eigen::MatrixXd::Zero(probing.stretches(), count),
              .weight = Eigen::VectorXd::Ones(count)};
  for_each_index(found.all.size(), likelihood.threads(), [&](std::size_t job) {
    const auto column = static_cast<Index>(job);
    Probing::Result result =
        probing.of(job % probe_count(), static_cast<Index>(job / probe_count()));
    pulls.weight[column] = result.weight;
    if (result.pulls.size() > 0) pulls.by_stretch.col(column) = result.pulls;
    found.all[job] = std::move(result.leftover);
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
