#include <string>

#include <CLI/CLI.hpp>

#include "core/base/error.hpp"
#include "core/base/version.hpp"
#include "core/program/command_line.hpp"
#include "scenarios/verbs.hpp"

namespace {

using namespace teleop;  // NOLINT(google-build-using-namespace): this file only wires

int run(int argc, char** argv) {
  CLI::App app{"teleop: bilateral teleoperation for PHANToM haptic arms"};
  app.set_version_flag("--version", std::string{kVersion});
  app.footer("The two sides as processes of their own: teleop-master --help, teleop-slave --help.");
  Action action;
  for (const auto add : {add_loopback, add_workspace, add_logs, add_velocity, add_reproduce,
                         add_effects, add_tune, add_diagnose, add_predict, add_blind,
                         add_frequency_response, add_run, add_sweep, add_bench}) {
    add(app, action);
  }
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
