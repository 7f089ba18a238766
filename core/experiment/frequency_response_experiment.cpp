#include <algorithm>
#include <atomic>
#include <cmath>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/base/error.hpp"
#include "core/experiment/experiment.hpp"
#include "core/experiment/scenario.hpp"
#include "core/identification/mechanical_form.hpp"
#include "core/identification/polynomial_fit.hpp"
#include "core/identification/response_experiment.hpp"
#include "core/simulation/arm_sim.hpp"

namespace teleop {
namespace {

constexpr Eigen::Index kCurvePoints = 2000;

/// What a fitted mechanism answers between the first and the last line, without hold and delays.
struct FittedCurve {
  Eigen::VectorXd frequency_Hz;
  Eigen::ArrayXd gain;  ///< |P|, m/N
};

FittedCurve curve_of(const MechanicalFit& fit, const MeasuredResponse& data) {
  const double low = std::log(data.frequency_Hz.minCoeff());
  const double high = std::log(data.frequency_Hz.maxCoeff());
  FittedCurve curve{.frequency_Hz = Eigen::ArrayXd::LinSpaced(kCurvePoints, low, high).exp(),
                    .gain = {}};
  curve.gain =
      continuous_response(fit.family(fit.fit.theta).model, curve.frequency_Hz).array().abs();
  return curve;
}

/// The first frequency at which sign · ω² |P| passes a minimum: −1 finds resonances. A rigid tool
/// has ω² |P| = 1/m and none of either.
std::optional<double> first_valley(const FittedCurve& curve, double sign) {
  const Eigen::ArrayXd course = sign * curve.frequency_Hz.array().square() * curve.gain;
  for (Eigen::Index i = 1; i + 1 < course.size(); ++i) {
    if (course(i) < course(i - 1) && course(i) <= course(i + 1)) return curve.frequency_Hz(i);
  }
  return std::nullopt;
}

/// RMS over the lines of |G_fit| / |G| − 1.
double gain_error(const MechanicalFit& fit, const MeasuredResponse& data, const Sampling& how) {
  const Eigen::ArrayXd fitted =
      sampled_response(fit.family(fit.fit.theta), how, data.frequency_Hz).value.array().abs();
  return std::sqrt((fitted / data.value.array().abs() - 1.0).square().mean());
}

/// Force to position of one tool axis at home, and a form of the paper fitted to it, as
/// `teleop frequency-response` measures and fits them, so that it can be swept over whatever a
/// plant is made of. On simulated time.
class FrequencyResponseExperiment final : public Experiment {
 public:
  void add_settings(Settings& settings) override {
    settings.add("run.axis", &axis_, "x, y or z");
    settings.add("run.form", &form_, "a or b: the form that is fitted");
    settings.add("run.method", &method_, "multisine or stepped-sine");
    settings.add("run.travel_mm", &travel_mm_, "farthest from home, any axis",
                 {.low = 0.1, .high = 50.0});
    settings.add("run.force_N", &measured_.max_force_N, "largest at the tool",
                 {.low = 0.05, .high = 50.0});
    settings.add("run.gravity_share", &measured_.gravity_share, "of the weight that is carried",
                 {.low = 0.0, .high = 1.0});
    settings.add("run.rate_Hz", &measured_.rate_Hz, "of the loop", {.low = 100.0, .high = 10000.0});
    settings.add("run.low_Hz", &measured_.low_Hz, "first line", kPositive);
    settings.add("run.high_Hz", &measured_.high_Hz, "last line, at most 0.4 of the rate",
                 kPositive);
    settings.add("run.period_s", &measured_.period_s, "of the signal; lines are 2/period apart",
                 {.low = 0.05, .high = 100.0});
    settings.add("run.periods", &measured_.periods, "kept of every realisation or line",
                 {.low = 2, .high = 1000});
    settings.add("run.realisations", &measured_.realisations, "of the multisine",
                 {.low = 3, .high = 1000});
    settings.add("run.lines", &measured_.lines, "of the stepped sine", {.low = 10, .high = 1000});
    settings.add("run.delay_samples", &delay_samples_,
                 "whole samples from a command to the motor, known of the plant",
                 {.low = 0, .high = 20});
    settings.add("run.amplifier_lag_ms", &amplifier_lag_ms_, "first-order, known of the plant",
                 {.low = 0.0, .high = 20.0});
  }

  void check(const Scenario& scenario) const override {
    check_integrator(scenario, scenario.plant(), "plant.", {});
    if (axis_ != "x" && axis_ != "y" && axis_ != "z") {
      scenario.refuse("run.axis", "the arm has no such axis; allowed: x, y, z");
    }
    if (form_ != "a" && form_ != "b") scenario.refuse("run.form", "allowed: a, b");
    if (method_ != "multisine" && method_ != "stepped-sine") {
      scenario.refuse("run.method", "allowed: multisine, stepped-sine");
    }
    try {
      teleop::check(experiment_of(scenario));
    } catch (const ConfigError& error) {
      scenario.refuse("run.high_Hz", error.what());
    }
  }

  [[nodiscard]] Results run(const Scenario& scenario, ExperimentContext& context) const override {
    SimulatedClock clock;
    SimulatedArm arm{{.plant = scenario.plant(), .seed = scenario.seed()}, clock};
    const std::atomic<bool> never{false};
    const ResponseMeasurement measurement =
        measure_response(experiment_of(scenario), arm, arm.model(), clock,
                         context.stop != nullptr ? *context.stop : never);
    const PeriodicDrive::Outcome& last = measurement.drives.back();
    if (!measurement.response) return results_of({}, last);
    return results_of(fitted(*measurement.response, context), last);
  }

 private:
  /// What was found; nothing where the measurement did not come to its end.
  struct Found {
    std::optional<MechanicalFit> mechanism{};
    std::optional<double> gain_error{};
    std::optional<double> antiresonance_Hz{};
    std::optional<double> resonance_Hz{};
    std::optional<double> passive{};
    std::optional<double> distortion{};
  };

  [[nodiscard]] ResponseExperiment experiment_of(const Scenario& scenario) const {
    ResponseExperiment experiment = measured_;
    experiment.axis = static_cast<std::size_t>(axis_[0] - 'x');
    experiment.excitation =
        method_ == "multisine" ? Excitation::multisine : Excitation::stepped_sine;
    experiment.max_travel_m = 1e-3 * travel_mm_;
    experiment.seed = scenario.seed();
    return experiment;
  }

  [[nodiscard]] Found fitted(const FrequencyResponse& response, ExperimentContext& context) const {
    const Sampling sampling{.period_s = 1.0 / measured_.rate_Hz,
                            .amplifier_lag_s = 1e-3 * amplifier_lag_ms_,
                            .delay_samples = delay_samples_};
    const MeasuredResponse data = measured(response);
    const bool is_a = form_ == "a";
    MechanicalFit fit =
        fit_mechanical(is_a ? MechanicalForm::a : MechanicalForm::b, data, sampling);
    const PolynomialFit free =
        fit_polynomial({.numerator = is_a ? 2 : 4, .denominator = 2}, data, sampling);
    const FittedCurve curve = curve_of(fit, data);
    if (context.figures != nullptr) context.figures->push_back(picture(response, curve));
    Found found{.gain_error = gain_error(fit, data, sampling),
                .antiresonance_Hz = first_valley(curve, 1.0),
                .resonance_Hz = first_valley(curve, -1.0),
                .passive = free.passivity.passive ? 1.0 : 0.0,
                .distortion = response.distortion};
    found.mechanism = std::move(fit);
    return found;
  }

  [[nodiscard]] Figure picture(const FrequencyResponse& response, const FittedCurve& curve) const {
    const auto decibels = [](double gain) {
      return 20.0 * std::log10(1e3 * gain);
    };
    Figure::Curve measured{.label = "measured", .marks = true};
    measured.points.reserve(response.lines.size());
    for (const ResponseLine& line : response.lines) {
      measured.points.emplace_back(line.f_Hz, decibels(std::abs(line.gain)));
    }
    Figure::Curve fit{.label = "form (" + form_ + ")"};
    fit.points.reserve(static_cast<std::size_t>(curve.gain.size()));
    for (Eigen::Index i = 0; i < curve.gain.size(); ++i) {
      fit.points.emplace_back(curve.frequency_Hz(i), decibels(curve.gain(i)));
    }
    return {.name = "frequency-response",
            .title = "Force to position along " + axis_,
            .x_label = "frequency (Hz)",
            .y_label = "gain (dB, 1 mm/N)",
            .curves = {std::move(measured), std::move(fit)},
            .log_x = true};
  }

  [[nodiscard]] static Results results_of(const Found& found, const PeriodicDrive::Outcome& last) {
    const auto value = [&](std::string_view name) -> std::optional<double> {
      if (!found.mechanism) return std::nullopt;
      for (const Estimate& estimate : found.mechanism->estimates) {
        if (estimate.name == name && estimate.determined) return estimate.value;
      }
      return std::nullopt;
    };
    return {{"m1_kg", value("m1"), "kg"},
            {"m2_kg", value("m2"), "kg"},
            {"k_N_per_m", value("k"), "N/m"},
            {"b_Ns_per_m", value("b"), "N s/m"},
            {"k_t_N_per_m", value("k_t"), "N/m, form (b)"},
            {"b_0_Ns_per_m", value("b_0"), "N s/m, to ground"},
            {"gain_error", found.gain_error, "RMS of fitted over measured gain, less 1"},
            {"antiresonance_Hz", found.antiresonance_Hz, "Hz, of the fitted form, the first"},
            {"resonance_Hz", found.resonance_Hz, "Hz, of the fitted form, the first"},
            {"passive", found.passive, "1: so is the free polynomial of the form's degrees"},
            {"distortion", found.distortion, "share of the response that is not linear"},
            {"ended", static_cast<double>(last.end), "number: 1 done"},
            {"fault", static_cast<double>(last.fault), "number"}};
  }

  std::string axis_ = "x";
  std::string form_ = "a";
  std::string method_ = "multisine";
  double travel_mm_ = 5.0;
  int delay_samples_ = 0;
  double amplifier_lag_ms_ = 0.0;
  ResponseExperiment measured_{.gravity_share = 1.0};
};

}  // namespace

extern const ExperimentKind frequency_response_experiment;
const ExperimentKind frequency_response_experiment{
    .name = "frequency_response",
    .text = "force to position of one tool axis, and a form of the paper fitted to it",
    .make = []() -> std::unique_ptr<Experiment> {
      return std::make_unique<FrequencyResponseExperiment>();
    },
};

}  // namespace teleop
