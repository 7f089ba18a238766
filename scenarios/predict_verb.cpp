#include <memory>

#include <CLI/CLI.hpp>

#include "scenarios/predict.hpp"
#include "scenarios/verbs.hpp"

namespace teleop {

void add_predict(CLI::App& app, Action& action) {
  const auto options = std::make_shared<PredictOptions>();
  CLI::App* verb = app.add_subcommand(
      "predict", "how well a model predicts recordings: the judge of whether a fit improved");
  verb->add_option("--model,--plant", options->model,
                   "plant file, such as diagnose --corrected writes, or a shipped plant")
      ->capture_default_str();
  verb->add_option("runs", options->runs, "recordings (CSV), each with its case.toml beside it")
      ->required();
  verb->add_option("--json", options->json, "also write the numbers to this file");
  verb->callback([options, &action] {
    action = [options] {
      return run_predict(*options);
    };
  });
}

}  // namespace teleop
