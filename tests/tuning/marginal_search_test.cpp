#include "core/tuning/marginal_search.hpp"

#include <vector>

#include <gtest/gtest.h>

namespace teleop {
namespace {

ProbeResult probe(double gain, double push_N, Verdict verdict) {
  ProbeResult result;
  result.plan = {.gain = gain, .push_N = push_N};
  result.verdict = verdict;
  result.outcome.rests = true;
  result.outcome.peak_swing_m = 1e-3;
  return result;
}

TEST(MarginalSearch, GoesLowerWhereEvenTheWeakestPushOvershoots) {
  const MarginalSearch search{{.experiment = GainExperiment::teleop}};
  std::vector<ProbeResult> probes{probe(3000.0, 0.5, Verdict::quiet),
                                  probe(9000.0, 1.0, Verdict::overshot)};
  const MarginalSearch::Step weaker = search.next(probes);
  ASSERT_TRUE(weaker.plan);
  EXPECT_EQ(weaker.plan.value_or(ProbePlan{}).gain, 9000.0);  // with less of a push

  probes.push_back(probe(9000.0, 0.01, Verdict::overshot));
  const MarginalSearch::Step lower = search.next(probes);
  ASSERT_TRUE(lower.plan);
  EXPECT_GT(lower.plan.value_or(ProbePlan{}).gain, 3000.0);
  EXPECT_LT(lower.plan.value_or(ProbePlan{}).gain, 9000.0);
}

TEST(MarginalSearch, SaysThatForceLimitsItWhereNoPushIsWeakEnoughJustAboveAStableGain) {
  const MarginalSearch search{{.experiment = GainExperiment::teleop}};
  const std::vector<ProbeResult> probes{probe(3000.0, 0.5, Verdict::quiet),
                                        probe(3100.0, 0.01, Verdict::overshot)};
  EXPECT_EQ(search.next(probes).end, SearchEnd::force_limited);
}

}  // namespace
}  // namespace teleop
