#include <memory>

#include <CLI/CLI.hpp>

#include "scenarios/effects.hpp"
#include "scenarios/verbs.hpp"

namespace teleop {

void add_effects(CLI::App& app, Action& action) {
  const auto options = std::make_shared<EffectsOptions>();
  CLI::App* verb =
      app.add_subcommand("effects", "what plant files may contain: laws and parameters");
  verb->add_option("kind", options->kind, "only this one");
  verb->add_flag("--markdown", options->markdown, "as a page of the documentation");
  verb->add_option("--json", options->json, "also write the vocabulary to this file");
  verb->callback([options, &action] {
    action = [options] {
      return run_effects(*options);
    };
  });
}

}  // namespace teleop
