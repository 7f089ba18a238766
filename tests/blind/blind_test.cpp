#include "scenarios/blind.hpp"

#include <filesystem>
#include <fstream>
#include <memory>
#include <sstream>
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/base/error.hpp"
#include "scenarios/blind_store.hpp"
#include "scenarios/child.hpp"
#include "scenarios/concealed/seal.hpp"
#include "tests/support/command.hpp"
#include "tests/support/temporary_folder.hpp"

namespace teleop {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::TemporaryFolder;

constexpr const char* kSilent =
    "#!/bin/sh\n"
    "echo '{\"verdict\": \"adequate\", \"effects\": [], \"mismatch\": {\"axes\": [], \"channel\": "
    "\"none\"}}' > \"$4\"\n";

std::string contents(const fs::path& file) {
  std::ifstream in{file, std::ios::binary};
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

void write(const fs::path& file, const std::string& text) {
  std::ofstream{file, std::ios::binary} << text;
}

std::string tables(const fs::path& folder) {
  return contents(folder / "cases.jsonl") + contents(folder / "seals.txt");
}

/// A folder, a program that stands for the diagnosis, and options for a few nulls.
class BlindCampaign : public ::testing::Test {
 protected:
  static void TearDownTestSuite() { done_.reset(); }

  /// The folder of a whole campaign, done when it is first asked for.
  [[nodiscard]] static fs::path whole() {
    if (!done_) {
      done_ = std::make_unique<TemporaryFolder>();
      EXPECT_EQ(run_blind(options_in(*done_, "whole", kSilent)), 0);
    }
    return done_->path() / "whole";
  }
  [[nodiscard]] BlindOptions options(const std::string& out, const std::string& script = kSilent) {
    return options_in(folder_, out, script);
  }
  [[nodiscard]] fs::path at(const std::string& name) const { return folder_.path() / name; }

 private:
  static BlindOptions options_in(const TemporaryFolder& folder,
                                 const std::string& out,
                                 const std::string& script) {
    const fs::path program = folder.write("diagnose.sh", script);
    fs::permissions(program, fs::perms::owner_all);
    BlindOptions options;
    options.plan = {.cases = 2, .nulls = true, .seed = 8};
    options.out = (folder.path() / out).string();
    options.json = (folder.path() / (out + ".json")).string();
    options.diagnose = program.string();
    return options;
  }

  static inline std::unique_ptr<TemporaryFolder> done_{};
  TemporaryFolder folder_;
};

TEST_F(BlindCampaign, WritesItsFiguresByTheirAgreedNames) {
  const json figures = json::parse(contents(whole() += ".json"));
  EXPECT_EQ(figures.at("seed"), 8);
  EXPECT_EQ(figures.at("cases"), 2);
  EXPECT_EQ(figures.at("nulls").at("n"), 2);
  EXPECT_EQ(figures.at("nulls").at("false"), 0);
  EXPECT_EQ(figures.at("sealed_sha256"), concealed::seal({.cases = 2, .nulls = true, .seed = 8}));
  for (const char* name : {"bands", "pairs", "out_of_vocabulary", "parameter_error", "coverage_90",
                           "held_out_over_true", "ece", "regression"}) {
    EXPECT_TRUE(figures.contains(name)) << name;
  }
}

TEST_F(BlindCampaign, LosesAndRepeatsNoCaseWhenItIsCutShortAnywhere) {
  const std::string lines = contents(whole() / "cases.jsonl");
  const std::size_t first_end = lines.find('\n') + 1;
  fs::copy(whole(), at("cut"), fs::copy_options::recursive);
  for (const std::size_t kept : {first_end + 100, lines.size() - 1}) {
    write(at("cut") / "cases.jsonl", lines.substr(0, kept));
    // Which cases are done again is told apart from which are taken over.
    const std::string other = std::string{kSilent} + "touch \"$2.again\"\n";
    ASSERT_EQ(run_blind(options("cut", other)), 0);
    EXPECT_EQ(tables(at("cut")), tables(whole()));
  }
  EXPECT_FALSE(fs::exists(at("cut") / "cases" / "case-0001.again"));
  EXPECT_TRUE(fs::exists(at("cut") / "cases" / "case-0002.again"));
  EXPECT_FALSE(fs::exists(at("cut") / "cases" / "case-0002")) << "recordings are not kept";
}

TEST_F(BlindCampaign, GivesTheSameBytesInShards) {
  BlindOptions merge;
  merge.out = at("merged").string();
  for (const std::string i : {"1", "2"}) {
    BlindOptions shard = options("shard-" + i);
    shard.shard = i + "/2";
    merge.shards.push_back(shard.out);
    ASSERT_EQ(run_blind(shard), 0);
    if (i == "1") {
      EXPECT_THROW((void)merge_blind(merge), ConfigError) << "a case is missing";
    }
  }
  ASSERT_EQ(merge_blind(merge), 0);
  EXPECT_EQ(tables(at("merged")), tables(whole()));
}

TEST_F(BlindCampaign, NoticesATruthOrASealThatWasChanged) {
  const std::string lines = contents(whole() / "cases.jsonl");
  const std::string seals = contents(whole() / "seals.txt");
  fs::copy(whole(), at("out"), fs::copy_options::recursive);

  std::string other = lines;
  const std::size_t number = other.find("\"encoder_noise_counts\":") + 23;
  other[number] = other[number] == '1' ? '2' : '1';
  write(at("out") / "cases.jsonl", other);
  EXPECT_THROW((void)run_blind(options("out")), ConfigError);
  write(at("out") / "cases.jsonl", lines);

  other = seals;
  other[15] = other[15] == '0' ? '1' : '0';
  write(at("out") / "seals.txt", other);
  EXPECT_THROW((void)run_blind(options("out")), ConfigError);
  // Nor does a case pass that is drawn under another's seal.
  const std::string last = lines.substr(lines.find('\n') + 1);
  write(at("out") / "cases.jsonl", last);
  EXPECT_THROW((void)run_blind(options("out")), Error);
  EXPECT_EQ(contents(at("out") / "cases.jsonl"), last);
}

TEST_F(BlindCampaign, PublishesTheSealAndHasNoTruthOnDiskWhileTheDiagnosisRuns) {
  const std::string spy = std::string{kSilent} +
                          "cp \"$2/../../seals.txt\" \"$2/../seals-seen\"\n"
                          "grep -rl disturbance \"$2/../..\" > \"$2/../truth-seen\"\n"
                          "ls \"$2\" > \"$2/../files-seen\"\n";
  BlindOptions one = options("out", spy);
  one.plan.cases = 1;
  one.keep = true;
  ASSERT_EQ(run_blind(one), 0);
  const fs::path cases = at("out") / "cases";
  EXPECT_EQ(contents(cases / "seals-seen"), contents(at("out") / "seals.txt"));
  EXPECT_NE(contents(cases / "seals-seen").find("case-0001 "), std::string::npos);
  EXPECT_EQ(contents(cases / "truth-seen"), "");
  EXPECT_EQ(contents(cases / "files-seen"),
            "answer.json\ncase.toml\nrun-01.csv\nrun-02.csv\nrun-03.csv\nrun-04.csv\nrun-05.csv\n");
  EXPECT_TRUE(fs::exists(cases / "case-0001" / "run-05.csv")) << "kept as asked";
}

TEST_F(BlindCampaign, CountsADiagnosisThatFailsAsWrong) {
  BlindOptions one = options("out", "#!/bin/sh\necho 'no idea' >&2\nexit 3\n");
  one.plan.cases = 1;
  EXPECT_EQ(run_blind(one), 0);
  const json figures = json::parse(contents(at("out.json")));
  EXPECT_EQ(figures.at("missing"), 1);
  EXPECT_EQ(figures.at("nulls").at("false"), 1);
  EXPECT_EQ(figures.at("missed").at(0).at("answer"), "exit code 3: no idea");
}

TEST_F(BlindCampaign, RefusesAFolderOfAnotherCampaignAndAShardThatIsNone) {
  BlindOptions one = options("out");
  one.plan.cases = 1;
  {
    const BlindStore store{one.out, one.plan};
  }
  one.plan.seed = 9;
  EXPECT_THROW((void)run_blind(one), ConfigError);
  one.shard = "3/2";
  EXPECT_THROW((void)run_blind(one), ConfigError);
}

TEST(BlindProgram, EndsAtOnceWhenAskedToAndKeepsNoHalfCase) {
  const TemporaryFolder folder;
  const fs::path slow = folder.write("slow.sh", "#!/bin/sh\nexec sleep 60\n");
  fs::permissions(slow, fs::perms::owner_all);
  const fs::path out = folder.path() / "out";
  Child blind{"blind",
              {sibling_program("teleop"), "blind", "--nulls", "1", "--out", out.string(),
               "--diagnose", slow.string()},
              (folder.path() / "stderr").string()};
  while (!blind.exit_code() && contents(out / "seals.txt").empty()) {
    (void)blind.next_line(5);
  }
  blind.ask_to_end();
  EXPECT_EQ(blind.end(20'000), 1);
  EXPECT_EQ(contents(out / "cases.jsonl"), "");
  EXPECT_NE(contents(folder.path() / "stderr").find("1 cases are missing"), std::string::npos);
}

TEST(BlindProgram, KeepsSilentOnANullByTheRealDiagnosis) {
  const TemporaryFolder folder;
  const std::string json_file = (folder.path() / "figures.json").string();
  const testing::Finished done =
      testing::run("teleop blind --nulls 1 --seed 21 --markdown --out " +
                   (folder.path() / "out").string() + " --json " + json_file);
  ASSERT_EQ(done.exit_code, 0) << done.output;
  EXPECT_NE(done.output.find("| no effect: false discovery"), std::string::npos) << done.output;
  EXPECT_EQ(json::parse(contents(json_file)).at("missing"), 0) << done.output;
}

}  // namespace
}  // namespace teleop
