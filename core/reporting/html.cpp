#include "core/reporting/html.hpp"

#include <fstream>

#include <fmt/format.h>

#include "core/base/error.hpp"
#include "core/reporting/charts.hpp"
#include "core/reporting/escape.hpp"
#include "core/reporting/form.hpp"
#include "core/reporting/page.hpp"
#include "core/reporting/tables.hpp"
#include "core/reporting/words.hpp"

namespace teleop {
namespace {

namespace fs = std::filesystem;

/// "phantom-1.5 · surroundings wall · seed 3", of what the metadata say. The hand holds the master,
/// the surroundings are the slave's; of a run of one side both are that side's.
std::string subtitle(std::span<const Log> logs) {
  std::string out;
  const auto add = [&](const char* key, const char* label, const char* role = nullptr) {
    const Log* log = &logs.front();
    for (const Log& other : logs) {
      const auto of = other.metadata.find("role");
      if (role != nullptr && of != other.metadata.end() && of->second == role) log = &other;
    }
    const auto entry = log->metadata.find(key);
    if (entry == log->metadata.end() || entry->second.empty()) return;
    out += fmt::format("{}{}{}", out.empty() ? "" : " · ", label, escape_html(entry->second));
  };
  add("arm", "");
  add("environment", "surroundings ", "slave");
  add("hand", "hand ", "master");
  add("seed", "seed ");
  add("version", "version ");
  return out;
}

std::string story_text(const Words& words) {
  std::string out;
  for (const std::string& sentence : words.story) {
    if (!out.empty()) out += ' ';
    out += sentence_html(sentence);
  }
  return out;
}

std::string trouble_list(const Words& words) {
  if (words.troubles.empty()) return {};
  std::string out = "<ul class=\"troubles\">\n";
  for (const std::string& trouble : words.troubles) {
    out += fmt::format("<li>{}</li>\n", sentence_html(trouble));
  }
  return out + "</ul>";
}

}  // namespace

std::string report_page(std::span<const Log> logs, const PairMetrics& metrics) {
  const Run run = arrange(logs);
  const Words words = describe(metrics);
  return fill_form(page::form, {{"headline", escape_html(words.headline)},
                                {"verdict", words.troubles.empty() ? "clean" : "troubled"},
                                {"subtitle", subtitle(logs)},
                                {"story", story_text(words)},
                                {"troubles", trouble_list(words)},
                                {"figures", key_figures(metrics)},
                                {"numbers", number_table(metrics)},
                                {"metadata", metadata_table(run)},
                                {"style", std::string{page::style}},
                                {"dygraphs_style", std::string{page::dygraphs_style}},
                                {"dygraphs", std::string{page::dygraphs}},
                                {"script", std::string{page::script}},
                                {"data", chart_data(run, metrics)}});
}

void write_report(const fs::path& file, std::span<const Log> logs, const PairMetrics& metrics) {
  std::error_code error;
  for (const Log& log : logs) {
    if (file == log.file || fs::equivalent(file, log.file, error)) {
      throw ConfigError{fmt::format(
          "{}: is one of the recordings; choose another name for the report", file.string())};
    }
  }
  const std::string page = report_page(logs, metrics);
  const fs::path draft = file.string() + ".part";
  std::ofstream out{draft, std::ios::binary};
  out.write(page.data(), static_cast<std::streamsize>(page.size()));
  out.close();
  error.clear();
  if (out) fs::rename(draft, file, error);
  if (!out || error) {
    std::error_code ignored;
    fs::remove(draft, ignored);
    throw ConfigError{fmt::format("{}: cannot be written; choose another place", file.string())};
  }
}

}  // namespace teleop
