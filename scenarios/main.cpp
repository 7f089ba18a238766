#include <functional>
#include <string>

#include <CLI/CLI.hpp>

#include "core/base/error.hpp"
#include "core/base/version.hpp"
#include "core/program/command_line.hpp"
#include "scenarios/bench.hpp"
#include "scenarios/export.hpp"
#include "scenarios/loopback.hpp"
#include "scenarios/report.hpp"
#include "scenarios/workspace.hpp"

namespace {

using namespace teleop;  // NOLINT(google-build-using-namespace): this file only wires

/// What the chosen verb will do; set while the command line is read.
using Action = std::function<int()>;

void add_loopback(CLI::App& app, LoopbackOptions& options, Action& action) {
  CLI::App* verb =
      app.add_subcommand("loopback", "master and slave as two processes on this machine");
  verb->add_option("--seconds", options.seconds, "how long")
      ->check(CLI::Range(0.1, 86400.0))
      ->capture_default_str();
  verb->add_option("--master", options.master, "device of the master")->capture_default_str();
  verb->add_option("--slave", options.slave, "device of the slave")->capture_default_str();
  verb->add_option(
      "--hand", options.hand,
      "hand at the master: trace.csv (t_s,q_rad or t_s,x_m,y_m,z_m), reach, press or none; "
      "as fits the environment when not given");
  verb->add_option("--environment", options.environment, "at the slave: free, soft or wall")
      ->check(CLI::IsMember({"free", "soft", "wall"}))
      ->capture_default_str();
  verb->add_option("--out", options.out,
                   "folder for recordings and report; a new one when not given");
  verb->add_option("--json", options.json, "write the summary for scripts to this file");
  verb->add_option("--config", options.configs,
                   "TOML file for both sides; several: later ones win");
  verb->add_option("--set", options.settings,
                   "KEY=VALUE for both sides, as in --print-config of either");
  verb->add_option("--seed", options.seed, "of everything random")->capture_default_str();
  verb->add_flag("!--no-report", options.report, "write no report");
  verb->callback([&] {
    action = [&] {
      return run_loopback(options);
    };
  });
}

void add_workspace(CLI::App& app, WorkspaceOptions& options, Action& action) {
  CLI::App* verb =
      app.add_subcommand("workspace", "reach and manipulability of an arm, as picture and numbers");
  verb->add_option("--arm", options.arm, "arm file or the name of a shipped arm")
      ->capture_default_str();
  verb->add_option("--out", options.out, "folder for workspace.png, .csv and .json")
      ->capture_default_str();
  verb->add_option("--step-mm", options.step_mm, "grid")
      ->check(CLI::Range(0.5, 50.0))
      ->capture_default_str();
  verb->add_option("--json", options.json, "also write the numbers to this file");
  verb->callback([&] {
    action = [&] {
      return run_workspace(options);
    };
  });
}

struct FileOptions {
  std::vector<std::string> logs;
  std::string log;
  std::string out;
  std::string json;
};

void add_logs(CLI::App& app, FileOptions& files, Action& action) {
  CLI::App* report = app.add_subcommand("report", "one HTML page about one or two recordings");
  report->add_option("logs", files.logs, "recordings, master first")->required()->expected(1, 2);
  report->add_option("--out", files.out,
                     "the page; report.html beside the first recording when not given");
  report->add_option("--json", files.json, "also write the numbers to this file");
  report->callback([&] {
    action = [&] {
      return run_report(files.logs, files.out, files.json);
    };
  });

  CLI::App* table = app.add_subcommand("export", "a recording as a table");
  table->add_option("log", files.log, "the recording")->required();
  table->add_option("--csv", files.out, "file to write")->required();
  table->callback([&] {
    action = [&] {
      return run_export(files.log, files.out);
    };
  });

  CLI::App* recover = app.add_subcommand("recover", "close a recording that was cut off");
  recover->add_option("log", files.log, "the recording")->required();
  recover->add_option("--out", files.out, "file to write; LOG.recovered.mcap when not given");
  recover->callback([&] {
    action = [&] {
      return run_recover(files.log, files.out);
    };
  });
}

void add_bench(CLI::App& app, BenchOptions& options, Action& action) {
  CLI::App* bench = app.add_subcommand("bench", "measure beside a peer or a limit, in one run");
  bench->require_subcommand(1);
  const auto add = [&](const char* name, const char* text, auto run) {
    CLI::App* kind = bench->add_subcommand(name, text);
    kind->add_option("--seconds", options.seconds, "about how long")
        ->check(CLI::Range(0.5, 3600.0))
        ->capture_default_str();
    kind->add_option("--json", options.json, "write the rows to this file");
    kind->callback([&action, &options, run] {
      action = [&options, run] {
        return run(options);
      };
    });
  };
  add("link", "UDP round trip through the whole stack, against a bare socket", bench_link);
  add("loop", "lateness of the loop, against cyclictest", bench_loop);
  add("sim", "simulated pair on simulated time, against real time", bench_sim);
}

int run(int argc, char** argv) {
  CLI::App app{"teleop: bilateral teleoperation for PHANToM haptic arms"};
  app.set_version_flag("--version", std::string{kVersion});
  app.footer("The two sides as processes of their own: teleop-master --help, teleop-slave --help.");
  LoopbackOptions loopback;
  WorkspaceOptions workspace;
  FileOptions files;
  BenchOptions bench;
  Action action;
  add_loopback(app, loopback, action);
  add_workspace(app, workspace, action);
  add_logs(app, files, action);
  add_bench(app, bench, action);
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& done) {
    return app.exit(done);
  } catch (const CLI::ParseError& error) {
    throw ConfigError{std::string{error.what()} + "; --help lists what there is"};
  }
  if (!action) {
    throw ConfigError{"say what to do, for example: teleop loopback; --help lists what there is"};
  }
  return action();
}

}  // namespace

int main(int argc, char** argv) { return teleop::run_program("teleop", run, argc, argv); }
