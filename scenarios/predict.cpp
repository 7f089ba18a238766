#include "scenarios/predict.hpp"

#include <cmath>
#include <cstdio>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/base/error.hpp"
#include "core/diagnosis/audit.hpp"
#include "core/diagnosis/case_folder.hpp"
#include "core/diagnosis/likelihood.hpp"
#include "core/diagnosis/predictor.hpp"
#include "core/effects/plant_spec.hpp"
#include "core/effects/vocabulary.hpp"
#include "core/model/arm_model.hpp"
#include "scenarios/output.hpp"

namespace teleop {
namespace {

constexpr std::size_t kStart = 200;  // rows after which the tether knows the state
constexpr double kFree_s = 0.25;     // for which a model is left to itself at a time

/// What is said of one run, an entry an axis.
struct Score {
  JointVector over_floor = JointVector::Zero();  ///< RMS of whitened innovations
  JointVector share = JointVector::Zero();       ///< of innovations in the motion
  JointVector free_run = JointVector::Zero();    ///< RMS error where it is left to itself, rad
};

Score score_of(const DiagnosisCase& data, const ArmModel& arm, const PlantTerms& terms) {
  const Recording& run = data.runs.front();
  NoiseModel noise;
  noise.reading = data.resolution.cwiseMax(1e-9) / std::sqrt(12.0);
  const Tether tether{arm, run, data.period_s, noise};
  const Prediction held = predict({arm, terms}, run, data.period_s, tether);
  PredictorModel alone{arm, terms};
  alone.free_rows = static_cast<std::size_t>(std::lround(kFree_s / data.period_s));
  const Prediction loose = predict(alone, run, data.period_s, tether);
  JointVector mean = JointVector::Zero();
  for (const JointVector& q : run.q) {
    mean += q / static_cast<double>(run.rows());
  }
  Score score;
  JointVector motion = JointVector::Zero();
  double free_rows = 0.0;
  const auto rows = static_cast<double>(run.rows() - kStart);
  for (std::size_t k = kStart; k < run.rows(); ++k) {
    score.over_floor += (tether.steps()[k].whitening * held.innovations[k]).cwiseAbs2() / rows;
    score.share += held.innovations[k].cwiseAbs2() / rows;
    if (k / alone.free_rows % 2 == 1) {
      score.free_run += loose.innovations[k].cwiseAbs2();
      free_rows += 1.0;
    }
    motion += (run.q[k] - mean).cwiseAbs2() / rows;
  }
  score.over_floor = score.over_floor.cwiseSqrt();
  score.share = score.share.cwiseQuotient(motion.cwiseMax(1e-300)).cwiseSqrt();
  score.free_run = (score.free_run / free_rows).cwiseSqrt();
  return score;
}

nlohmann::json list_of(const JointVector& values) {
  nlohmann::json list = nlohmann::json::array();
  for (const double value : values) {
    list.push_back(std::isfinite(value) ? nlohmann::json(value) : nlohmann::json());
  }
  return list;
}

}  // namespace

int run_predict(const PredictOptions& options) {
  const PlantSpec plant = load_plant(options.model);
  const ArmModel arm = load_arm(plant.arm);
  const PlantTerms terms = terms_of(plant.effects);
  std::vector<DiagnosisCase> cases;
  for (const std::filesystem::path& file : options.runs) {
    cases.push_back(read_case_of_run(file));
    const DiagnosisCase& each = cases.back();
    if (each.plant != plant.arm) {
      throw ConfigError{fmt::format("{}: a recording of {}, the model is of {}", file.string(),
                                    each.plant, plant.arm)};
    }
    refuse_fatal(audit(each));
    if (each.runs.front().rows() <= 2 * kStart) {
      throw ConfigError{fmt::format("{}: too short: {} rows, at least {} are needed", file.string(),
                                    each.runs.front().rows(), 2 * kStart + 1)};
    }
  }
  nlohmann::json runs = nlohmann::json::array();
  fmt::print("{:<24} {:>6} {:>18} {:>14} {:>18}\n", "run", "axis", "innovation/floor", "of motion",
             "left alone, mrad");
  for (const DiagnosisCase& each : cases) {
    const Score score = score_of(each, arm, terms);
    const std::string& name = each.runs.front().name;
    for (Eigen::Index i = 0; i < 3; ++i) {
      fmt::print("{:<24} {:>6} {:>18.3f} {:>14.2e} {:>18.2f}\n", i == 0 ? name : "", i + 1,
                 score.over_floor[i], score.share[i], 1e3 * score.free_run[i]);
    }
    runs.push_back({{"file", name},
                    {"innovation_rms_over_floor", list_of(score.over_floor)},
                    {"nrmse", list_of(score.share)},
                    {"free_run_rmse", list_of(score.free_run)}});
  }
  if (!options.json.empty()) write_json(options.json, {{"runs", runs}});
  return 0;
}

}  // namespace teleop
