#include "core/diagnosis/next_experiment.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <span>

#include <fmt/format.h>

#include "core/diagnosis/parallel.hpp"
#include "core/effects/plant_spec.hpp"
#include "core/realtime/clock.hpp"
#include "core/simulation/arm_sim.hpp"

namespace teleop {
namespace {

constexpr std::size_t kRivals = 3;  // that are held against the leading explanation
constexpr double kEnough = 10.0;    // log Bayes factor that settles a question
constexpr double kNothing = 3.0;    // and one that does not
constexpr double kNear = 40.0;      // by which the score of a rival may be behind

/// Another explanation and what tells it from the leading one.
struct Rival {
  MachineModel model{};
  std::string text{};
  double behind = 0.0;
  bool absence = false;  ///< of the effect, not another one in its place
};

std::string name_of(const EffectSpec& effect) {
  std::string name = effect.kind;
  std::replace(name.begin(), name.end(), '_', ' ');
  return effect.axis ? fmt::format("{} on axis {}", name, *effect.axis + 1) : name;
}

/// The nearest rivals of any effect; where there is none, the absence of each effect.
std::vector<Rival> rivals_of(const SearchResult& found) {
  const std::vector<EffectSpec>& leading = found.best.fit.model.effects;
  std::vector<Rival> rivals;
  for (std::size_t i = 0; i < found.effects.size(); ++i) {
    for (const NamedEffect::Rival& each : found.effects[i].rivals) {
      if (each.behind > kNear) continue;
      Rival rival{.model = {.effects = leading},
                  .text = fmt::format("{} from {}", name_of(leading[i]), name_of(each.effect)),
                  .behind = each.behind};
      rival.model.effects[i] = each.effect;
      rivals.push_back(std::move(rival));
    }
  }
  std::stable_sort(rivals.begin(), rivals.end(),
                   [](const Rival& a, const Rival& b) { return a.behind < b.behind; });
  if (rivals.size() > kRivals) rivals.resize(kRivals);
  for (std::size_t i = 0; rivals.empty() && i < leading.size(); ++i) {
    Rival without{.model = {.effects = leading}, .text = name_of(leading[i]), .absence = true};
    without.model.effects.erase(without.model.effects.begin() + static_cast<std::ptrdiff_t>(i));
    rivals.push_back(std::move(without));
  }
  return rivals;
}

MachineModel let_go(MachineModel model) {
  std::erase_if(model.effects,
                [](const EffectSpec& each) { return each.kind == "hand_impedance"; });
  return model;
}

/// The recording that a motion would give if the model were true and nothing shook.
Recording imagine(const DiagnosisCase& data,
                  const ArmModel& arm,
                  const MachineModel& model,
                  const ProbeMotion& motion) {
  const ProbeLaw law{{}, arm, motion};
  SimulatedClock clock;
  SimulatedArm::Config config{.q = law.start()};
  config.plant.arm = data.plant;
  config.plant.sensing.quantised = false;
  config.plant.watchdog.timeout_ms = 0.0;
  config.plant.workspace.stops = false;
  config.plant.effects = model.effects;
  SimulatedArm imagined{config, clock};
  imagined.amplifiers(true);
  Recording run{.name = std::string{motion.name}};
  const auto rows = static_cast<std::size_t>(motion.seconds / data.period_s);
  const Duration period{std::llround(1e9 * data.period_s)};
  JointVector last = law.start();
  JointVector speed = JointVector::Zero();
  run.q.reserve(rows);
  run.tau.reserve(rows);
  for (std::size_t k = 0; k < rows; ++k) {
    constexpr double kSmooth = 0.2;
    const JointVector q = imagined.read().q;
    speed += kSmooth * ((q - last) / data.period_s - speed);
    last = q;
    const JointVector tau = law.step(static_cast<double>(k) * data.period_s, q, speed);
    run.q.push_back(q);
    run.tau.push_back(tau);
    imagined.write(tau);
    clock.sleep_until(clock.now() + period);
  }
  return run;
}

double power_of(const std::vector<Eigen::VectorXf>& errors) {
  double sum = 0.0;
  for (const Eigen::VectorXf& w : errors) {
    sum += w.cast<double>().squaredNorm();
  }
  return sum;
}

/// Half of what the other model cannot explain of the recording that the true one would give.
double unexplained(const Likelihood& likelihood,
                   const MachineModel& truth,
                   const MachineModel& other,
                   const ProbeMotion& motion) {
  DiagnosisCase imagined{.name = std::string{motion.name},
                         .plant = likelihood.data().plant,
                         .period_s = likelihood.data().period_s,
                         .resolution = likelihood.data().resolution};
  imagined.runs.push_back(imagine(imagined, likelihood.arm(), truth, motion));
  Likelihood told{imagined, likelihood.arm(), 1};
  told.set_noise(likelihood.noise());
  const std::vector<Eigen::VectorXf> unavoidable = told.errors(truth);
  // The rigid body is known from the recordings at hand.
  const BaseColumns fixed{Eigen::MatrixXf::Zero(unavoidable.front().size(), BasePrior::kSize)};
  const Fit best = fit(told, fixed, other, {.iterations = 5, .slopes = false});
  const double more = best.chi2 - power_of(unavoidable);
  return std::isfinite(more) ? std::max(0.0, more / 2.0) : 0.0;
}

/// Log Bayes factors against each rival, the mean of either being true: where one contains the
/// other, only the richer one can leave something that the other does not explain.
std::vector<double> evidence_of(const Likelihood& likelihood,
                                const MachineModel& leading,
                                const std::vector<Rival>& rivals,
                                const ProbeMotion& motion) {
  const auto as_asked = [&](const MachineModel& model) {
    return motion.hands_off ? let_go(model) : model;
  };
  const MachineModel first = as_asked(leading);
  std::vector<double> evidence;
  evidence.reserve(rivals.size());
  for (const Rival& rival : rivals) {
    const MachineModel other = as_asked(rival.model);
    const double one = unexplained(likelihood, first, other, motion);
    evidence.push_back(rival.absence ? one
                                     : (one + unexplained(likelihood, other, first, motion)) / 2.0);
  }
  return evidence;
}

std::string told_apart(const ExpectedEvidence& best, bool ties) {
  const std::string what =
      fmt::format("{} ({}, {:.0f} s)", best.motion->text, best.motion->name, best.motion->seconds);
  if (!ties) {
    return fmt::format("no rival is near; {} would show {} best and measure it better", what,
                       best.rival);
  }
  if (best.log_bayes < kNothing) {
    return fmt::format(
        "none of the safe motions tells {}: they predict nearly the same recordings (expected log "
        "Bayes factor {:.1f} by {})",
        best.rival, best.log_bayes, what);
  }
  return fmt::format("{}: expected to tell {} by a log Bayes factor of {:.0f} or more", what,
                     best.rival, best.log_bayes);
}

/// What to do where no explanation stands: every motion shows something else of what is left.
NextExperiment without_rivals(const std::string& left_over) {
  NextExperiment next;
  const char* name = left_over.empty() ? "slow_sweep" : "hands_off";
  const ProbeMotion& motion = find_probe_motion(name);
  next.motions.push_back({.motion = &motion});
  if (left_over.empty()) {
    next.text = fmt::format("none is needed; {} would show smaller effects", motion.text);
  } else {
    next.text = fmt::format(
        "record {} twice: what comes again belongs to the arm, what does not to its surroundings",
        motion.text);
  }
  return next;
}

}  // namespace

NextExperiment next_experiment(const Likelihood& likelihood,
                               const SearchResult& found,
                               const std::string& left_over) {
  const std::vector<Rival> rivals = rivals_of(found);
  if (rivals.empty() || !left_over.empty()) return without_rivals(left_over);
  const MachineModel leading{.effects = found.best.fit.model.effects};
  const std::span<const ProbeMotion> motions = probe_motions();
  std::vector<std::vector<double>> evidence(motions.size());
  for_each_index(motions.size(), likelihood.threads(), [&](std::size_t i) {
    evidence[i] = evidence_of(likelihood, leading, rivals, motions[i]);
  });
  const bool ties = !rivals.front().absence;
  // What is settled once need not be settled better; what is only measured is measured by the
  // second.
  const auto worth = [&](std::size_t i) {
    double sum = 0.0;
    for (const double each : evidence[i]) {
      sum += ties ? std::min(each, kEnough) + 1e-6 * each : each / motions[i].seconds;
    }
    return sum;
  };
  std::vector<std::size_t> order(motions.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return worth(a) > worth(b); });
  NextExperiment next{.ties = ties};
  next.motions.reserve(order.size());
  for (const std::size_t i : order) {
    const auto least = std::min_element(evidence[i].begin(), evidence[i].end());
    const auto rival = static_cast<std::size_t>(least - evidence[i].begin());
    next.motions.push_back(
        {.motion = &motions[i], .rival = rivals[rival].text, .log_bayes = *least});
  }
  next.text = told_apart(next.motions.front(), next.ties);
  return next;
}

std::string scenario_of(const NextExperiment& next,
                        const PlantSpec& plant,
                        const std::string& log) {
  const ProbeMotion& motion = *next.motions.front().motion;
  std::string text = fmt::format(
      "# {}.\n#\n"
      "# Written by teleop diagnose. As it stands, the arm is simulated with what was found so "
      "far;\n"
      "# on the real one: --set device=usb. Give run.log to teleop diagnose together with the "
      "other\n"
      "# recordings of that arm.\n\n"
      "experiment = \"probe\"\n"
      "name = \"next experiment\"\n"
      "text = \"{}: tells {}\"\n\n"
      "[run]\n"
      "motion = \"{}\"\n"
      "log = \"{}\"\n\n"
      "[plant]\n"
      "arm = \"{}\"\n",
      next.text, motion.text, motion.tells, motion.name, log, plant.arm);
  for (const EffectSpec& effect : plant.effects) {
    text += fmt::format("\n[[plant.effect]]\nkind = \"{}\"\n", effect.kind);
    if (effect.axis) text += fmt::format("axis = {}\n", *effect.axis + 1);
    for (const auto& [name, value] : effect.parameters) {
      text += fmt::format("{} = {}\n", name, value);
    }
  }
  return text;
}

}  // namespace teleop
