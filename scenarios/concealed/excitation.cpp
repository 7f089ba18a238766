#include "scenarios/concealed/excitation.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>

namespace teleop::concealed {
namespace {

using std::numbers::pi;
constexpr double kLength = kStatedPeriod * static_cast<double>(kRows);

double log_uniform(Random& random, double low, double high) {
  return low * std::pow(high / low, random.uniform());
}

using Signal = std::vector<double>;

Signal sampled(const std::function<double(double)>& law) {
  Signal signal(kRows);
  for (std::size_t k = 0; k < kRows; ++k) {
    signal[k] = law(kStatedPeriod * static_cast<double>(k));
  }
  return signal;
}

/// A slow wander about the middle, rad.
Signal wander(double size, Random& random) {
  const double low = random.uniform(0.08, 0.16);
  const double high = random.uniform(0.2, 0.4);
  const double p1 = random.uniform(0.0, 2.0 * pi);
  const double p2 = random.uniform(0.0, 2.0 * pi);
  const double a = size * random.uniform(0.08, 0.2);
  return sampled([=](double t) {
    return a * std::sin(2.0 * pi * low * t + p1) + 0.5 * a * std::sin(2.0 * pi * high * t + p2);
  });
}

/// From point to point with the least jerk [Flash 1985], pauses between.
Signal reaching(double size, Random& random) {
  Signal path;
  path.reserve(kRows);
  double here = size * random.uniform(-0.3, 0.3);
  while (path.size() < kRows) {
    const double there = size * random.uniform(-0.4, 0.4);
    const auto moving = static_cast<std::size_t>(random.uniform(350.0, 1100.0));
    const auto resting = static_cast<std::size_t>(random.uniform(50.0, 600.0));
    for (std::size_t k = 0; k < moving + resting && path.size() < kRows; ++k) {
      const double s = std::min(1.0, static_cast<double>(k) / static_cast<double>(moving));
      path.push_back(here + (there - here) * s * s * s * (10.0 - 15.0 * s + 6.0 * s * s));
    }
    here = there;
  }
  return path;
}

/// Noise through two critically damped filters: as restless as a hand.
Signal hand(double size, Random& random) {
  const double corner = 2.0 * pi * random.uniform(0.7, 2.2);
  std::array<double, 4> state{};
  Signal path;
  path.reserve(kRows);
  const std::size_t settle = 3000;
  for (std::size_t k = 0; k < kRows + settle; ++k) {
    double x = random.normal();
    for (double& each : state) {
      each += corner * kStatedPeriod * (x - each);
      x = each;
    }
    if (k >= settle) path.push_back(x);
  }
  double largest = 1e-12;
  for (const double x : path) {
    largest = std::max(largest, std::abs(x));
  }
  const double scale = size * random.uniform(0.2, 0.42) / largest;
  for (double& x : path) {
    x *= scale;
  }
  return path;
}

/// To and fro at steady speed, each leg with an amplitude and speed of its own.
Signal legs(double size, double slowest, double fastest, Random& random) {
  Signal path;
  path.reserve(kRows);
  double x = size * random.uniform(-0.3, 0.3);
  double sense = random.uniform() < 0.5 ? 1.0 : -1.0;
  while (path.size() < kRows) {
    const double end = sense * size * random.uniform(0.08, 0.42);
    const double speed = log_uniform(random, slowest, fastest);
    const auto steps =
        static_cast<std::size_t>(std::ceil(std::abs(end - x) / speed / kStatedPeriod)) + 1;
    const double start = x;
    for (std::size_t k = 1; k <= steps && path.size() < kRows; ++k) {
      x = start + (end - start) * static_cast<double>(k) / static_cast<double>(steps);
      path.push_back(x);
    }
    sense = -sense;
  }
  // Corners round off within some ten milliseconds.
  double slow = path.front();
  double slower = slow;
  for (double& each : path) {
    slow += 0.08 * (each - slow);
    slower += 0.08 * (slow - slower);
    each = slower;
  }
  return path;
}

Signal circles(double size, Random& random) {
  const double f = random.uniform(0.25, 1.1);
  const double p = random.uniform(0.0, 2.0 * pi);
  const double from = size * random.uniform(0.05, 0.2);
  const double to = size * random.uniform(0.2, 0.4);
  return sampled([=](double t) {
    return (from + (to - from) * t / kLength) * std::sin(2.0 * pi * f * t + p);
  });
}

/// Angular acceleration, rad/s².
Signal multisine(double size, Random& random) {
  constexpr std::size_t kLines = 14;
  std::array<std::array<double, 3>, kLines> lines{};
  const double level = size * random.uniform(4.0, 11.0) * std::sqrt(2.0 / kLines);
  const double top = random.uniform(15.0, 35.0);
  for (std::size_t i = 0; i < kLines; ++i) {
    const double share = (static_cast<double>(i) + random.uniform()) / kLines;
    lines.at(i) = {level * random.uniform(0.6, 1.4), 2.0 * pi * 0.3 * std::pow(top / 0.3, share),
                   random.uniform(0.0, 2.0 * pi)};
  }
  return sampled([&](double t) {
    double sum = 0.0;
    for (const auto& [amplitude, omega, phase] : lines) {
      sum += amplitude * std::sin(omega * t + phase);
    }
    return sum;
  });
}

Signal chirp(double size, Random& random) {
  const double first = random.uniform(0.3, 0.8);
  const double last = random.uniform(18.0, 45.0);
  const double level = size * random.uniform(6.0, 14.0);
  const double phase = random.uniform(0.0, 2.0 * pi);
  const bool upwards = random.uniform() < 0.7;
  const double rate = std::log(last / first) / kLength;
  return sampled([=](double t) {
    const double s = upwards ? t : kLength - t;
    return level * std::sin(phase + 2.0 * pi * first * (std::exp(rate * s) - 1.0) / rate);
  });
}

Signal pulses(double size, Random& random) {
  Signal signal;
  signal.reserve(kRows);
  double sense = random.uniform() < 0.5 ? 1.0 : -1.0;
  while (signal.size() < kRows) {
    const auto on = static_cast<std::size_t>(random.uniform(15.0, 90.0));
    const auto off = static_cast<std::size_t>(random.uniform(100.0, 700.0));
    const double level = size * random.uniform(6.0, 26.0);
    for (std::size_t k = 0; k < 2 * on + off && signal.size() < kRows; ++k) {
      signal.push_back(k < on ? sense * level : k < 2 * on ? -sense * level : 0.0);
    }
    sense = random.uniform() < 0.5 ? sense : -sense;
  }
  return signal;
}

std::string described(Movement movement) {
  switch (movement) {
    case Movement::multisine:
      return "torque multisine on a soft loop";
    case Movement::reaching:
      return "movements from point to point";
    case Movement::hand:
      return "restless hand";
    case Movement::sweeps:
      return "slow sweeps both ways";
    case Movement::chirp:
      return "torque chirp";
    case Movement::triangles:
      return "triangles of several rates";
    case Movement::pulses:
      return "torque pulses";
    case Movement::circles:
      break;
  }
  return "widening circles";
}

struct AxisWish {
  Signal path{};
  Signal push{};  ///< rad/s²; empty: none
};

AxisWish draw_axis(Movement movement, double size, Random& random) {
  switch (movement) {
    case Movement::multisine:
      return {.path = wander(size, random), .push = multisine(size, random)};
    case Movement::chirp:
      return {.path = wander(size, random), .push = chirp(size, random)};
    case Movement::pulses:
      return {.path = wander(size, random), .push = pulses(size, random)};
    case Movement::reaching:
      return {.path = reaching(size, random)};
    case Movement::hand:
      return {.path = hand(size, random)};
    case Movement::sweeps:
      return {.path = legs(size, 0.1, 0.4, random)};
    case Movement::triangles:
      return {.path = legs(size, 0.25, 1.6, random)};
    case Movement::circles:
      break;
  }
  return {.path = circles(size, random)};
}

std::vector<JointVector> slope(const std::vector<JointVector>& x) {
  std::vector<JointVector> result(x.size(), JointVector::Zero());
  for (std::size_t k = 1; k + 1 < x.size(); ++k) {
    result[k] = (x[k + 1] - x[k - 1]) / (2.0 * kStatedPeriod);
  }
  result.front() = result[1];
  result.back() = result[x.size() - 2];
  return result;
}

}  // namespace

Excitation draw_excitation(const ExcitationWish& wish, Random& random) {
  Excitation result;
  result.text = described(wish.movement);
  result.path.assign(kRows, middle_posture());
  result.torque.assign(kRows, JointVector::Zero());
  for (Eigen::Index i = 0; i < middle_posture().size(); ++i) {
    const AxisWish axis = draw_axis(wish.movement, wish.size, random);
    for (std::size_t k = 0; k < kRows; ++k) {
      result.path[k][i] += axis.path[k];
      if (!axis.push.empty()) result.torque[k][i] = wish.inertia[i] * axis.push[k];
    }
  }
  result.rate = slope(result.path);
  result.acceleration = slope(result.rate);
  return result;
}

}  // namespace teleop::concealed
