#include "core/experiment/sweep.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "core/base/error.hpp"
#include "tests/support/temporary_folder.hpp"

namespace teleop {
namespace {

namespace fs = std::filesystem;
using testing::TemporaryFolder;

const std::string kWall =
    "experiment = \"virtual_wall\"\nseed = 5\n[run]\nseconds = 1.0\n"
    "[sweep]\n";

const std::string kGrid = kWall +
                          "[[sweep.axis]]\nkey = \"run.stiffness_N_per_m\"\n"
                          "from = 500\nto = 2000\npoints = 4\n"
                          "[[sweep.axis]]\nkey = \"run.axis\"\nvalues = [\"x\", \"y\", \"z\"]\n";

ScenarioText text_of(const std::string& toml) { return {.toml = toml, .file = "s.toml"}; }

std::string refusal(const std::string& toml) {
  try {
    const SweepPlan plan{text_of(toml)};
  } catch (const ConfigError& error) {
    return error.what();
  }
  return "";
}

std::string contents(const fs::path& file) {
  std::ifstream in{file, std::ios::binary};
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

/// Both tables of a finished sweep.
std::string tables(const fs::path& folder) {
  return contents(folder / "results.jsonl") + contents(folder / "results.csv");
}

bool sweep_into(const fs::path& folder,
                const SweepPlan& plan,
                unsigned jobs,
                const SweepShard& shard = {}) {
  SweepStore store{folder, plan, shard};
  return run_sweep(plan, store, jobs, {});
}

TEST(SweepPlan, OfAGridHasEveryCombinationTheLastAxisFastest) {
  const SweepPlan plan{text_of(kGrid)};
  ASSERT_EQ(plan.size(), 12U);
  EXPECT_EQ(plan.value(0, 0).toml, "500");
  EXPECT_EQ(plan.value(1, 0).toml, "x");
  EXPECT_EQ(plan.value(1, 1).toml, "y");
  EXPECT_EQ(plan.value(0, 3).toml, "1000");
  EXPECT_EQ(plan.value(0, 11).toml, "2000");
  EXPECT_EQ(plan.value(1, 11).json, "\"z\"");
}

TEST(SweepPlan, OfAListZipsTheAxes) {
  const SweepPlan plan{
      text_of(kWall + "method = \"list\"\n[[sweep.axis]]\nkey = \"run.stiffness_N_per_m\"\n"
                      "values = [500, 600]\n[[sweep.axis]]\nkey = \"run.press_N\"\n"
                      "values = [1.0, 2.5]\n")};
  ASSERT_EQ(plan.size(), 2U);
  EXPECT_EQ(plan.value(0, 1).toml, "600");
  EXPECT_EQ(plan.value(1, 1).toml, "2.5");
}

TEST(SweepPlan, OfALatinHypercubeMeetsEveryStratumOfEveryAxisOnce) {
  for (int seed = 1; seed <= 20; ++seed) {
    const std::string own =
        "method = \"latin_hypercube\"\npoints = 16\nseed = " + std::to_string(seed) + "\n";
    const SweepPlan plan{text_of(
        kWall + own +
        "[[sweep.axis]]\nkey = \"run.stiffness_N_per_m\"\nfrom = 0\nto = 1600\n"
        "[[sweep.axis]]\nkey = \"run.press_N\"\nfrom = 0.1\nto = 6.4\nspacing = \"log\"\n")};
    ASSERT_EQ(plan.size(), 16U);
    std::set<int> linear;
    std::set<int> logarithmic;
    for (std::size_t i = 0; i < 16; ++i) {
      linear.insert(static_cast<int>(std::stod(plan.value(0, i).toml) / 100.0));
      logarithmic.insert(static_cast<int>(16.0 * std::log(std::stod(plan.value(1, i).toml) / 0.1) /
                                          std::log(64.0)));
    }
    EXPECT_EQ(linear.size(), 16U) << seed;
    EXPECT_EQ(logarithmic.size(), 16U) << seed;
  }
}

TEST(SweepPlan, MovesTiedKeysTogetherAndSpreadsLogarithmically) {
  const SweepPlan plan{
      text_of("experiment = \"teleop\"\n[sweep]\n[[sweep.axis]]\n"
              "keys = [\"law.stiffness_master_N_per_m\", \"law.stiffness_slave_N_per_m\"]\n"
              "from = 100\nto = 1600\npoints = 5\nspacing = \"log\"\n")};
  EXPECT_EQ(plan.value(0, 2).toml, "400");
  const std::vector<Override> overrides = plan.overrides(2);
  ASSERT_EQ(overrides.size(), 3U);  // the seed first
  EXPECT_EQ(overrides[1].value, overrides[2].value);
}

TEST(SweepPlan, GivesEveryPointASeedOfItsOwnThatDependsOnTheScenariosSeed) {
  const SweepPlan plan{text_of(kGrid)};
  const SweepPlan other{text_of("seed = 6\n" + kGrid.substr(kGrid.find("experiment"), 28) +
                                kGrid.substr(kGrid.find("[run]")))};
  std::set<std::uint64_t> seeds;
  for (std::size_t i = 0; i < plan.size(); ++i) {
    seeds.insert(plan.seed(i));
    seeds.insert(other.seed(i));
  }
  EXPECT_EQ(seeds.size(), 2 * plan.size());
  EXPECT_NE(plan.fingerprint(), other.fingerprint());
}

TEST(SweepPlan, SweepsEffectsPlantsAndExperiments) {
  const SweepPlan plan{
      text_of("experiment = \"virtual_wall\"\n[sweep]\nmethod = \"list\"\n"
              "[[sweep.axis]]\nkey = \"plant.effect.viscous_friction.2.coefficient\"\n"
              "values = [0.01, 0.05]\n")};
  const Scenario second{plan.text(), plan.overrides(1)};
  EXPECT_EQ(second.plant().effects[1].parameters.at("coefficient"), 0.05);
  EXPECT_EQ(refusal("experiment = \"virtual_wall\"\n[sweep]\n[[sweep.axis]]\nkey = \"plant\"\n"
                    "values = [\"phantom-1.5\", \"phantom-1.5-bare\"]\n"),
            "");
}

struct Bad {
  const char* what;
  std::string sweep;
  std::vector<std::string> names;
};

TEST(SweepPlan, RefusesWhatCannotBeSweptBeforeAnythingRuns) {
  const std::string axis = "[[sweep.axis]]\n";
  const std::string key = axis + "key = \"run.stiffness_N_per_m\"\n";
  const std::vector<Bad> table{
      {"no axis", "", {"s.toml:5", "[[sweep.axis]]"}},
      {"no key", axis + "values = [1]\n", {"s.toml:6", "key"}},
      {"unknown key",
       axis + "key = \"run.stifness\"\nvalues = [1]\n",
       {"s.toml:6", "run.stifness", "unknown key"}},
      {"empty list", key + "values = []\n", {"s.toml:8", "empty"}},
      {"empty range", key + "from = 5\nto = 5\npoints = 3\n", {"s.toml:9", "no room"}},
      {"range upside down", key + "from = 5\nto = 1\npoints = 3\n", {"s.toml:9", "below"}},
      {"range without points", key + "from = 1\nto = 5\n", {"s.toml:6", "points"}},
      {"one point", key + "from = 1\nto = 5\npoints = 1\n", {"s.toml:10", "from 2"}},
      {"logarithm of 0",
       key + "from = 0\nto = 5\npoints = 3\nspacing = \"log\"\n",
       {"s.toml:8", "more than 0"}},
      {"both", key + "values = [1]\npoints = 2\n", {"s.toml:9", "exclude"}},
      {"wrong type", key + "values = [1, \"stiff\"]\n", {"s.toml:6", "run.stiffness_N_per_m"}},
      {"out of range",
       key + "from = -10\nto = 10\npoints = 3\n",
       {"s.toml:6", "run.stiffness_N_per_m", "0 or more"}},
      {"axis that the arm has not",
       axis + "key = \"run.axis\"\nvalues = [\"x\", \"w\"]\n",
       {"s.toml:6", "run.axis", "no such axis"}},
      {"effect that the plant has not",
       axis + "key = \"plant.effect.coulomb_friction_2.1.level\"\nvalues = [1]\n",
       {"s.toml:6", "coulomb_friction_2"}},
      {"unstable integrator",
       axis + "key = \"plant.effect.viscous_friction.1.coefficient\"\n" + "values = [0.1, 50.0]\n",
       {"integration.max_step_ms", "unstable"}},
      {"swept twice", key + "values = [1]\n" + key + "values = [1]\n", {"s.toml:9", "twice"}},
      {"unknown method",
       "method = \"guess\"\n" + key + "values = [1]\n",
       {"s.toml:6", "grid, list, latin_hypercube"}},
      {"unknown key of the sweep",
       "metod = \"grid\"\n" + key + "values = [1]\n",
       {"s.toml:6", "sweep.metod", "method"}},
      {"hypercube without points",
       "method = \"latin_hypercube\"\n" + key + "from = 1\nto = 2\n",
       {"s.toml:5", "points"}},
      {"lists of two lengths",
       "method = \"list\"\n" + key + "values = [1, 2]\n" + axis +
           "key = \"run.press_N\"\nvalues = [1]\n",
       {"s.toml:10", "1 values", "has 2"}},
      {"fraction of a whole number",
       axis + "key = \"seed\"\nvalues = [1.5]\n",
       {"s.toml:6", "seed", "whole"}},
  };
  for (const Bad& bad : table) {
    const std::string line = refusal(kWall + bad.sweep);
    EXPECT_FALSE(line.empty()) << bad.what << ": was accepted";
    EXPECT_EQ(line.find('\n'), std::string::npos) << bad.what << ": " << line;
    for (const std::string& name : bad.names) {
      EXPECT_NE(line.find(name), std::string::npos)
          << bad.what << " names not '" << name << "': " << line;
    }
  }
}

TEST(Sweep, GivesTheSameBytesWithAnyNumberOfJobs) {
  const TemporaryFolder folder;
  const SweepPlan plan{text_of(kGrid)};
  ASSERT_TRUE(sweep_into(folder.path() / "1", plan, 1));
  ASSERT_TRUE(sweep_into(folder.path() / "3", plan, 3));
  const std::string one = tables(folder.path() / "1");
  EXPECT_EQ(one, tables(folder.path() / "3"));
  EXPECT_NE(one.find("\"run.axis\":\"z\""), std::string::npos);
}

TEST(Sweep, ShardsAndTheirMergeGiveTheBytesOfASingleRun) {
  const TemporaryFolder folder;
  const SweepPlan plan{text_of(kGrid)};
  ASSERT_TRUE(sweep_into(folder.path() / "whole", plan, 2));
  for (std::size_t i = 1; i <= 5; ++i) {
    ASSERT_TRUE(sweep_into(folder.path() / std::to_string(i), plan, 1, {.i = i, .n = 5}));
  }
  SweepStore merged{folder.path() / "merged", plan, {}};
  for (int i = 5; i >= 1; --i) {
    merged.take(folder.path() / std::to_string(i));
  }
  EXPECT_TRUE(merged.missing().empty());
  merged.sort();
  EXPECT_EQ(tables(folder.path() / "whole"), tables(folder.path() / "merged"));
}

TEST(Sweep, GoesOnWhereItWasLeftAndCutsATornLine) {
  const TemporaryFolder folder;
  const SweepPlan plan{text_of(kGrid)};
  ASSERT_TRUE(sweep_into(folder.path() / "whole", plan, 1));
  const std::string whole = contents(folder.path() / "whole" / "results.jsonl");
  for (const std::size_t length : {whole.size() / 3, whole.size() / 2, whole.size() - 1}) {
    const fs::path torn = folder.path() / std::to_string(length);
    {
      const SweepStore begun{torn, plan, {}};
    }
    std::ofstream{torn / "results.jsonl", std::ios::binary} << whole.substr(0, length);
    SweepStore store{torn, plan, {}};
    const auto lines = std::count(whole.begin(), whole.begin() + static_cast<long>(length), '\n');
    EXPECT_EQ(store.missing().size(), plan.size() - static_cast<std::size_t>(lines));
    const std::string kept = contents(torn / "results.jsonl");
    EXPECT_EQ(std::count(kept.begin(), kept.end(), '\n'), lines);
    EXPECT_TRUE(kept.empty() || kept.back() == '\n') << "the torn end is still there";
    std::size_t ran = 0;
    const SweepControl control{.progress = [&ran](std::size_t, std::size_t) {
      ++ran;
    }};
    ASSERT_TRUE(run_sweep(plan, store, 2, control));
    EXPECT_EQ(ran, plan.size() - static_cast<std::size_t>(lines));
    EXPECT_EQ(tables(torn), tables(folder.path() / "whole"));
  }
}

TEST(SweepStore, RefusesAnotherSweepsFolderADamagedOneAndOneInUse) {
  const TemporaryFolder folder;
  const SweepPlan plan{text_of(kGrid)};
  const SweepPlan other{text_of(kGrid + "# changed\n")};
  {
    const SweepStore store{folder.path(), plan, {}};
    EXPECT_THROW((SweepStore{folder.path(), plan, {}}), ConfigError) << "in use";
  }
  EXPECT_THROW((SweepStore{folder.path(), other, {}}), ConfigError) << "another sweep";
  EXPECT_THROW((SweepStore{folder.path(), plan, {.i = 1, .n = 2}}), ConfigError) << "another shard";
  std::ofstream{folder.path() / "results.jsonl"} << "nonsense\n{}\n";
  try {
    const SweepStore store{folder.path(), plan, {}};
    FAIL() << "damaged";
  } catch (const ConfigError& error) {
    EXPECT_NE(std::string{error.what()}.find("results.jsonl:1"), std::string::npos) << error.what();
  }
}

TEST(Sweep, KeepsWhatIsFinishedWhenItIsStopped) {
  const TemporaryFolder folder;
  const SweepPlan plan{text_of(kGrid)};
  std::atomic<bool> stop{false};
  {
    SweepStore store{folder.path(), plan, {}};
    const SweepControl control{.stop = &stop, .progress = [&stop](std::size_t done, std::size_t) {
                                 if (done == 3) stop = true;
                               }};
    EXPECT_FALSE(run_sweep(plan, store, 1, control));
    EXPECT_EQ(store.lines().size(), 3U);
  }
  const SweepStore again{folder.path(), plan, {}};
  EXPECT_EQ(again.missing().size(), plan.size() - 3);
}

}  // namespace
}  // namespace teleop
