#pragma once

#include <functional>

namespace CLI {
class App;
}

namespace teleop {

/// What the chosen verb will do; set while the command line is read. It returns the exit code.
using Action = std::function<int()>;

/// Each adds one verb, or a few that belong together, to the command line of `teleop`.
void add_loopback(CLI::App& app, Action& action);
void add_workspace(CLI::App& app, Action& action);
void add_logs(CLI::App& app, Action& action);
void add_velocity(CLI::App& app, Action& action);
void add_reproduce(CLI::App& app, Action& action);
void add_effects(CLI::App& app, Action& action);
void add_run(CLI::App& app, Action& action);
void add_sweep(CLI::App& app, Action& action);
void add_bench(CLI::App& app, Action& action);
void add_diagnose(CLI::App& app, Action& action);
void add_predict(CLI::App& app, Action& action);
void add_blind(CLI::App& app, Action& action);
void add_tune(CLI::App& app, Action& action);
void add_frequency_response(CLI::App& app, Action& action);

}  // namespace teleop
