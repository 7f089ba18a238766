#include "scenarios/diagnose.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <thread>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include "core/base/error.hpp"
#include "core/diagnosis/answer.hpp"
#include "core/diagnosis/audit.hpp"
#include "core/diagnosis/case_folder.hpp"
#include "core/diagnosis/case_logs.hpp"
#include "core/diagnosis/report.hpp"
#include "core/effects/plant_spec.hpp"
#include "core/effects/vocabulary.hpp"
#include "core/model/arm_model.hpp"
#include "scenarios/listening.hpp"
#include "scenarios/output.hpp"

namespace teleop {
namespace {

namespace fs = std::filesystem;

/// Tells how far a case is and how long it will take, on one line where somebody looks.
class ProgressLine {
 public:
  explicit ProgressLine(std::string name) : name_{std::move(name)} {}

  /// @param share of the work that is done
  void advance(double share) { share_ = std::max(share_, share); }

  void show(const std::string& what) const {
    const double passed =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
    constexpr double kTooEarly_s = 1.0;
    std::string left;
    if (passed > kTooEarly_s && share_ > 0.0) {
      left = fmt::format(", about {:.0f} s left", std::ceil(passed * (1.0 - share_) / share_));
    }
    if (isatty(STDERR_FILENO) != 0) {
      fmt::print(stderr, "\r\033[K{}: {:.0f} s{}, {}", name_, passed, left, what);
    } else {
      fmt::print(stderr, "{}: {:.0f} s{}, {}\n", name_, passed, left, what);
    }
  }

  void clear() const {
    if (isatty(STDERR_FILENO) != 0) fmt::print(stderr, "\r\033[K");
  }

 private:
  std::string name_;
  double share_ = 0.0;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

std::vector<DiagnosisCase> read_cases(const DiagnoseOptions& options) {
  std::vector<DiagnosisCase> all;
  std::vector<fs::path> logs;
  for (const fs::path& path : options.cases) {
    if (path.extension() == ".mcap") {
      logs.push_back(path);
    } else {
      all.push_back(read_case(path, options.data));
    }
  }
  if (!logs.empty()) {
    for (DiagnosisCase& each : read_log_cases(logs)) {
      all.push_back(std::move(each));
    }
  }
  return all;
}

/// Before anything is computed: nobody waits for a file that cannot be written.
void check_outputs(const DiagnoseOptions& options, std::size_t cases) {
  const std::array single{&options.json, &options.report, &options.corrected, &options.next};
  for (const fs::path* file : single) {
    if (file->empty()) continue;
    if (cases != 1) {
      throw ConfigError{fmt::format(
          "{}: --json, --report, --corrected and --next are for one case, here are {}; --json-dir "
          "and --report-dir take them all",
          file->string(), cases)};
    }
    const fs::path folder = file->has_parent_path() ? file->parent_path() : fs::path{"."};
    if (!fs::is_directory(folder)) {
      throw ConfigError{fmt::format("{}: the folder {} does not exist; make it or choose another",
                                    file->string(), folder.string())};
    }
    if (fs::is_directory(*file)) {
      throw ConfigError{fmt::format("{}: is a folder; give the name of a file", file->string())};
    }
  }
  for (const fs::path* folder : {&options.json_dir, &options.report_dir}) {
    if (folder->empty()) continue;
    std::error_code error;
    fs::create_directories(*folder, error);
    if (!fs::is_directory(*folder)) {
      throw ConfigError{fmt::format("{}: the folder cannot be made", folder->string())};
    }
  }
}

/// What the audit says of each case. @throws ConfigError when one cannot be used.
std::vector<Audit> audit_all(const std::vector<DiagnosisCase>& cases) {
  std::vector<Audit> audits;
  audits.reserve(cases.size());
  for (const DiagnosisCase& each : cases) {
    if (!each.bench.empty()) {
      throw ConfigError{each.name + ": benches of independent axes are read, not yet diagnosed"};
    }
    audits.push_back(audit(each));
    refuse_fatal(audits.back());
  }
  return audits;
}

std::string value_with_error(double value, double deviation, std::string_view unit) {
  if (deviation <= 0.0) return fmt::format("{:.4g} {}", value, unit);
  // Two digits of the error, and the value to the same place.
  const int place = static_cast<int>(std::floor(std::log10(deviation))) - 1;
  const int decimals = std::clamp(-place, 0, 9);
  return fmt::format("{:.{}f} ± {:.{}f} {}", value, decimals, deviation, decimals, unit);
}

void print_effect(const nlohmann::ordered_json& effect) {
  std::string axis = "the whole arm";
  if (!effect["axis"].is_null()) axis = fmt::format("axis {}", effect["axis"].dump());
  fmt::print("  {} on {}, confidence {:.2f}\n", effect["kind"].get<std::string>(), axis,
             effect["confidence"].get<double>());
  for (const auto& parameter : effect["parameters"]) {
    fmt::print("    {:<22} {}\n", parameter["name"].get<std::string>(),
               value_with_error(parameter["value"].get<double>(), parameter["std"].get<double>(),
                                parameter["unit"].get<std::string>()));
  }
  for (const auto& rival : effect["alternatives"]) {
    fmt::print("    or {} {}, confidence {:.2f}\n", rival["kind"].get<std::string>(),
               rival["axis"].dump(), rival["confidence"].get<double>());
  }
}

void print_answer(const std::string& name,
                  const Diagnosis& diagnosis,
                  const nlohmann::ordered_json& answer) {
  fmt::print("{}: {}\n  {}\n", name, answer["verdict"].get<std::string>(), headline_of(diagnosis));
  for (const std::string& sentence : story_of(diagnosis)) {
    fmt::print("  {}\n", sentence);
  }
  for (const auto& effect : answer["effects"]) {
    print_effect(effect);
  }
  fmt::print("  where: {}\n", answer["mismatch"]["where"].get<std::string>());
  fmt::print(
      "  runs left out are missed by {:.3f} with the nominal model, {:.3f} with this one "
      "(1: noise alone)\n",
      answer["fit"]["nominal_nrmse"].get<double>(), answer["fit"]["corrected_nrmse"].get<double>());
  fmt::print("  next: {}\n", answer["next_experiment"].get<std::string>());
  std::fflush(stdout);
}

PlantSpec corrected_plant(const DiagnosisCase& data, const Diagnosis& diagnosis) {
  PlantSpec plant;
  plant.arm = data.plant;
  plant.name = data.name;
  plant.effects.reserve(diagnosis.found.effects.size());
  for (const NamedEffect& named : diagnosis.found.effects) {
    plant.effects.push_back(named.effect);
  }
  return plant;
}

void write_next(const fs::path& file, const PlantSpec& plant, const NextExperiment& next) {
  if (next.motions.empty()) return;
  fs::path log = file;
  log.replace_extension(".mcap");
  write_text(file, scenario_of(next, plant, log.string()));
}

/// Everything that is wanted of one case but what goes to stdout.
void write_case(const DiagnoseOptions& options,
                const ReportedDiagnosis& reported,
                const nlohmann::ordered_json& answer) {
  const std::string& name = reported.data.name;
  if (!options.json_dir.empty()) write_json(options.json_dir / (name + ".json"), answer);
  if (!options.json.empty()) write_json(options.json, answer);
  const PlantSpec plant = corrected_plant(reported.data, reported.diagnosis);
  if (!options.corrected.empty()) write_text(options.corrected, to_toml(plant));
  if (!options.next.empty()) write_next(options.next, plant, reported.diagnosis.next);
  if (options.report.empty() && options.report_dir.empty()) return;
  const std::string page = diagnosis_page(reported);
  if (!options.report.empty()) write_text(options.report, page);
  if (!options.report_dir.empty()) write_text(options.report_dir / (name + ".html"), page);
}

/// One case after the other, until somebody stops it.
void diagnose_all(const DiagnoseOptions& options,
                  const std::vector<DiagnosisCase>& cases,
                  const std::vector<Audit>& audits,
                  const std::atomic<bool>& asked) {
  const std::size_t cores = std::max(1U, std::thread::hardware_concurrency());
  const std::size_t threads =
      options.threads > 0 ? static_cast<std::size_t>(options.threads) : cores;
  std::vector<IndexEntry> index;
  for (std::size_t i = 0; i < cases.size(); ++i) {
    if (asked && i > 0) break;  // of the first something is known in any case
    ProgressLine line{cases[i].name};
    Likelihood likelihood{cases[i], load_arm(cases[i].plant), threads};
    const Diagnosis diagnosis =
        diagnose(likelihood, {.progress = [&line](const std::string& what) { line.show(what); },
                              .advanced = [&line](double share) { line.advance(share); },
                              .stop = &asked});
    line.clear();
    const nlohmann::ordered_json answer = answer_of(diagnosis, cases[i]);
    print_answer(cases[i].name, diagnosis, answer);
    write_case(options,
               {.diagnosis = diagnosis,
                .data = cases[i],
                .audit = audits[i],
                .next_file = options.next.string()},
               answer);
    index.push_back({.name = cases[i].name,
                     .file = cases[i].name + ".html",
                     .verdict = std::string{text_of(diagnosis.verdict)},
                     .headline = headline_of(diagnosis)});
  }
  if (!options.report_dir.empty()) {
    write_text(options.report_dir / "index.html", index_page(index));
  }
}

}  // namespace

int run_diagnose(const DiagnoseOptions& options) {
  const std::vector<DiagnosisCase> cases = read_cases(options);
  check_outputs(options, cases.size());
  const std::vector<Audit> audits = audit_all(cases);
  std::atomic<bool> asked{false};
  run_while_listening(asked, [&] { diagnose_all(options, cases, audits, asked); });
  if (!asked) return 0;
  std::fputs("stopped before the end: what was known by then is written\n", stderr);
  return 1;
}

}  // namespace teleop
