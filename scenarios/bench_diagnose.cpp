#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <numbers>
#include <optional>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/base/error.hpp"
#include "core/base/settings.hpp"
#include "core/diagnosis/fit.hpp"
#include "core/effects/vocabulary.hpp"
#include "core/math/random.hpp"
#include "core/model/dynamics.hpp"
#include "core/simulation/plant.hpp"
#include "scenarios/bench.hpp"
#include "scenarios/child.hpp"
#include "scenarios/scratch.hpp"

namespace teleop {
namespace {

using Json = nlohmann::json;

constexpr double kStart = 1e-3;  // N m s/rad, of each coefficient

std::vector<EffectSpec> viscous(const JointVector& coefficients) {
  std::vector<EffectSpec> effects;
  for (std::size_t i = 0; i < kJoints; ++i) {
    const double coefficient = coefficients[static_cast<Eigen::Index>(i)];
    effects.push_back(
        {.kind = "viscous_friction", .axis = i, .parameters = {{"coefficient", coefficient}}});
  }
  return effects;
}

/// A second or more of an arm with viscous joints that a hand-tuned law keeps in motion.
DiagnosisCase record(const ArmModel& arm, double seconds) {
  const std::vector<EffectSpec> hidden = viscous({6e-3, 4e-3, 5e-3});
  const PlantTerms terms = terms_of(hidden);
  const JointVector home{0.0, 0.4, 0.25};
  const JointVector stiffness{1.5, 0.8, 0.3};
  const NoiseModel noise;
  DiagnosisCase data{.name = "bench"};
  const auto& counts = arm.parameters().encoder_counts_per_rev;
  for (std::size_t i = 0; i < kJoints; ++i) {
    data.resolution[static_cast<Eigen::Index>(i)] = 2.0 * std::numbers::pi / counts.at(i);
  }
  Plant plant{arm, {.terms = terms, .stops = false, .q = home}};
  Random random{1};
  Recording run{.name = "bench"};
  const auto rows = static_cast<std::size_t>(seconds / data.period_s);
  for (std::size_t k = 0; k < rows; ++k) {
    const double t = static_cast<double>(k) * data.period_s;
    const JointVector wanted =
        home + 0.2 * JointVector{std::sin(9.0 * t), std::sin(13.0 * t), std::sin(17.0 * t)};
    const JointVector q = data.resolution.cwiseProduct(
        plant.q().cwiseQuotient(data.resolution).array().round().matrix());
    const JointVector tau = gravity_torque(arm, q) + stiffness.cwiseProduct(wanted - q);
    JointVector shake;
    for (Eigen::Index i = 0; i < shake.size(); ++i) {
      shake[i] = noise.white[i] * random.normal();
    }
    run.q.push_back(q);
    run.tau.push_back(tau);
    plant.set_torque(tau);
    plant.set_disturbance(shake);
    plant.advance(Duration{1'000'000});
  }
  data.runs.push_back(std::move(run));
  return data;
}

template <class Vectors>
Json flat(const Vectors& vectors) {
  Json list = Json::array();
  for (const auto& each : vectors) {
    list.push_back(std::vector<double>(each.data(), each.data() + each.size()));
  }
  return list;
}

/// Everything that the peer needs to set up the same sum of squares.
Json problem_of(const Likelihood& likelihood) {
  const ArmModel::Lumped& arm = likelihood.arm().lumped();
  const Recording& run = likelihood.data().runs.front();
  const Tether& tether = likelihood.tether(0);
  Json problem{{"lumped",
                {{"K", arm.K},
                 {"S0", arm.S0},
                 {"S2", arm.S2},
                 {"S3", arm.S3},
                 {"M22", arm.M22},
                 {"M33", arm.M33},
                 {"N2", arm.N2},
                 {"N3", arm.N3}}},
               {"period_s", likelihood.data().period_s},
               {"settling", Likelihood::kSettling},
               {"start", std::vector<double>(kJoints, kStart)},
               {"tau", flat(run.tau)},
               {"q", flat(run.q)},
               {"memory", flat(std::vector{tether.memory()}).front()}};
  using Member = JointMatrix Tether::Step::*;
  const auto rows_of = [&](Member member) {
    std::vector<Eigen::Matrix<double, 3, 3, Eigen::RowMajor>> all;
    all.reserve(tether.steps().size());
    for (const Tether::Step& step : tether.steps()) {
      all.emplace_back(step.*member);
    }
    return flat(all);
  };
  problem["position"] = rows_of(&Tether::Step::position);
  problem["velocity"] = rows_of(&Tether::Step::velocity);
  problem["disturbance"] = rows_of(&Tether::Step::disturbance);
  problem["whitening"] = rows_of(&Tether::Step::whitening);
  return problem;
}

struct Found {
  double seconds = 0.0;
  JointVector coefficients = JointVector::Zero();
};

Found ours(const Likelihood& likelihood) {
  // The rigid body is given: its departures have no columns to act through.
  const auto rows =
      3 * static_cast<Eigen::Index>(likelihood.data().runs.front().rows() - Likelihood::kSettling);
  const BaseColumns none{Eigen::MatrixXf::Zero(rows, BasePrior::kSize)};
  const auto begin = std::chrono::steady_clock::now();
  const Fit found =
      fit(likelihood, none, {.effects = viscous(JointVector::Constant(kStart))}, {.slopes = false});
  Found result{.seconds =
                   std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count()};
  for (std::size_t i = 0; i < kJoints; ++i) {
    result.coefficients[static_cast<Eigen::Index>(i)] =
        found.model.effects[i].parameters.at("coefficient");
  }
  return result;
}

Found peer(const Json& problem) {
  constexpr int kPatience_ms = 1'800'000;
  const Scratch scratch;
  const std::string file = (scratch.path() / "problem.json").string();
  std::ofstream{file} << problem;
  Child python{"scipy", {"/usr/bin/python3", data_file("peers/scipy_fit.py").string(), file}};
  const std::optional<std::string> line = python.next_line(kPatience_ms);
  if (!line) throw ConfigError{"bench diagnose: python3 with scipy did not answer; is it there?"};
  const Json answer = Json::parse(*line);
  Found result{.seconds = answer.at("seconds")};
  for (std::size_t i = 0; i < kJoints; ++i) {
    result.coefficients[static_cast<Eigen::Index>(i)] = answer.at("coefficients").at(i);
  }
  return result;
}

}  // namespace

/// One sum of squares, one core: whitened innovations of a tethered arm by three viscous
/// coefficients.
int bench_diagnose(const BenchOptions& options) {
  const ArmModel arm = load_arm("phantom-1.5");
  const double recorded_s = std::clamp(options.seconds / 20.0, 0.2, 8.0);
  const DiagnosisCase data = record(arm, recorded_s);
  const Likelihood likelihood{data, arm, 1};
  std::fprintf(stderr, "scipy fits %.1f s of data …\n", recorded_s);
  const Found other = peer(problem_of(likelihood));
  std::vector<double> seconds;
  Found own;
  for (int i = 0; i < 5; ++i) {
    own = ours(likelihood);
    seconds.push_back(own.seconds);
  }
  const double fastest = median(seconds);
  const double apart = (own.coefficients - other.coefficients)
                           .cwiseQuotient(other.coefficients)
                           .cwiseAbs()
                           .maxCoeff();
  report_rows({{.id = "diagnose_fit",
                .ours = fastest,
                .peer = other.seconds,
                .peer_name = "scipy solve_ivp + least_squares",
                .unit = "s",
                .ratio = fastest / other.seconds}},
              options);
  std::puts(fmt::format("{:.0f} times faster; coefficients {:.5f} {:.5f} {:.5f} mN m s/rad, the "
                        "peer's within {:.1e} of them",
                        other.seconds / fastest, 1e3 * own.coefficients[0],
                        1e3 * own.coefficients[1], 1e3 * own.coefficients[2], apart)
                .c_str());
  constexpr double kSame = 1e-3;
  if (apart > kSame) {
    std::fprintf(stderr, "bench diagnose: the optima differ by more than %g\n", kSame);
    return 1;
  }
  return 0;
}

}  // namespace teleop
