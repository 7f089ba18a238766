#include "scenarios/diagnose.hpp"

#include <algorithm>
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
#include "core/effects/plant_spec.hpp"
#include "core/effects/vocabulary.hpp"
#include "core/model/arm_model.hpp"
#include "scenarios/output.hpp"

namespace teleop {
namespace {

namespace fs = std::filesystem;

/// Tells how far a case is, on one line where somebody looks.
class ProgressLine {
 public:
  explicit ProgressLine(std::string name) : name_{std::move(name)} {}

  void show(const std::string& what) const {
    const double passed =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
    if (isatty(STDERR_FILENO) != 0) {
      fmt::print(stderr, "\r\033[K{}: {:.0f} s, {}", name_, passed, what);
    } else {
      fmt::print(stderr, "{}: {:.0f} s, {}\n", name_, passed, what);
    }
  }

  void clear() const {
    if (isatty(STDERR_FILENO) != 0) fmt::print(stderr, "\r\033[K");
  }

 private:
  std::string name_;
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

void check(const DiagnoseOptions& options, const std::vector<DiagnosisCase>& cases) {
  const bool single = !options.json.empty() || !options.corrected.empty();
  if (single && cases.size() != 1) {
    throw ConfigError{fmt::format(
        "--json and --corrected are for one case, here are {}; --json-dir takes them all",
        cases.size())};
  }
  for (const DiagnosisCase& each : cases) {
    if (!each.bench.empty()) {
      throw ConfigError{each.name + ": benches of independent axes are read, not yet diagnosed"};
    }
    refuse_fatal(audit(each));
  }
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

void print_answer(const std::string& name, const nlohmann::ordered_json& answer) {
  fmt::print("{}: {}\n", name, answer["verdict"].get<std::string>());
  for (const auto& effect : answer["effects"]) {
    print_effect(effect);
  }
  const auto& where = answer["mismatch"]["where"].get_ref<const std::string&>();
  if (!where.empty()) fmt::print("  {}\n", where);
  fmt::print(
      "  runs left out are missed by {:.3f} with the nominal model, {:.3f} with this one "
      "(1: noise alone)\n",
      answer["fit"]["nominal_nrmse"].get<double>(), answer["fit"]["corrected_nrmse"].get<double>());
  std::fflush(stdout);
}

}  // namespace

int run_diagnose(const DiagnoseOptions& options) {
  const std::vector<DiagnosisCase> cases = read_cases(options);
  check(options, cases);
  if (!options.json_dir.empty()) fs::create_directories(options.json_dir);
  const std::size_t cores = std::max(1U, std::thread::hardware_concurrency());
  const std::size_t threads =
      options.threads > 0 ? static_cast<std::size_t>(options.threads) : cores;
  for (const DiagnosisCase& each : cases) {
    const ProgressLine line{each.name};
    Likelihood likelihood{each, load_arm(each.plant), threads};
    const Diagnosis diagnosis = diagnose(likelihood, {.progress = [&line](const std::string& what) {
                                           line.show(what);
                                         }});
    line.clear();
    const nlohmann::ordered_json answer = answer_of(diagnosis, each);
    print_answer(each.name, answer);
    if (!options.json_dir.empty()) write_json(options.json_dir / (each.name + ".json"), answer);
    if (!options.json.empty()) write_json(options.json, answer);
    if (!options.corrected.empty()) {
      PlantSpec plant;
      plant.arm = each.plant;
      plant.name = each.name;
      for (const NamedEffect& named : diagnosis.found.effects) {
        plant.effects.push_back(named.effect);
      }
      write_text(options.corrected, to_toml(plant));
    }
  }
  return 0;
}

}  // namespace teleop
