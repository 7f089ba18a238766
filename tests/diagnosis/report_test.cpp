#include "core/diagnosis/report.hpp"

#include <atomic>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/diagnosis/made_case.hpp"

namespace teleop {
namespace {

using testing::make_case;
using testing::phantom;

EffectSpec friction(double level) {
  return {.kind = "coulomb_friction", .axis = 1, .parameters = {{"level", level}}};
}

bool has(const std::string& page, const std::string& what) {
  return page.find(what) != std::string::npos;
}

/// Everything that a page must have, whatever was found.
void expect_whole(const std::string& page) {
  EXPECT_TRUE(page.starts_with("<!doctype html>"));
  EXPECT_FALSE(has(page, "{{"));
  EXPECT_FALSE(has(page, "http:") || has(page, "https:") || has(page, "src=")) << "needs others";
  EXPECT_FALSE(has(page, "<script"));
  EXPECT_FALSE(has(page, ">nan"));
  for (const char* head :
       {"What was found", "Where", "Before and after", "Frequencies", "Rivals", "What is left",
        "What to try next", "What the audit found", "How this answer was made"}) {
    EXPECT_TRUE(has(page, std::string{"<h2>"} + head)) << head;
  }
}

TEST(DiagnosisReport, SaysInPlainWordsWhatIsMissing) {
  const DiagnosisCase data = make_case({.effects = {friction(0.008)}, .runs = 2, .seed = 12});
  Likelihood likelihood{data, phantom(), 1};
  const Diagnosis diagnosis = diagnose(likelihood, {});
  const Audit audited = audit(data);
  const std::string page = diagnosis_page(
      {.diagnosis = diagnosis, .data = data, .audit = audited, .next_file = "n.toml"});
  expect_whole(page);
  EXPECT_TRUE(headline_of(diagnosis).starts_with("Axis 2 loses ")) << headline_of(diagnosis);
  EXPECT_TRUE(headline_of(diagnosis).ends_with(" mNm against every motion: dry friction."));
  EXPECT_TRUE(story_of(diagnosis).back().starts_with("The nominal model misses "));
  EXPECT_TRUE(has(page, "and the corrected one"));
  EXPECT_TRUE(has(page, "teleop run n.toml"));
  const auto answer = answer_of(diagnosis, data);
  EXPECT_TRUE(answer.at("mismatch").at("where").get<std::string>().starts_with("axis 2, against"));
  EXPECT_FALSE(answer.at("next_experiment").get<std::string>().empty());
}

TEST(DiagnosisReport, SaysWhenNothingIsMissing) {
  const DiagnosisCase data = make_case({.runs = 2, .seed = 13});
  Likelihood likelihood{data, phantom(), 1};
  const Diagnosis diagnosis = diagnose(likelihood, {});
  const Audit audited = audit(data);
  const std::string page = diagnosis_page({.diagnosis = diagnosis, .data = data, .audit = audited});
  expect_whole(page);
  EXPECT_TRUE(headline_of(diagnosis).starts_with("Nothing is missing"));
  EXPECT_TRUE(has(page, "header class=\"clean\""));
  EXPECT_FALSE(has(page, "and the corrected one"));
}

TEST(StoppedSearch, KeepsWhatIsKnownAndSaysThatItIsNotAll) {
  const DiagnosisCase data = make_case({.effects = {friction(0.006)}, .runs = 2, .seed = 14});
  Likelihood likelihood{data, phantom(), 1};
  std::atomic<bool> stop{false};
  SearchOptions options{.stop = &stop};
  options.progress = [&stop](const std::string& what) {
    if (what.starts_with("weighing")) stop = true;
  };
  double share = 0.0;
  options.advanced = [&share](double now) {
    EXPECT_GE(now, share);
    EXPECT_LE(now, 1.0);
    share = now;
  };
  const Diagnosis diagnosis = diagnose(likelihood, options);
  EXPECT_TRUE(diagnosis.found.unfinished);
  EXPECT_GT(share, 0.2);
  ASSERT_EQ(diagnosis.found.effects.size(), 1U) << "the best candidate was known";
  EXPECT_EQ(diagnosis.found.effects.front().effect.kind, "coulomb_friction");
  const auto answer = answer_of(diagnosis, data);
  EXPECT_TRUE(answer.at("mismatch").at("where").get<std::string>().starts_with("unfinished"));
  const Audit audited = audit(data);
  EXPECT_TRUE(has(diagnosis_page({.diagnosis = diagnosis, .data = data, .audit = audited}),
                  "stopped before its end"));
}

TEST(DiagnosisIndex, LeadsToEveryCase) {
  const std::string page = index_page({{.name = "a<b", .file = "a.html", .verdict = "adequate"},
                                       {.name = "c", .file = "c.html", .headline = "Axis 1."}});
  EXPECT_TRUE(has(page, "href=\"a.html\""));
  EXPECT_TRUE(has(page, "a&lt;b"));
  EXPECT_TRUE(has(page, "Axis 1."));
}

}  // namespace
}  // namespace teleop
