#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/math/random.hpp"
#include "scenarios/concealed/effect_draw.hpp"
#include "scenarios/scoring/equivalence.hpp"
#include "scenarios/scoring/rates.hpp"
#include "tests/support/temporary_folder.hpp"

namespace teleop {
namespace {

namespace fs = std::filesystem;
using concealed::Effect;
using nlohmann::json;
using testing::TemporaryFolder;

const fs::path kScorer = fs::path{TELEOP_SOURCE_DIR} / "../shared/challenge/score.py";

template <class List>
const auto& one_of(const List& list, Random& random) {
  return list[static_cast<std::size_t>(random.bits() % list.size())];
}

json effect_json(const Effect& effect) {
  json result{{"kind", effect.kind}, {"axis", nullptr}, {"parameters", json::object()}};
  if (effect.axis) result["axis"] = *effect.axis + 1;
  for (const auto& [name, value] : effect.parameters) {
    result["parameters"][name] = value;
  }
  return result;
}

/// A made-up truth: nothing, one, two effects or a stranger, in sizes that touch every class of
/// equivalent kinds.
json draw_truth(std::size_t index, const ArmModel& arm, Random& random) {
  static const std::vector<std::string> groups{"null", "single", "single", "pair",
                                               "out_of_vocabulary"};
  static const std::vector<std::string> bands{"obvious", "visible", "faint", "invisible"};
  const std::string& group = one_of(groups, random);
  json truth{{"case", fmt::format("case-{:04}", index + 1)},
             {"class", group},
             {"sub", "made up"},
             {"effects", json::array()},
             {"channels", json::array()},
             {"axes", json::array()},
             {"band", group == "null" ? "invisible" : one_of(bands, random)}};
  const int number = group == "null" ? 0 : group == "pair" ? 2 : 1;
  for (int i = 0; i < number; ++i) {
    const bool stranger = group == "out_of_vocabulary";
    const concealed::Kind& kind =
        one_of(stranger ? concealed::strangers() : concealed::vocabulary(), random);
    concealed::Sized sized{kind.name, {}, arm, random};
    truth["effects"].push_back(effect_json(sized.at(random.uniform(0.1, 1.5))));
    truth["channels"].push_back(kind.channel);
    if (i == 1 && random.uniform() < 0.3) truth["effects"][1]["band_alone"] = "invisible";
  }
  if (number == 0) truth["channels"].push_back("none");
  return truth;
}

/// Any effect at all.
json any_name(const ArmModel& arm, Random& random) {
  concealed::Sized sized{one_of(concealed::vocabulary(), random).name, {}, arm, random};
  return effect_json(sized.at(1.0));
}

/// About what the truth is, or an equivalent, or something else.
json given_effect(const json& truth, const ArmModel& arm, Random& random) {
  json base = any_name(arm, random);
  if (!truth.at("effects").empty() && random.uniform() < 0.8) {
    base = one_of(truth.at("effects"), random);
    const TrueEffect real = [&] {
      TrueEffect effect{.name = {base["kind"], {}},
                        .parameters = base["parameters"].get<std::map<std::string, double>>()};
      effect.in_vocabulary = effect.name.kind.rfind("oov_", 0) != 0;
      if (!base["axis"].is_null()) effect.name.axis = base["axis"].get<int>();
      return effect;
    }();
    const auto names = equivalents(real);
    if (!names.empty() && random.uniform() < 0.5) {
      const EffectName& name = one_of(names, random);
      base["kind"] = name.kind;
      base["axis"] = name.axis ? json(*name.axis) : json(nullptr);
    }
  }
  json result{{"kind", base["kind"]},
              {"axis", base["axis"]},
              {"confidence", std::min(1.0, random.uniform(0.1, 1.2))},
              {"parameters", json::array()},
              {"alternatives", json::array()}};
  for (const auto& [name, value] : base["parameters"].items()) {
    json parameter{{"name", name}, {"value", value.get<double>() * (1.0 + 0.02 * random.normal())}};
    if (name == "from_axis") parameter["value"] = value;
    if (random.uniform() < 0.8) parameter["std"] = 0.02 * std::abs(value.get<double>());
    if (random.uniform() < 0.9) result["parameters"].push_back(parameter);
  }
  for (std::uint64_t left = random.bits() % 6; left > 0; --left) {
    json other = any_name(arm, random);
    if (!truth.at("effects").empty() && random.uniform() < 0.5) {
      other = one_of(truth.at("effects"), random);
    }
    result["alternatives"].push_back({{"kind", other["kind"]},
                                      {"axis", other["axis"]},
                                      {"confidence", random.uniform(0.0, 0.4)}});
  }
  return result;
}

json draw_answer(const json& truth, const ArmModel& arm, Random& random) {
  static const std::vector<std::string> verdicts{"explained", "explained",        "explained",
                                                 "adequate",  "partly_explained", "unexplained"};
  static const std::vector<json> channels{
      "joint", "actuation", "none", "unknown", json::array({"joint", "actuation"}), "joint, load"};
  json answer{{"verdict", one_of(verdicts, random)},
              {"mismatch", {{"axes", json::array()}, {"channel", one_of(channels, random)}}},
              {"effects", json::array()},
              {"fit",
               {{"nominal_nrmse", 2.0},
                {"corrected_nrmse", random.uniform(1.0, 1.5)},
                {"noise_floor_nrmse", 1.0}}}};
  for (int axis = 1; axis <= 3; ++axis) {
    if (random.uniform() < 0.3) answer["mismatch"]["axes"].push_back(axis);
  }
  for (std::uint64_t left = random.bits() % 4; left > 0; --left) {
    answer["effects"].push_back(given_effect(truth, arm, random));
  }
  if (random.uniform() < 0.1) {
    answer["effects"].push_back({{"kind", "unknown"}, {"axis", 2}, {"confidence", 0.9}});
  }
  return answer;
}

/// What the reference scorer says of answers in a folder; nothing when it cannot run here.
json reference(const TemporaryFolder& folder, const json& labels) {
  (void)folder.write("labels.json", json{{"cases", labels}}.dump());
  const std::string out = (folder.path() / "scores.json").string();
  const std::string command = fmt::format(
      "/usr/bin/python3 -c 'import numpy, scipy' 2>/dev/null && /usr/bin/python3 {} --labels {} "
      "--answers {} --json {} >/dev/null",
      kScorer.string(), (folder.path() / "labels.json").string(), folder.path().string(), out);
  if (std::system(command.c_str()) != 0) return {};  // NOLINT(cert-env33-c,concurrency-mt-unsafe)
  return json::parse(std::ifstream{out});
}

void compare(const json& row, const CaseScore& ours) {
  EXPECT_EQ(row.at("detected"), ours.detected);
  EXPECT_EQ(row.at("top1"), ours.right);
  EXPECT_EQ(row.at("topset"), ours.in_set);
  EXPECT_EQ(row.at("wrong_name"), ours.wrong_name);
  EXPECT_EQ(row.at("false_flag"), ours.false_flag);
  EXPECT_EQ(row.at("channel_ok"), ours.channel);
  EXPECT_EQ(row.at("axis_ok"), ours.axis ? json(*ours.axis) : json(nullptr));
  if (row.contains("pair_exact")) {
    EXPECT_EQ(row["pair_exact"], ours.pair_exact);
  }
  if (row.contains("pair_any")) {
    EXPECT_EQ(row["pair_any"], ours.pair_any);
  }
  if (row.contains("flagged")) {
    EXPECT_EQ(row["flagged"], ours.flagged);
  }
  if (row.contains("misnamed")) {
    EXPECT_EQ(row["misnamed"], ours.misnamed);
  }
}

void compare(const json& summary, const Rates& ours) {
  EXPECT_EQ(summary.at("missing"), ours.missing.k);
  EXPECT_EQ(summary.at("null").at("n"), ours.false_discoveries.n);
  EXPECT_EQ(summary.at("null").at("false_discoveries"), ours.false_discoveries.k);
  EXPECT_NEAR(summary.at("null").at("upper95"), ours.false_discoveries.upper95(), 1e-9);
  EXPECT_EQ(summary.at("pairs").at("n"), ours.pairs_exact.n);
  EXPECT_NEAR(summary.at("pairs").at("exact"), ours.pairs_exact.value().value_or(-1.0), 1e-12);
  const json& strangers = summary.at("out_of_vocabulary").at("all");
  EXPECT_NEAR(strangers.at("flagged"), ours.flagged.value().value_or(-1.0), 1e-12);
  EXPECT_NEAR(strangers.at("misnamed"), ours.misnamed.value().value_or(-1.0), 1e-12);
  const json& obvious = summary.at("single").at("obvious");
  EXPECT_EQ(obvious.at("n"), ours.bands[0].right.n);
  EXPECT_NEAR(obvious.at("top1"), ours.bands[0].right.value().value_or(-1.0), 1e-12);
  EXPECT_NEAR(obvious.at("axis_ok"), ours.bands[0].axis.value().value_or(-1.0), 1e-12);
  EXPECT_EQ(summary.at("single").at("visible").at("n"), ours.bands[1].right.n);
  EXPECT_NEAR(summary.at("calibration").at("ece"), ours.calibration.ece, 1e-9);
  EXPECT_NEAR(summary.at("calibration").at("brier"), ours.calibration.brier, 1e-9);
  EXPECT_NEAR(summary.at("fit").at("corrected_over_floor_median"), ours.over_floor.median, 1e-9);
  const json& all = summary.at("parameters").at("all");
  EXPECT_EQ(all.at("n_cov"), ours.covered_all.n);
  EXPECT_NEAR(all.at("coverage90"), ours.covered_all.value().value_or(-1.0), 1e-9);
}

/// Truths and answers of every sort, drawn: every verdict of ours on every case is the reference's.
TEST(Reference, AgreesCaseByCaseOnMadeUpCases) {
  if (!fs::exists(kScorer)) GTEST_SKIP() << "no reference scorer at " << kScorer;
  const ArmModel arm = load_arm("phantom-1.5");
  Random random{77};
  const TemporaryFolder folder;
  json labels = json::array();
  std::vector<ScoredCase> ours;
  for (std::size_t index = 0; index < 600; ++index) {
    labels.push_back(draw_truth(index, arm, random));
    std::optional<GivenAnswer> given;
    if (random.uniform() > 0.02) {
      const json answer = draw_answer(labels.back(), arm, random);
      (void)folder.write(labels.back()["case"].get<std::string>() + ".json", answer.dump());
      given = read_answer(answer);
    }
    ours.push_back({.score = score(read_truth(labels.back()), given)});
  }
  const json theirs = reference(folder, labels);
  if (theirs.is_null()) GTEST_SKIP() << "no python3 with numpy and scipy";
  for (std::size_t i = 0; i < ours.size(); ++i) {
    SCOPED_TRACE(labels[i].dump());
    compare(theirs.at("cases").at(i), ours[i].score);
  }
  compare(theirs.at("summary"), rates_of(ours));
}

/// The same on the practice cases of the challenge, with answers written by hand.
TEST(Reference, AgreesOnThePracticeCases) {
  const fs::path practice = kScorer.parent_path() / "practice";
  if (!fs::exists(practice)) GTEST_SKIP() << "no cases at " << practice;
  const TemporaryFolder folder;
  json labels = json::array();
  std::vector<ScoredCase> ours;
  for (int number = 1; number <= 12; ++number) {
    const std::string name = fmt::format("case-{:04}", number);
    labels.push_back(json::parse(std::ifstream{practice / name / "truth.json"}));
    // Right on odd cases, on even ones Coulomb friction of axis 3 whatever the truth is.
    json answer{{"verdict", "explained"}, {"mismatch", {{"axes", {3}}, {"channel", "joint"}}}};
    answer["effects"] = {{{"kind", "coulomb_friction"}, {"axis", 3}, {"confidence", 0.8}}};
    if (number % 2 == 1) {
      answer["effects"] = json::array();
      for (const json& effect : labels.back().at("effects")) {
        json named{{"kind", effect["kind"]}, {"axis", effect["axis"]}, {"confidence", 0.9}};
        for (const auto& [parameter, value] : effect["parameters"].items()) {
          named["parameters"].push_back(
              {{"name", parameter}, {"value", value.get<double>() * 1.01}, {"std", 1e-3}});
        }
        answer["effects"].push_back(named);
      }
      if (answer["effects"].empty()) answer["verdict"] = "adequate";
    }
    (void)folder.write(name + ".json", answer.dump());
    ours.push_back({.score = score(read_truth(labels.back()), read_answer(answer))});
  }
  const json theirs = reference(folder, labels);
  if (theirs.is_null()) GTEST_SKIP() << "no python3 with numpy and scipy";
  for (std::size_t i = 0; i < ours.size(); ++i) {
    SCOPED_TRACE(labels[i].dump());
    compare(theirs.at("cases").at(i), ours[i].score);
  }
}

}  // namespace
}  // namespace teleop
