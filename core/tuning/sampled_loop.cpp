#include "core/tuning/sampled_loop.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/Dense>

#include "core/base/contract.hpp"
#include "core/math/matrix_exponential.hpp"

namespace teleop {
namespace {

using Row = Eigen::RowVectorXd;

/// An arm over one period: z[k+1] = Φ z + Γ_new u[k−n] + Γ_old u[k−n−1], y = C z + D u[k−m].
struct DiscreteArm {
  Eigen::MatrixXd phi;
  Eigen::VectorXd gamma_new;
  Eigen::VectorXd gamma_old;
  Row C;
  double D = 0.0;
  int n = 0;  ///< whole periods of delay
  int m = 1;  ///< age of the command that acts when y is measured
  int queue = 0;
};

/// Continuous motion, time in ms, with the acting command as the last row.
Eigen::MatrixXd motion(const LinearAxis::Config& arm) {
  const bool two = arm.second_mass_kg > 0.0;
  const bool lags = arm.lag_s > 0.0;
  const Eigen::Index moving = two ? 4 : 2;
  const Eigen::Index size = moving + (lags ? 1 : 0) + 1;
  constexpr double kT = 1e-3;
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(size, size);
  const double m1 = arm.mass_kg;
  A(0, 1) = 1.0;
  A(1, 1) = -(arm.damping_Ns_per_m + arm.joint_damping_Ns_per_m) / m1 * kT;
  A(1, moving) = kT * kT / m1;
  if (two) {
    const double m2 = arm.second_mass_kg;
    A(1, 0) = -arm.joint_N_per_m / m1 * kT * kT;
    A(1, 2) = -A(1, 0);
    A(1, 3) = arm.joint_damping_Ns_per_m / m1 * kT;
    A(2, 3) = 1.0;
    A(3, 0) = arm.joint_N_per_m / m2 * kT * kT;
    A(3, 2) = -A(3, 0);
    A(3, 1) = arm.joint_damping_Ns_per_m / m2 * kT;
    A(3, 3) = -A(3, 1);
  }
  if (lags) {
    A(moving, moving) = -kT / arm.lag_s;
    A(moving, moving + 1) = kT / arm.lag_s;
  }
  return A;
}

DiscreteArm discretise(const LinearAxis::Config& arm, double period_s) {
  const Eigen::MatrixXd A = motion(arm);
  const Eigen::Index size = A.rows() - 1;
  // The plant counts in nanoseconds; a delay within one of a whole period is a whole period.
  const double periods = std::round(arm.delay_s * 1e9) / std::round(period_s * 1e9);
  const int n = static_cast<int>(std::floor(periods + 1e-9));
  const double part = std::max(periods - n, 0.0);
  const bool whole = part < 1e-9;
  const double period_ms = period_s * 1e3;
  const Eigen::MatrixXd first = matrix_exponential<Eigen::MatrixXd>(A * (part * period_ms));
  const Eigen::MatrixXd second =
      matrix_exponential<Eigen::MatrixXd>(A * ((1.0 - part) * period_ms));

  DiscreteArm d;
  const Eigen::MatrixXd phi = second.topLeftCorner(size, size);
  d.phi = phi * first.topLeftCorner(size, size);
  d.gamma_new = second.topRightCorner(size, 1);
  d.gamma_old = phi * first.topRightCorner(size, 1);
  d.C = Row::Zero(size);
  d.C[0] = 1.0;
  d.n = n;
  d.m = whole ? std::max(n, 1) : n + 1;
  d.queue = whole ? n : n + 1;
  if (arm.tendon_N_per_m > 0.0) {
    if (arm.lag_s > 0.0) {
      d.C[size - 1] = 1.0 / arm.tendon_N_per_m;
    } else {
      d.D = 1.0 / arm.tendon_N_per_m;
      d.queue = std::max(d.queue, d.m);
    }
  }
  return d;
}

double low_pass(const SampledLoop& loop) {
  const double cutoff = loop.velocity.difference.cutoff_Hz;
  if (cutoff == 0.0) return 1.0;
  return 1.0 - std::exp(-2.0 * std::numbers::pi * cutoff * loop.period_s);
}

/// Where the parts of one arm stand in the whole state.
struct Layout {
  Eigen::Index z = 0;
  Eigen::Index queue = 0;      ///< u[k−1], u[k−2], …
  Eigen::Index estimator = 0;  ///< y[k−1] and v[k−1], or y[k−1] … y[k−N]
  Eigen::Index peer = 0;       ///< (y, v)[k−1], … as the other arm sees it
  Eigen::Index end = 0;
};

Eigen::Index estimator_states(const SampledLoop& loop) {
  return loop.velocity.kind == "mean" ? loop.velocity.mean.samples : 2;
}

/// Assembles S a row at a time; a quantity of this tick is a row over the state.
class Assembly {
 public:
  explicit Assembly(const SampledLoop& loop) : loop_{loop} {
    Eigen::Index at = 0;
    for (const LinearAxis::Config& arm : loop.arms) {
      arms_.push_back(discretise(arm, loop.period_s));
      Layout l;
      l.z = at;
      l.queue = l.z + arms_.back().phi.rows();
      l.estimator = l.queue + arms_.back().queue;
      l.peer = l.estimator + estimator_states(loop);
      l.end = l.peer + (loop.arms.size() > 1 ? 2 * loop.peer_delay_samples : 0);
      at = l.end;
      layout_.push_back(l);
    }
    size_ = at;
    S_ = Eigen::MatrixXd::Zero(size_, size_);
  }

  [[nodiscard]] Eigen::MatrixXd take() {
    for (std::size_t i = 0; i < arms_.size(); ++i) {
      y_.push_back(reading(i));
      v_.push_back(velocity(i));
    }
    for (std::size_t i = 0; i < arms_.size(); ++i) {
      advance(i, command(i));
    }
    return S_;
  }

 private:
  [[nodiscard]] Row unit(Eigen::Index at) const { return Row::Unit(size_, at); }

  [[nodiscard]] Row reading(std::size_t i) const {
    const DiscreteArm& arm = arms_[i];
    Row y = Row::Zero(size_);
    y.segment(layout_[i].z, arm.C.size()) = arm.C;
    if (arm.D != 0.0) y[layout_[i].queue + arm.m - 1] += arm.D;
    return y;
  }

  [[nodiscard]] Row velocity(std::size_t i) const {
    const Eigen::Index at = layout_[i].estimator;
    if (loop_.velocity.kind == "mean") {
      const int N = loop_.velocity.mean.samples;
      return (y_[i] - unit(at + N - 1)) / (N * loop_.period_s);
    }
    const double alpha = low_pass(loop_);
    return alpha * (y_[i] - unit(at)) / loop_.period_s + (1.0 - alpha) * unit(at + 1);
  }

  [[nodiscard]] Row command(std::size_t i) const {
    const auto coupled = [&](const Row& y, const Row& v) -> Row {
      return loop_.stiffness_N_per_m * y + loop_.damping_Ns_per_m * v;
    };
    Row u = -coupled(y_[i], v_[i]);
    if (arms_.size() == 1) return u;
    const std::size_t j = 1 - i;
    const Eigen::Index p = loop_.peer_delay_samples;
    if (p == 0) return u + coupled(y_[j], v_[j]);
    const Eigen::Index old = layout_[j].peer + 2 * (p - 1);
    return u + coupled(unit(old), unit(old + 1));
  }

  /// Rows at, at+width, … become the newest value and the older ones of the same chain.
  void shift(Eigen::Index at, Eigen::Index length, const Row& newest) {
    if (length == 0) return;
    S_.row(at) = newest;
    for (Eigen::Index k = 1; k < length; ++k) {
      S_.row(at + k) = unit(at + k - 1);
    }
  }

  void advance(std::size_t i, const Row& u) {
    const DiscreteArm& arm = arms_[i];
    const Layout& l = layout_[i];
    const auto past = [&](int age) -> Row {
      return age == 0 ? u : unit(l.queue + age - 1);
    };
    const Eigen::Index states = arm.phi.rows();
    S_.block(l.z, l.z, states, states) = arm.phi;
    S_.middleRows(l.z, states) += arm.gamma_new * past(arm.n);
    if (arm.queue > arm.n) S_.middleRows(l.z, states) += arm.gamma_old * past(arm.n + 1);
    shift(l.queue, arm.queue, u);
    if (loop_.velocity.kind == "mean") {
      shift(l.estimator, loop_.velocity.mean.samples, y_[i]);
    } else {
      S_.row(l.estimator) = y_[i];
      S_.row(l.estimator + 1) = v_[i];
    }
    if (l.end == l.peer) return;
    S_.row(l.peer) = y_[i];
    S_.row(l.peer + 1) = v_[i];
    for (Eigen::Index k = l.peer + 2; k < l.end; ++k) {
      S_.row(k) = unit(k - 2);
    }
  }

  const SampledLoop& loop_;
  std::vector<DiscreteArm> arms_;
  std::vector<Layout> layout_;
  Eigen::Index size_ = 0;
  Eigen::MatrixXd S_;
  std::vector<Row> y_;
  std::vector<Row> v_;
};

}  // namespace

bool is_linear(const SampledLoop& loop) {
  return loop.velocity.kind == "difference" || loop.velocity.kind == "mean";
}

Eigen::MatrixXd transition(const SampledLoop& loop) {
  expects(is_linear(loop), "sampled loop: the estimator is linear");
  expects(loop.arms.size() == 1 || loop.arms.size() == 2, "sampled loop: one or two arms");
  return Assembly{loop}.take();
}

double spectral_radius(const SampledLoop& loop) {
  const Eigen::VectorXcd roots = transition(loop).eigenvalues();
  double largest = 0.0;
  for (const std::complex<double>& root : roots) {
    const bool drifts = std::abs(root - 1.0) < 1e-7;
    if (!drifts) largest = std::max(largest, std::abs(root));
  }
  return largest;
}

std::complex<double> arm_response(const LinearAxis::Config& arm, double period_s, double omega) {
  const DiscreteArm d = discretise(arm, period_s);
  const std::complex<double> z = std::polar(1.0, omega * period_s);
  const Eigen::Index size = d.phi.rows();
  const Eigen::VectorXcd gamma = d.gamma_new * std::pow(z, -d.n) +
                                 (d.queue > d.n ? 1.0 : 0.0) * d.gamma_old * std::pow(z, -d.n - 1);
  const Eigen::MatrixXcd resolvent = z * Eigen::MatrixXcd::Identity(size, size) - d.phi;
  const Eigen::VectorXcd state = resolvent.partialPivLu().solve(gamma);
  return (d.C.cast<std::complex<double>>() * state).value() + d.D * std::pow(z, -d.m);
}

std::complex<double> estimator_response(const SampledLoop& loop, double omega) {
  const std::complex<double> back = std::polar(1.0, -omega * loop.period_s);
  if (loop.velocity.kind == "mean") {
    const int N = loop.velocity.mean.samples;
    return (1.0 - std::pow(back, N)) / (N * loop.period_s);
  }
  const double alpha = low_pass(loop);
  return alpha * (1.0 - back) / loop.period_s / (1.0 - (1.0 - alpha) * back);
}

}  // namespace teleop
