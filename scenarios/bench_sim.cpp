#include <chrono>

#include "core/effects/contact.hpp"
#include "core/simulation/pair.hpp"
#include "scenarios/bench.hpp"

namespace teleop {

namespace {

using WallClock = std::chrono::steady_clock;

/// Simulated seconds a second of a pair of arms with their stations, a hand that presses and a
/// wall.
double realtime_factor(const char* plant_name, double seconds) {
  const PlantSpec plant = load_plant(plant_name);
  SimulatedPair pair{{.master = {.plant = plant, .hand = "press"},
                      .slave = {.plant = plant, .contact = environment("wall")}}};
  constexpr int kTurns = 100;
  constexpr double kTurn_s = 1e-3;
  const auto begin = WallClock::now();
  double simulated_s = 0.0;
  double wall_s = 0.0;
  while (wall_s < seconds) {
    for (int i = 0; i < kTurns; ++i) {
      pair.step();
    }
    simulated_s += kTurns * kTurn_s;
    wall_s = std::chrono::duration<double>(WallClock::now() - begin).count();
  }
  return simulated_s / wall_s;
}

BenchRow row(const char* id, double factor) {
  return {.id = id,
          .ours = factor,
          .peer = 1.0,
          .peer_name = "real time",
          .unit = "s/s",
          .ratio = factor,
          .lower_is_better = false};
}

}  // namespace

/// Both sides as they are shipped, without any effect, and with every effect there is.
int bench_sim(const BenchOptions& options) {
  const double share = options.seconds / 3.0;
  report_rows({row("sim_realtime_factor", realtime_factor("phantom-1.5", share)),
               row("sim_bare", realtime_factor("phantom-1.5-bare", share)),
               row("sim_every_effect", realtime_factor("phantom-1.5-everything", share))},
              options);
  return 0;
}

}  // namespace teleop
