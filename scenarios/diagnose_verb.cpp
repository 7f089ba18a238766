#include <memory>

#include <CLI/CLI.hpp>

#include "scenarios/diagnose.hpp"
#include "scenarios/verbs.hpp"

namespace teleop {

void add_diagnose(CLI::App& app, Action& action) {
  const auto options = std::make_shared<DiagnoseOptions>();
  CLI::App* verb = app.add_subcommand(
      "diagnose", "what physics does the model leave out? Names it, estimates it, proves it");
  verb->add_option("cases", options->cases,
                   "case folders (case.toml and its runs), case files, or our own logs of one arm")
      ->required();
  verb->add_option("--data", options->data, "folder of the recordings, if not beside the case");
  verb->add_option("--json", options->json, "the answer, of a single case");
  verb->add_option("--json-dir", options->json_dir, "folder for an answer a case, NAME.json");
  verb->add_option("--report", options->report,
                   "page about a single case in plain words and pictures, FILE.html");
  verb->add_option("--report-dir", options->report_dir,
                   "folder for a page a case, NAME.html, and index.html that leads to them");
  verb->add_option("--next", options->next,
                   "scenario of the experiment that tells most next; teleop run executes it");
  verb->add_option("--corrected", options->corrected,
                   "plant file of a single case: the nominal arm with what was found");
  verb->add_option("--threads", options->threads, "0: one a core; the answer is the same")
      ->check(CLI::Range(0, 64))
      ->capture_default_str();
  verb->callback([options, &action] {
    action = [options] {
      return run_diagnose(*options);
    };
  });
}

}  // namespace teleop
