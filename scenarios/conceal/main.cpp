#include <filesystem>
#include <string>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "core/base/error.hpp"
#include "core/base/version.hpp"
#include "core/program/command_line.hpp"
#include "scenarios/concealed/concealed_case.hpp"
#include "scenarios/concealed/seal.hpp"

namespace {

using namespace teleop;  // NOLINT(google-build-using-namespace): this file only wires
using concealed::ConcealedPlan;

struct Options {
  ConcealedPlan plan{};
  std::filesystem::path out{};
  std::filesystem::path truth{};  ///< empty: it stays unwritten
  std::string shard = "1/1";
};

void read_shard(const std::string& text, ConcealedPlan& plan) {
  std::size_t i = 0;
  std::size_t n = 0;
  const std::size_t slash = text.find('/');
  if (CLI::detail::lexical_cast(text.substr(0, slash), i) && slash != std::string::npos &&
      CLI::detail::lexical_cast(text.substr(slash + 1), n) && 1 <= i && i <= n) {
    plan.shard = i - 1;
    plan.shards = n;
    return;
  }
  throw ConfigError{"--shard " + text + ": give i/N with 1 <= i <= N"};
}

int conceal(const Options& options) {
  concealed::Seal seal;
  for (std::size_t index = 0; index < options.plan.cases; ++index) {
    if (!options.plan.takes(index)) continue;
    const concealed::ConcealedCase drawn = concealed::draw_case(options.plan, index);
    concealed::write_case(drawn, options.out);
    if (!options.truth.empty()) concealed::write_truth(drawn, options.truth);
    seal.add(concealed::truth_json(drawn));
    fmt::print(stderr, "\r{}", drawn.name);
  }
  fmt::print(stderr, "\n");
  fmt::print("{}\n", seal.digits());
  return 0;
}

int run(int argc, char** argv) {
  CLI::App app{
      "teleop_conceal: recordings of devices whose physics is concealed, and the SHA-256 of their "
      "truth"};
  app.set_version_flag("--version", std::string{kVersion});
  Options options;
  app.add_option("--cases", options.plan.cases, "how many cases of every group")
      ->check(CLI::Range(1, 9999));
  auto* const nulls =
      app.add_option("--nulls", "how many devices without effects, instead of --cases");
  nulls->check(CLI::Range(1, 9999))->excludes("--cases");
  app.add_option("--seed", options.plan.seed, "decides everything");
  app.add_option("--shard", options.shard, "i/N: every Nth case, from the i-th on");
  app.add_option("--out", options.out, "folder for the cases")->required();
  app.add_option("--truth", options.truth,
                 "folder for the truth and the run held back; without it they stay unwritten");
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& done) {
    return app.exit(done);
  } catch (const CLI::ParseError& error) {
    throw ConfigError{std::string{error.what()} + "; --help lists what there is"};
  }
  if (nulls->count() > 0) {
    options.plan.nulls = true;
    options.plan.cases = nulls->as<std::size_t>();
  }
  read_shard(options.shard, options.plan);
  return conceal(options);
}

}  // namespace

int main(int argc, char** argv) { return teleop::run_program("teleop_conceal", run, argc, argv); }
