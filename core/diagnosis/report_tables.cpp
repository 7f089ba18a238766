#include <algorithm>
#include <cctype>
#include <cmath>
#include <iterator>

#include <fmt/format.h>

#include "core/diagnosis/report_parts.hpp"
#include "core/effects/effect_words.hpp"
#include "core/effects/vocabulary.hpp"
#include "core/reporting/escape.hpp"
#include "core/reporting/form.hpp"

namespace teleop {
namespace {

std::string spaced(std::string_view name) {
  std::string text{name};
  std::replace(text.begin(), text.end(), '_', ' ');
  return text;
}

std::string percent(double share) {
  if (share < 0.01) return "&lt; 1&nbsp;%";
  return fmt::format("{:.0f}&nbsp;%", 100.0 * share);
}

const FreeParameter* free_of(const NamedEffect& named, std::string_view parameter) {
  for (const FreeParameter& each : named.free) {
    if (each.name == parameter) return &each;
  }
  return nullptr;
}

/// What a table says of one parameter: value, interval, whence.
std::string parameter_row(const NamedEffect& named, const EffectParameter& parameter) {
  const auto value = named.effect.parameters.find(std::string{parameter.name});
  const bool taken = value == named.effect.parameters.end();
  const double number = taken ? parameter.standard.value_or(0.0) : value->second;
  const FreeParameter* free = free_of(named, parameter.name);
  std::string interval = "–";
  std::string whence = taken ? "as the model has it" : "given";
  double deviation = 0.0;
  if (free != nullptr) {
    constexpr double k90 = 1.645;
    deviation = deviations_of(named).at(std::string{parameter.name});
    interval = interval_text(number - k90 * deviation, number + k90 * deviation, parameter.unit);
    whence = "fitted";
  }
  return fmt::format(
      "<tr><td>{}</td><td>{}</td><td class=\"value\">{}</td><td class=\"value\">{}</td>"
      "<td>{}</td></tr>\n",
      escape_html(spaced(parameter.name)), escape_html(parameter.text),
      escape_html(quantity_text(number, deviation, parameter.unit)), escape_html(interval), whence);
}

std::string why_lost(double behind, double confidence) {
  if (behind <= 0.0) return "It does not: it explains the recordings just as well.";
  if (confidence > 0.1) {
    return fmt::format(
        "It is a near tie: it explains the recordings only a little less well "
        "(by {:.1f}).",
        behind);
  }
  return fmt::format("It explains the recordings less well (by {:.0f}).", behind);
}

}  // namespace

std::map<std::string, double> deviations_of(const NamedEffect& named) {
  std::map<std::string, double> deviations;
  for (std::size_t i = 0; i < named.free.size(); ++i) {
    const FreeParameter& each = named.free[i];
    const double own = named.deviations[static_cast<Eigen::Index>(i)];
    deviations[each.name] =
        each.logarithmic ? own * std::abs(named.effect.parameters.at(each.name)) : own;
  }
  return deviations;
}

std::string sentence_of(const NamedEffect& named) {
  return sentence_of(named.effect, deviations_of(named));
}

std::string title_of(const EffectSpec& effect) {
  const std::string kind = spaced(effect.kind);
  return effect.axis ? fmt::format("{}, axis {}", kind, *effect.axis + 1) : kind;
}

std::string effect_table(const Diagnosis& diagnosis) {
  const std::vector<NamedEffect>& effects = diagnosis.found.effects;
  if (effects.empty()) return "<p>No effect is named.</p>";
  std::string out =
      "<div class=\"scroll\"><table "
      "class=\"effects\">\n<thead><tr><th>parameter</th><th>meaning</th>"
      "<th>value ± standard error</th><th>90&nbsp;% interval</th><th></th></tr></thead>\n";
  for (std::size_t i = 0; i < effects.size(); ++i) {
    const EffectKind& kind = find_effect(effects[i].effect.kind);
    fmt::format_to(std::back_inserter(out),
                   "<tr class=\"effect\"><th colspan=\"5\">{}, confidence {}<br>"
                   "<span class=\"note\">{}</span></th></tr>\n",
                   escape_html(title_of(effects[i].effect)), percent(diagnosis.confidences[i]),
                   escape_html(kind.law));
    for (const EffectParameter& parameter : kind.parameters) {
      out += parameter_row(effects[i], parameter);
    }
  }
  return out + "</table></div>";
}

std::string rival_table(const Diagnosis& diagnosis) {
  const std::vector<NamedEffect>& effects = diagnosis.found.effects;
  if (effects.empty()) return "<p>Nothing was named, so nothing had rivals.</p>";
  std::string out =
      "<div class=\"scroll\"><table class=\"effects\">\n<thead><tr><th>instead</th>"
      "<th>probability</th><th>why it lost</th></tr></thead>\n";
  auto to = std::back_inserter(out);
  for (std::size_t i = 0; i < effects.size(); ++i) {
    const NamedEffect& named = effects[i];
    fmt::format_to(
        to,
        "<tr class=\"effect\"><th colspan=\"3\">For {}</th></tr>\n<tr><td>nothing</td>"
        "<td>&lt; 1&nbsp;%</td><td>{}</td></tr>\n",
        escape_html(title_of(named.effect)),
        fmt::format("Without it the recordings are explained less well (by {:.0f}).", named.gain));
    for (std::size_t j = 0; j < named.rivals.size(); ++j) {
      const double confidence = diagnosis.rival_confidences[i][j];
      fmt::format_to(to, "<tr><td>{}</td><td>{}</td><td>{}</td></tr>\n",
                     escape_html(title_of(named.rivals[j].effect)), percent(confidence),
                     why_lost(named.rivals[j].behind, confidence));
    }
  }
  return out +
         "</table></div>\n<p class=\"note\">By how much: twice the logarithm of the likelihood, "
         "what "
         "its parameters cost included. Other kinds promised too little to be fitted.</p>";
}

std::string leftover_table(const Diagnosis& diagnosis) {
  constexpr std::size_t kShown = 5;
  if (diagnosis.leftovers.empty()) return "<p>Nothing was looked at.</p>";
  const bool rest =
      diagnosis.verdict == Verdict::partly_explained || diagnosis.verdict == Verdict::unexplained;
  std::string out;
  if (rest) {
    out += "<p>Something is left that no effect explains";
    const std::size_t axis = diagnosis.leftovers.front().axis;
    const std::string& when = diagnosis.where.left_over.at(axis);
    out += when.empty() ? ".</p>"
                        : fmt::format(", on axis {} in {}.</p>", axis + 1, escape_html(when));
  } else {
    out += fmt::format(
        "<p>Nothing but noise, as far as {} torques can tell that were tried on the prediction "
        "errors. The most suspicious:</p>",
        diagnosis.leftovers.size());
  }
  out +=
      "<div class=\"scroll\"><table class=\"effects\">\n<thead><tr><th>torque that follows</th>"
      "<th>axis</th><th>size</th><th>gain in χ²</th></tr></thead>\n";
  for (std::size_t i = 0; i < std::min(kShown, diagnosis.leftovers.size()); ++i) {
    const Leftover& each = diagnosis.leftovers[i];
    fmt::format_to(
        std::back_inserter(out), "<tr><td>{}</td><td>{}</td><td>{}</td><td>{:.1f}</td></tr>\n",
        escape_html(each.quantity), each.axis + 1,
        each.amplitude > 0.0 ? quantity_text(each.amplitude, 0.0, "N m") : "–", each.gain);
  }
  return out +
         "</table></div>\n<p class=\"note\">Under a sufficient model each gain is χ² of one degree "
         "of freedom; beyond 30 the verdict says that something is left.</p>";
}

std::string audit_list(const Audit& audit) {
  if (audit.findings.empty()) return "<p>Nothing to remark.</p>";
  std::string out = "<ul class=\"plain\">\n";
  for (const Finding& finding : audit.findings) {
    out += fmt::format("<li>{} <span class=\"note\">{}</span></li>\n",
                       escape_html(line_of(finding)), name_of(finding.severity));
  }
  return out + "</ul>";
}

std::string next_part(const ReportedDiagnosis& reported) {
  const NextExperiment& next = reported.diagnosis.next;
  std::string text = next.text;
  if (!text.empty()) {
    text.front() = static_cast<char>(std::toupper(static_cast<unsigned char>(text.front())));
  }
  std::string out = fmt::format("<p class=\"lead\">{}.</p>\n", sentence_html(text));
  if (!reported.next_file.empty()) {
    out += fmt::format("<pre class=\"command\">teleop run {}</pre>\n",
                       escape_html(reported.next_file));
  }
  const bool weighed =
      std::any_of(next.motions.begin(), next.motions.end(),
                  [](const ExpectedEvidence& each) { return !each.rival.empty(); });
  if (!weighed) return out;
  out +=
      "<div class=\"scroll\"><table class=\"effects\">\n<thead><tr><th>motion</th><th>what the arm "
      "does</th><th>it tells least</th><th>expected log Bayes factor</th></tr></thead>\n";
  for (const ExpectedEvidence& each : next.motions) {
    fmt::format_to(std::back_inserter(out),
                   "<tr><td>{}</td><td>{}</td><td>{}</td><td>{}</td></tr>\n", each.motion->name,
                   escape_html(each.motion->text), escape_html(each.rival),
                   each.log_bayes < 100.0 ? fmt::format("{:.1f}", each.log_bayes)
                                          : fmt::format("{:.0f}", each.log_bayes));
  }
  return out +
         "</table></div>\n<p class=\"note\">Each motion was simulated with one explanation and the "
         "other fitted to what came out. 3 is worth a look, 10 settles the question.</p>";
}

std::string method_part(const Diagnosis& diagnosis, const DiagnosisCase& data) {
  const NoiseModel& noise = diagnosis.found.best.noise;
  std::string out =
      "<p class=\"lead\">The arm was simulated under the recorded commands, held to the readings "
      "by "
      "a Kalman filter, and judged by how well it predicts the next reading. The noise was fitted "
      "along with each explanation:</p>\n<div class=\"scroll\"><table class=\"effects\">\n"
      "<thead><tr><th>axis</th><th>white torque</th><th>slow torque</th><th>its time constant</th>"
      "<th>readings</th></tr></thead>\n";
  auto to = std::back_inserter(out);
  for (Eigen::Index i = 0; i < 3; ++i) {
    fmt::format_to(to, "<tr><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td></tr>\n", i + 1,
                   quantity_text(noise.white[i], 0.0, "N m"),
                   quantity_text(noise.coloured[i], 0.0, "N m"),
                   quantity_text(noise.time_constant[i], 0.0, "s"),
                   quantity_text(noise.reading[i], 0.0, "rad"));
  }
  out +=
      "</table></div>\n<p class=\"note\">RMS. Runs used, each left out in turn:</p>\n<ul "
      "class=\"plain\">\n";
  for (const Recording& run : data.runs) {
    fmt::format_to(to, "<li>{}, {:.1f} s{}{}</li>\n", escape_html(run.name),
                   static_cast<double>(run.rows()) * data.period_s,
                   run.excitation.empty() ? "" : ": ", escape_html(run.excitation));
  }
  return out +
         "</ul>\n<p class=\"note\">The search draws no random numbers; maps and noise come "
         "from a bootstrap with seed 1. The same recordings give the same page. ± is one standard "
         "error.</p>";
}

}  // namespace teleop
