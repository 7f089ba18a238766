#include <memory>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "scenarios/export.hpp"
#include "scenarios/report.hpp"
#include "scenarios/verbs.hpp"

namespace teleop {

namespace {

struct FileOptions {
  std::vector<std::string> logs;
  std::string log;
  std::string out;
  std::string json;
};

}  // namespace

void add_logs(CLI::App& app, Action& action) {
  const auto files = std::make_shared<FileOptions>();
  CLI::App* report = app.add_subcommand("report", "one HTML page about one or two recordings");
  report->add_option("logs", files->logs, "recordings, master first")->required()->expected(1, 2);
  report->add_option("--out", files->out,
                     "the page; report.html beside the first recording when not given");
  report->add_option("--json", files->json, "also write the numbers to this file");
  report->callback([files, &action] {
    action = [files] {
      return run_report(files->logs, files->out, files->json);
    };
  });

  CLI::App* table = app.add_subcommand("export", "a recording as a table");
  table->add_option("log", files->log, "the recording")->required();
  table->add_option("--csv", files->out, "file to write")->required();
  table->add_option("--json", files->json, "also write what was done to this file");
  table->callback([files, &action] {
    action = [files] {
      return run_export(files->log, files->out, files->json);
    };
  });

  CLI::App* recover = app.add_subcommand("recover", "close a recording that was cut off");
  recover->add_option("log", files->log, "the recording")->required();
  recover->add_option("--out", files->out, "file to write; LOG.recovered.mcap when not given");
  recover->add_option("--json", files->json, "also write what was kept and lost to this file");
  recover->callback([files, &action] {
    action = [files] {
      return run_recover(files->log, files->out, files->json);
    };
  });
}

}  // namespace teleop
