#include "core/tuning/oscillation.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include <Eigen/Dense>

namespace teleop {
namespace {

constexpr std::size_t kFewestSamples = 12;
constexpr double kSignificant = 5.0;  ///< deviations of an amplitude
constexpr double kSmallest = 3.5;     ///< noise deviations, a count; below it rounding makes modes
constexpr double kShare = 0.08;       ///< of the largest oscillation: harmonics are smaller
constexpr int kMostIterations = 40;

/// Model and its derivatives at one set of parameters. Layout: c0, c1, then per mode (σ, ω, a, b)
/// or, where it does not oscillate, (σ, a); last, if bent, ρ of mode 0.
struct Model {
  std::vector<FreeMode> modes;
  bool bent = false;

  [[nodiscard]] Eigen::Index size() const {
    Eigen::Index n = bent ? 3 : 2;
    for (const FreeMode& mode : modes) {
      n += mode.omega_rad_per_s > 0.0 ? 4 : 2;
    }
    return n;
  }

  /// Row of derivatives at τ; returns the value.
  template <class Row>
  double evaluate(const Eigen::VectorXd& p, double tau, Row&& row) const {
    double value = p[0] + p[1] * tau;
    row[0] = 1.0;
    row[1] = tau;
    Eigen::Index at = 2;
    for (std::size_t i = 0; i < modes.size(); ++i) {
      const bool turns = modes[i].omega_rad_per_s > 0.0;
      const double bend = bent && i == 0 ? p[size() - 1] : 0.0;
      const double envelope = std::exp(std::clamp(p[at] * tau + 0.5 * bend * tau * tau, -50., 50.));
      const double c = turns ? std::cos(p[at + 1] * tau) : 1.0;
      const double s = turns ? std::sin(p[at + 1] * tau) : 0.0;
      const double a = p[at + (turns ? 2 : 1)];
      const double b = turns ? p[at + 3] : 0.0;
      const double term = envelope * (a * c + b * s);
      value += term;
      row[at] = tau * term;
      if (turns) {
        row[at + 1] = tau * envelope * (b * c - a * s);
        row[at + 2] = envelope * c;
        row[at + 3] = envelope * s;
      } else {
        row[at + 1] = envelope * c;
      }
      if (bent && i == 0) row[size() - 1] = 0.5 * tau * tau * term;
      at += turns ? 4 : 2;
    }
    return value;
  }
};

struct Fit {
  Model model;
  Eigen::VectorXd p;
  Eigen::MatrixXd covariance;
  double residual_std = 0.0;
};

struct Normal {
  Eigen::MatrixXd J_J;
  Eigen::VectorXd J_r;
  double sum = 0.0;
  double lagged = 0.0;  ///< Σ r[k] r[k+1]
};

Normal normal_equations(const Model& model,
                        const Eigen::VectorXd& p,
                        const Record& record,
                        double middle_s) {
  const auto rows = static_cast<Eigen::Index>(record.y.size());
  Eigen::MatrixXd J(rows, model.size());
  Eigen::VectorXd r(rows);
  for (Eigen::Index k = 0; k < rows; ++k) {
    const auto i = static_cast<std::size_t>(k);
    r[k] = record.y[i] - model.evaluate(p, record.t_s[i] - middle_s, J.row(k));
  }
  return {.J_J = J.transpose() * J,
          .J_r = J.transpose() * r,
          .sum = r.squaredNorm(),
          .lagged = r.head(rows - 1).dot(r.tail(rows - 1))};
}

/// Amplitudes of the modes at their starting poles: the part of the problem that is linear.
Eigen::VectorXd start(const Model& model, const Record& record, double middle_s) {
  Eigen::VectorXd p = Eigen::VectorXd::Zero(model.size());
  std::vector<Eigen::Index> linear{0, 1};
  Eigen::Index at = 2;
  for (const FreeMode& mode : model.modes) {
    const bool turns = mode.omega_rad_per_s > 0.0;
    p[at] = mode.growth_per_s;
    if (turns) p[at + 1] = mode.omega_rad_per_s;
    linear.push_back(at + (turns ? 2 : 1));
    if (turns) linear.push_back(at + 3);
    at += turns ? 4 : 2;
  }
  const Normal at_zero = normal_equations(model, p, record, middle_s);
  const auto n = static_cast<Eigen::Index>(linear.size());
  Eigen::MatrixXd J_J(n, n);
  Eigen::VectorXd J_r(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    J_r[i] = at_zero.J_r[linear[static_cast<std::size_t>(i)]];
    for (Eigen::Index j = 0; j < n; ++j) {
      J_J(i, j) =
          at_zero.J_J(linear[static_cast<std::size_t>(i)], linear[static_cast<std::size_t>(j)]);
    }
  }
  const Eigen::VectorXd scale = J_J.diagonal().cwiseSqrt().cwiseMax(1e-300).cwiseInverse();
  const Eigen::MatrixXd scaled = scale.asDiagonal() * J_J * scale.asDiagonal();
  const Eigen::VectorXd solution =
      scale.asDiagonal() * scaled.completeOrthogonalDecomposition().solve(scale.asDiagonal() * J_r);
  for (Eigen::Index i = 0; i < n; ++i) {
    p[linear[static_cast<std::size_t>(i)]] = solution[i];
  }
  return p;
}

/// Levenberg–Marquardt, columns scaled to equal length.
std::optional<Fit> refine(const Model& model,
                          Eigen::VectorXd p,
                          const Record& record,
                          double noise_std) {
  const double middle_s = 0.5 * (record.t_s.front() + record.t_s.back());
  const Eigen::Index n = model.size();
  const auto samples = static_cast<double>(record.y.size());
  if (samples < static_cast<double>(n) + 2.0) return std::nullopt;
  Normal here = normal_equations(model, p, record, middle_s);
  double damping = 1e-3;
  for (int i = 0; i < kMostIterations; ++i) {
    const Eigen::VectorXd scale = here.J_J.diagonal().cwiseSqrt().cwiseMax(1e-300).cwiseInverse();
    Eigen::MatrixXd A = scale.asDiagonal() * here.J_J * scale.asDiagonal();
    A.diagonal().array() += damping;
    const Eigen::VectorXd step = scale.asDiagonal() * A.ldlt().solve(scale.asDiagonal() * here.J_r);
    if (!step.allFinite()) return std::nullopt;
    const Eigen::VectorXd next = p + step;
    const Normal there = normal_equations(model, next, record, middle_s);
    if (std::isfinite(there.sum) && there.sum <= here.sum) {
      const bool settled = here.sum - there.sum < 1e-9 * here.sum;
      p = next;
      here = there;
      damping = std::max(damping / 10.0, 1e-12);
      if (settled) break;
    } else {
      damping *= 10.0;
      if (damping > 1e6) break;
    }
  }
  // Correlated residuals inform less: their count shrinks by (1 + r)/(1 − r).
  const double r = std::clamp(here.lagged / std::max(here.sum, 1e-300), 0.0, 0.95);
  const double floor = 0.1 * noise_std;
  const double variance = std::max(here.sum / (samples - static_cast<double>(n)), floor * floor) *
                          (1.0 + r) / (1.0 - r);
  const Eigen::VectorXd scale = here.J_J.diagonal().cwiseSqrt().cwiseMax(1e-300).cwiseInverse();
  const Eigen::MatrixXd A = scale.asDiagonal() * here.J_J * scale.asDiagonal();
  const Eigen::MatrixXd inverse = A.completeOrthogonalDecomposition().pseudoInverse();
  return Fit{.model = model,
             .p = p,
             .covariance = variance * (scale.asDiagonal() * inverse * scale.asDiagonal()),
             .residual_std = std::sqrt(here.sum / samples)};
}

/// Modes worth fitting: what dies within a few samples or barely bends over the record is left to
/// the first samples and to the straight line.
std::vector<FreeMode> worth_fitting(const std::vector<FreeMode>& found,
                                    double dt_s,
                                    double span_s) {
  std::vector<FreeMode> kept;
  for (const FreeMode& mode : found) {
    const bool lives = mode.growth_per_s > -0.7 / dt_s;
    const bool turns = mode.omega_rad_per_s * span_s > 2.5;
    // An envelope that is no exponential looks like several of one frequency; the bend is for that.
    const bool is_new = std::none_of(kept.begin(), kept.end(), [&](const FreeMode& other) {
      constexpr double kApart = 0.5;  // turns over the record
      return std::abs(other.omega_rad_per_s - mode.omega_rad_per_s) * span_s <
             2.0 * std::numbers::pi * kApart;
    });
    if (turns && lives && is_new) kept.push_back(mode);
    const bool bends = std::abs(mode.growth_per_s) * span_s > 2.0;
    if (!turns && lives && bends) kept.push_back({mode.growth_per_s, 0.0});
  }
  return kept;
}

struct Place {
  Eigen::Index at = -1;  ///< of σ in the parameters
  std::size_t mode = 0;
};

/// The modes that oscillate and stand out, the one that grows most first.
std::vector<Place> standing_out(const Fit& fit, double noise_std, double half_span_s) {
  double largest_of_all = 0.0;
  const auto largest_at = [&](Eigen::Index at) {
    return std::hypot(fit.p[at + 2], fit.p[at + 3]) * std::exp(std::abs(fit.p[at]) * half_span_s);
  };
  Eigen::Index at = 2;
  for (const FreeMode& mode : fit.model.modes) {
    const bool turns = mode.omega_rad_per_s > 0.0;
    if (turns) largest_of_all = std::max(largest_of_all, largest_at(at));
    at += turns ? 4 : 2;
  }
  std::vector<Place> places;
  at = 2;
  for (std::size_t i = 0; i < fit.model.modes.size(); ++i) {
    const bool turns = fit.model.modes[i].omega_rad_per_s > 0.0;
    if (turns) {
      const double middle = std::hypot(fit.p[at + 2], fit.p[at + 3]);
      const double deviation =
          std::sqrt(fit.covariance(at + 2, at + 2) + fit.covariance(at + 3, at + 3));
      const bool stands =
          middle > kSignificant * deviation &&
          largest_at(at) > std::max(kSmallest * noise_std, kShare * largest_of_all) &&
          fit.p[at + 1] > 0.0;
      if (stands) places.push_back({.at = at, .mode = i});
    }
    at += turns ? 4 : 2;
  }
  std::sort(places.begin(), places.end(),
            [&](const Place& a, const Place& b) { return fit.p[a.at] > fit.p[b.at]; });
  return places;
}

/// The same modes with number `first` in front.
Model bent_at(const Model& model, std::size_t first) {
  Model bent = model;
  std::rotate(bent.modes.begin(), bent.modes.begin() + static_cast<std::ptrdiff_t>(first),
              bent.modes.begin() + static_cast<std::ptrdiff_t>(first) + 1);
  bent.bent = true;
  return bent;
}

/// τ within the middle half at which the envelope comes nearest to the wanted amplitude.
double instant_of(double wanted, double middle, double growth, double bend, double half_span_s) {
  const double limit = 0.5 * half_span_s;
  if (wanted <= 0.0 || middle <= 0.0) return 0.0;
  const double target = std::log(wanted / middle);
  double best = 0.0;
  double distance = std::abs(target);
  constexpr int kSteps = 40;
  for (int k = -kSteps; k <= kSteps; ++k) {
    const double tau = limit * k / kSteps;
    const double d = std::abs(growth * tau + 0.5 * bend * tau * tau - target);
    if (d < distance - 1e-9) {
      distance = d;
      best = tau;
    }
  }
  return best;
}

Oscillation describe(const Fit& fit, Eigen::Index at, double half_span_s, double wanted) {
  const double growth = fit.p[at];
  const Eigen::Index last = fit.p.size() - 1;
  const bool bent = fit.model.bent;
  const double bend = bent ? fit.p[last] : 0.0;
  const double middle = std::hypot(fit.p[at + 2], fit.p[at + 3]);
  const double tau = bent ? instant_of(wanted, middle, growth, bend, half_span_s) : 0.0;
  double variance = fit.covariance(at, at);
  if (bent) {
    variance += 2.0 * tau * fit.covariance(at, last) + tau * tau * fit.covariance(last, last);
  }
  const auto envelope = [&](double t) {
    return middle * std::exp(growth * t + 0.5 * bend * t * t);
  };
  constexpr double kTurn = 2.0 * std::numbers::pi;
  return {.growth_per_s = growth + bend * tau,
          .growth_std_per_s = std::sqrt(std::max(variance, 0.0)),
          .frequency_Hz = fit.p[at + 1] / kTurn,
          .frequency_std_Hz = std::sqrt(std::max(fit.covariance(at + 1, at + 1), 0.0)) / kTurn,
          .amplitude_start = envelope(-half_span_s),
          .amplitude_end = envelope(half_span_s),
          .amplitude_here = envelope(tau),
          .residual_std = fit.residual_std,
          .modes = static_cast<int>(fit.model.modes.size())};
}

}  // namespace

std::vector<Oscillation> fit_oscillations(const Record& record,
                                          double noise_std,
                                          double amplitude_wanted) {
  if (record.y.size() < kFewestSamples) return {};
  const double span_s = record.t_s.back() - record.t_s.front();
  const double dt_s = span_s / static_cast<double>(record.y.size() - 1);
  Model model{.modes = worth_fitting(find_modes(record.y, dt_s, noise_std), dt_s, span_s)};
  if (model.modes.empty()) return {};
  const double middle_s = 0.5 * (record.t_s.front() + record.t_s.back());
  std::optional<Fit> fit = refine(model, start(model, record, middle_s), record, noise_std);
  if (!fit) return {};
  const std::vector<Place> places = standing_out(*fit, noise_std, 0.5 * span_s);
  if (places.empty()) return {};
  std::vector<Oscillation> found;
  found.reserve(places.size());
  for (const Place& one : places) {
    found.push_back(describe(*fit, one.at, 0.5 * span_s, amplitude_wanted));
  }
  const Place& place = places.front();

  const Model bent = bent_at(model, place.mode);
  Eigen::VectorXd p(bent.size());
  p.head(2) = fit->p.head(2);
  p.segment(2, 4) = fit->p.segment(place.at, 4);
  p.segment(6, place.at - 2) = fit->p.segment(2, place.at - 2);
  const Eigen::Index behind = fit->p.size() - place.at - 4;
  p.segment(place.at + 4, behind) = fit->p.tail(behind);
  p[bent.size() - 1] = 0.0;
  const std::optional<Fit> curved = refine(bent, p, record, noise_std);
  if (curved) {
    const Eigen::Index last = bent.size() - 1;
    const double deviation = std::sqrt(std::max(curved->covariance(last, last), 0.0));
    if (std::abs(curved->p[last]) > 3.0 * deviation) {
      found.front() = describe(*curved, 2, 0.5 * span_s, amplitude_wanted);
    }
  }
  return found;
}

Phasor phasor_of(const Record& record, const FreeMode& mode) {
  const double middle_s = 0.5 * (record.t_s.front() + record.t_s.back());
  const Model model{.modes = {mode}};
  const Eigen::VectorXd p = start(model, record, middle_s);
  return {.in_phase = p[4], .quadrature = p[5]};
}

}  // namespace teleop
