#include "scenarios/blind_report.hpp"

#include <array>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "scenarios/blind_store.hpp"
#include "scenarios/concealed/seal.hpp"

namespace teleop {
namespace {

using Json = nlohmann::json;

struct Who {
  const char* key = nullptr;   ///< in the lines
  const char* name = nullptr;  ///< in tables
};
constexpr std::array<Who, 3> kContestants{{{"diagnosis", "diagnosis"},
                                           {"bic", "regression, BIC"},
                                           {"bic_correlated", "regression, BIC n/L"}}};

ScoredCase scored(const Json& line, const CaseTruth& truth, const char* who) {
  const Json& entry = line.at("answers").at(who);
  ScoredCase result{.score = score(truth, read_answer(entry.at("answer")))};
  if (entry.contains("held_out_over_true")) result.held_out = entry["held_out_over_true"];
  return result;
}

std::string text_of(const EffectName& name) {
  return name.kind + (name.axis ? fmt::format(" {}", *name.axis) : "");
}

std::string truth_text(const CaseTruth& truth) {
  std::string text;
  for (const TrueEffect& each : truth.effects) {
    text += (text.empty() ? "" : " + ") + text_of(each.name);
  }
  return text.empty() ? "nothing" : text;
}

std::string answer_text(const Json& entry) {
  if (entry.contains("failure")) return entry["failure"];
  const std::optional<GivenAnswer> answer = read_answer(entry.at("answer"));
  if (!answer) return "no answer";
  std::string text = answer->verdict;
  for (const GivenEffect& each : answer->effects) {
    text += fmt::format(", {} ({:.2f})", text_of(each.name), each.confidence);
    for (const GivenEffect::Alternative& other : each.alternatives) {
      if (other.confidence > 0.1) {
        text += fmt::format(" or {} ({:.2f})", text_of(other.name), other.confidence);
      }
    }
  }
  return text;
}

/// Below 2 % silence is as good as the name.
bool is_missed(const CaseScore& score) {
  constexpr double kVisible = 0.02;
  if (score.content == Content::stranger) return !score.flagged || score.misnamed;
  if (score.content != Content::one) return !score.good();
  const bool excused = score.dnr < kVisible && score.silent && !score.missing;
  return score.wrong_name || score.false_flag || !(score.right || excused);
}

std::vector<std::string> missed_row(const Json& line, const CaseTruth& truth) {
  std::string sort = truth.group;
  if (truth.group == "nasty" || truth.group == "null") sort += ", " + truth.sort;
  return {truth.name, sort, truth_text(truth), fmt::format("{:.3g} %", 100.0 * truth.dnr),
          answer_text(line.at("answers").at("diagnosis"))};
}

}  // namespace

BlindReport score_lines(const std::map<std::size_t, std::string>& lines,
                        const concealed::ConcealedPlan& plan) {
  BlindReport report;
  report.missed = {.title = "Cases that the diagnosis missed",
                   .rows = {{"case", "drawn as", "truth", "DNR", "answer"}}};
  std::array<std::vector<ScoredCase>, kContestants.size()> cases;
  concealed::Seal seal;
  for (const auto& [index, text] : lines) {
    const Json line = Json::parse(text);
    const CaseTruth truth = read_truth(line.at("truth"));
    for (std::size_t i = 0; i < kContestants.size(); ++i) {
      cases.at(i).push_back(scored(line, truth, kContestants.at(i).key));
    }
    if (is_missed(cases.front().back().score)) {
      report.missed.rows.push_back(missed_row(line, truth));
    }
    seal.add(truth_of_line(text));
  }
  if (lines.size() == plan.cases) report.sealed = seal.digits();
  for (std::size_t i = 0; i < kContestants.size(); ++i) {
    report.contestants.push_back({kContestants.at(i).name, rates_of(cases.at(i))});
  }
  return report;
}

nlohmann::ordered_json json_of(const BlindReport& report,
                               const concealed::ConcealedPlan& plan,
                               std::size_t done) {
  nlohmann::ordered_json json{{"seed", plan.seed}, {"cases", done}, {"planned", plan.cases}};
  json["sealed_sha256"] = nullptr;
  if (!report.sealed.empty()) json["sealed_sha256"] = report.sealed;
  json.update(json_of(report.contestants.front().rates));
  for (std::size_t i = 1; i < kContestants.size(); ++i) {
    json["regression"][kContestants.at(i).key] = json_of(report.contestants.at(i).rates);
  }
  json["missed"] = nlohmann::ordered_json::array();
  for (std::size_t i = 1; i < report.missed.rows.size(); ++i) {
    const auto& row = report.missed.rows[i];
    json["missed"].push_back(
        {{"case", row[0]}, {"drawn_as", row[1]}, {"truth", row[2]}, {"answer", row[4]}});
  }
  return json;
}

}  // namespace teleop
