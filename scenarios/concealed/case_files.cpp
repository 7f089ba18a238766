#include <cmath>
#include <fstream>
#include <iterator>
#include <string>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/base/error.hpp"
#include "scenarios/concealed/concealed_case.hpp"

namespace teleop::concealed {
namespace {

using Json = nlohmann::ordered_json;
namespace fs = std::filesystem;

void write_file(const fs::path& file, const std::string& text) {
  std::error_code failed;
  fs::create_directories(file.parent_path(), failed);
  std::ofstream stream{file, std::ios::binary};
  stream << text;
  stream.close();
  if (!stream) throw RecordingError{file.string() + ": cannot be written, look at its folder"};
}

std::string run_name(std::size_t index) { return fmt::format("run-{:02}.csv", index + 1); }

std::string rows_of(const Run& run, const ArmModel& arm) {
  const JointVector count = count_rad(arm);
  fmt::memory_buffer text;
  fmt::format_to(std::back_inserter(text), "t_s,tau1_Nm,tau2_Nm,tau3_Nm,q1_rad,q2_rad,q3_rad\n");
  for (std::size_t k = 0; k < run.counts.size(); ++k) {
    const JointVector& tau = run.logged[k];
    const auto& n = run.counts[k];
    fmt::format_to(std::back_inserter(text), "{:.3f},{:.5f},{:.5f},{:.5f},{:.7f},{:.7f},{:.7f}\n",
                   kStatedPeriod * static_cast<double>(k), tau[0] + 0.0, tau[1] + 0.0, tau[2] + 0.0,
                   n[0] * count[0], n[1] * count[1], n[2] * count[2]);
  }
  return fmt::to_string(text);
}

std::string case_toml(const ConcealedCase& drawn) {
  const auto& counts = drawn.device.nominal.parameters().encoder_counts_per_rev;
  std::string text = fmt::format(
      "# Recordings of one device.\ncase = \"{}\"\nplant = \"{}\"\nsample_rate_Hz = 1000\n"
      "torque_convention = \"zero-order hold: row k holds the command computed from the reading of "
      "row k and applied over [t_k, t_k+1)\"\n"
      "encoder_counts_per_joint_revolution = [{}, {}, {}]\ntorque_command_step_Nm = 0.00001\n",
      drawn.name, drawn.device.nominal.parameters().name, counts[0], counts[1], counts[2]);
  for (std::size_t k = 0; k + 1 < kRuns; ++k) {
    text += fmt::format("\n[[run]]\nfile = \"{}\"\nexcitation = \"{}\"\n", run_name(k),
                        drawn.runs[k].excitation);
  }
  return text;
}

Json numbers(const JointVector& x) { return {x[0], x[1], x[2]}; }

Json effect_json(const ConcealedCase& drawn, std::size_t index) {
  const Effect& effect = drawn.device.effects[index];
  Json result;
  result["kind"] = effect.kind;
  result["axis"] = nullptr;
  if (effect.axis) result["axis"] = *effect.axis + 1;
  result["parameters"] = Json::object();
  for (const auto& [name, value] : effect.parameters) {
    result["parameters"][name] = value;
  }
  if (find_kind(effect.kind).channel == "unknown") result["note"] = "not in the vocabulary";
  if (effect.training_only) result["present"] = "training runs only";
  if (index < drawn.dnr_alone.size()) {
    result["dnr_alone"] = drawn.dnr_alone[index];
    result["band_alone"] = name_of(band_of(drawn.dnr_alone[index]));
  }
  return result;
}

template <class T>
void add_once(Json& list, const T& item) {
  for (const Json& each : list) {
    if (each == item) return;
  }
  list.push_back(item);
}

}  // namespace

std::string truth_json(const ConcealedCase& drawn) {
  Json truth;
  truth["case"] = drawn.name;
  truth["class"] = name_of(drawn.slot.group);
  truth["sub"] = drawn.slot.sort;
  truth["sort"] = drawn.slot.sort;
  truth["effects"] = Json::array();
  truth["channels"] = Json::array();
  truth["axes"] = Json::array();
  for (std::size_t i = 0; i < drawn.device.effects.size(); ++i) {
    const Effect& effect = drawn.device.effects[i];
    truth["effects"].push_back(effect_json(drawn, i));
    add_once(truth["channels"], find_kind(effect.kind).channel);
    if (effect.axis) add_once(truth["axes"], *effect.axis + 1);
  }
  if (truth["channels"].empty()) truth["channels"].push_back("none");
  truth["band"] = name_of(drawn.band);
  truth["dnr"] = drawn.dnr;
  truth["dnr_held_out"] = drawn.dnr_held_out;
  const Disturbance& noise = drawn.device.disturbance;
  truth["disturbance"] = {{"white_Nm", numbers(noise.white_Nm)},
                          {"coloured_Nm", numbers(noise.coloured_Nm)},
                          {"coloured_time_s", numbers(noise.coloured_time_s)},
                          {"narrow_Nm", numbers(noise.narrow_Nm)},
                          {"narrow_Hz", noise.narrow_Hz},
                          {"encoder_noise_counts", noise.encoder_noise_counts}};
  const ArmModel::Lumped& body = drawn.device.arm.lumped();
  truth["arm"] = {{"K", body.K},     {"S0", body.S0},   {"S2", body.S2}, {"S3", body.S3},
                  {"M22", body.M22}, {"M33", body.M33}, {"N2", body.N2}, {"N3", body.N3}};
  return truth.dump(1) + "\n";
}

void write_case(const ConcealedCase& drawn, const fs::path& folder) {
  write_file(folder / drawn.name / "case.toml", case_toml(drawn));
  for (std::size_t k = 0; k + 1 < kRuns; ++k) {
    write_file(folder / drawn.name / run_name(k), rows_of(drawn.runs[k], drawn.device.nominal));
  }
}

void write_truth(const ConcealedCase& drawn, const fs::path& folder) {
  write_file(folder / drawn.name / "truth.json", truth_json(drawn));
  write_file(folder / drawn.name / run_name(kRuns - 1),
             rows_of(drawn.runs[kRuns - 1], drawn.device.nominal));
}

}  // namespace teleop::concealed
