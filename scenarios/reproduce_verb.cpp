#include <memory>

#include <CLI/CLI.hpp>

#include "scenarios/reproduce.hpp"
#include "scenarios/verbs.hpp"

namespace teleop {

void add_reproduce(CLI::App& app, Action& action) {
  const auto options = std::make_shared<ReproduceOptions>();
  CLI::App* verb =
      app.add_subcommand("reproduce", "the table of the 2002 paper: what fits, what is predicted");
  verb->add_flag("--fit", options->fit,
                 "first move the fitted parameters within their bounds to where all rows fit best");
  verb->add_flag("--quick", options->quick, "analysis instead of simulated experiments");
  verb->add_option("--row", options->rows, "only this row; several times for several")
      ->check([](const std::string& id) {
        for (const PaperRowId row : kPaperRows) {
          if (id == text_of(row).id) return std::string{};
        }
        return "there is no row " + id;
      });
  verb->add_option("--json", options->json, "also write rows and parameters to this file");
  verb->callback([options, &action] {
    action = [options] {
      return run_reproduce(*options);
    };
  });
}

}  // namespace teleop
