#include "core/diagnosis/report.hpp"

#include <cctype>
#include <cmath>
#include <iterator>

#include <fmt/format.h>

#include "core/diagnosis/miss_words.hpp"
#include "core/diagnosis/page.hpp"
#include "core/diagnosis/report_parts.hpp"
#include "core/reporting/escape.hpp"
#include "core/reporting/form.hpp"
#include "core/reporting/page.hpp"

namespace teleop {
namespace {

bool something_is_left(const Diagnosis& diagnosis) {
  return diagnosis.verdict == Verdict::partly_explained ||
         diagnosis.verdict == Verdict::unexplained;
}

/// "3 %", "0.4 %"
std::string percent(double share) {
  if (!std::isfinite(share)) return "all";
  return fmt::format("{:.{}f} %", 100.0 * share, 100.0 * share < 0.95 ? 1 : 0);
}

std::string leftover_sentence(const Diagnosis& diagnosis) {
  const Leftover& first = diagnosis.leftovers.front();
  return fmt::format("on axis {} {}", first.axis + 1, text_of(first));
}

std::string figure(const std::string& label, const std::string& value, const std::string& more) {
  return fmt::format(
      "<div class=\"figure\"><dt>{}</dt><dd><b>{}</b></dd><dd class=\"more\">{}</dd></div>\n",
      label, value, more);
}

std::string figures_of(const Diagnosis& diagnosis) {
  const auto axis = static_cast<Eigen::Index>(diagnosis.where.axis);
  const FreeRun& free = diagnosis.free;
  const std::string on = fmt::format("of the motion of axis {}", axis + 1);
  std::string verdict{text_of(diagnosis.verdict)};
  for (char& c : verdict) {
    if (c == '_') c = ' ';
  }
  std::string out = figure("Verdict", verdict, "") +
                    figure("Nominal model misses", percent(free.nominal[axis]), on);
  if (!diagnosis.found.effects.empty()) {
    out += figure("Corrected model misses", percent(free.corrected[axis]), on);
  }
  return out + figure("Noise makes", percent(free.noise[axis]), on) +
         figure("Prediction errors",
                fmt::format("{:.2f}&nbsp;→&nbsp;{:.2f}", diagnosis.fit.nominal,
                            diagnosis.fit.corrected),
                "in units of the noise") +
         figure("Chance of that by noise",
                diagnosis.p_value < 1e-4 ? "&lt; 0.01 %" : percent(diagnosis.p_value),
                fmt::format("{} runs", diagnosis.fit.runs.size()));
}

std::string subtitle_of(const DiagnosisCase& data) {
  double seconds = 0.0;
  for (const Recording& run : data.runs) {
    seconds += static_cast<double>(run.rows()) * data.period_s;
  }
  return fmt::format("{} · {} run{} · {:.0f} s at {:.0f} Hz", escape_html(data.plant),
                     data.runs.size(), data.runs.size() == 1 ? "" : "s", seconds,
                     1.0 / data.period_s);
}

std::string troubles_of(const Diagnosis& diagnosis) {
  std::string out;
  const auto add = [&](const std::string& text) {
    out += fmt::format("<li>{}</li>\n", sentence_html(text));
  };
  if (diagnosis.found.unfinished) {
    add("The search was stopped before its end: this is what was known by then.");
  }
  if (diagnosis.verdict == Verdict::partly_explained) {
    add(fmt::format("Something is left that no known effect explains: {}.",
                    leftover_sentence(diagnosis)));
  }
  return out.empty() ? out : "<ul class=\"troubles\">\n" + out + "</ul>";
}

}  // namespace

std::string headline_of(const Diagnosis& diagnosis) {
  if (!diagnosis.found.effects.empty()) return sentence_of(diagnosis.found.effects.front());
  if (something_is_left(diagnosis)) {
    return fmt::format("Something is missing that no known effect explains: {}.",
                       leftover_sentence(diagnosis));
  }
  return "Nothing is missing: the nominal model explains the recordings.";
}

std::vector<std::string> story_of(const Diagnosis& diagnosis) {
  std::vector<std::string> story;
  const std::vector<NamedEffect>& effects = diagnosis.found.effects;
  for (std::size_t i = 1; i < effects.size(); ++i) {
    story.push_back(sentence_of(effects[i]));
  }
  const auto axis = static_cast<Eigen::Index>(diagnosis.where.axis);
  const FreeRun& free = diagnosis.free;
  if (effects.empty()) {
    story.push_back(fmt::format("The nominal model misses {} of the held-out motion, noise is {}.",
                                percent(free.nominal[axis]), percent(free.noise[axis])));
  } else {
    story.push_back(fmt::format(
        "The nominal model misses {} of the held-out motion, the corrected one {}, "
        "noise is {}.",
        percent(free.nominal[axis]), percent(free.corrected[axis]), percent(free.noise[axis])));
  }
  return story;
}

std::string diagnosis_page(const ReportedDiagnosis& reported) {
  const Diagnosis& diagnosis = reported.diagnosis;
  const std::string headline = headline_of(diagnosis);
  std::string story;
  for (const std::string& sentence : story_of(diagnosis)) {
    story += (story.empty() ? "" : " ") + sentence_html(sentence);
  }
  const TraceCharts traces = trace_charts(diagnosis, reported.data);
  std::string where = where_of(diagnosis) + ".";
  where.front() = static_cast<char>(std::toupper(static_cast<unsigned char>(where.front())));
  return fill_form(
      diagnosis_form::form,
      {{"case", escape_html(reported.data.name)},
       {"title", escape_html(headline)},
       {"mood", something_is_left(diagnosis) || diagnosis.found.unfinished ? "troubled" : "clean"},
       {"headline", sentence_html(headline)},
       {"subtitle", subtitle_of(reported.data)},
       {"story", story},
       {"troubles", troubles_of(diagnosis)},
       {"figures", figures_of(diagnosis)},
       {"effects", effect_table(diagnosis)},
       {"where", sentence_html(where)},
       {"maps", map_charts(diagnosis)},
       {"profiles", profile_charts(diagnosis)},
       {"trace_note", escape_html(traces.note)},
       {"traces", traces.html},
       {"spectra", spectrum_charts(diagnosis)},
       {"rivals", rival_table(diagnosis)},
       {"leftovers", leftover_table(diagnosis)},
       {"next", next_part(reported)},
       {"audit", audit_list(reported.audit)},
       {"method", method_part(diagnosis, reported.data)},
       {"style", std::string{page::style}},
       {"own_style", std::string{diagnosis_form::style}}});
}

std::string index_page(const std::vector<IndexEntry>& entries) {
  std::string rows;
  for (const IndexEntry& each : entries) {
    fmt::format_to(
        std::back_inserter(rows),
        "<tr><td class=\"value\"><a href=\"{}\">{}</a></td><td>{}</td><td>{}</td></tr>\n",
        escape_html(each.file), escape_html(each.name), escape_html(each.verdict),
        sentence_html(each.headline));
  }
  return fmt::format(
      "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
      "<meta name=\"color-scheme\" content=\"light dark\">\n<title>Diagnosis of {0} cases</title>\n"
      "<style>\n{1}\n{2}\n</style>\n</head>\n<body>\n<main>\n<p class=\"eyebrow\">Diagnosis</p>\n"
      "<h1>{0} cases</h1>\n<div class=\"scroll\"><table class=\"effects "
      "index\">\n<thead><tr><th>case"
      "</th><th>verdict</th><th>what was found</th></tr></thead>\n{3}</table></div>\n</main>\n"
      "</body>\n</html>\n",
      entries.size(), page::style, diagnosis_form::style, rows);
}

}  // namespace teleop
