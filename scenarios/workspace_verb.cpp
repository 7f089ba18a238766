#include <memory>

#include <CLI/CLI.hpp>

#include "scenarios/verbs.hpp"
#include "scenarios/workspace.hpp"

namespace teleop {

void add_workspace(CLI::App& app, Action& action) {
  const auto options = std::make_shared<WorkspaceOptions>();
  CLI::App* verb =
      app.add_subcommand("workspace", "reach and manipulability of an arm, as picture and numbers");
  verb->add_option("--arm", options->arm, "arm file or the name of a shipped arm")
      ->capture_default_str();
  verb->add_option("--out", options->out, "folder for workspace.png, .csv and .json")
      ->capture_default_str();
  verb->add_option("--step-mm", options->step_mm, "grid")
      ->check(CLI::Range(0.5, 50.0))
      ->capture_default_str();
  verb->add_option("--json", options->json, "also write the numbers to this file");
  verb->callback([options, &action] {
    action = [options] {
      return run_workspace(*options);
    };
  });
}

}  // namespace teleop
