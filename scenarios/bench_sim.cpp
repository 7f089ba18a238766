#include <chrono>
#include <string_view>

#include "core/effects/contact.hpp"
#include "core/simulation/pair.hpp"
#include "scenarios/bench.hpp"

namespace teleop {

namespace {

using WallClock = std::chrono::steady_clock;

/// Simulated seconds a second of a pair of arms with their stations.
double realtime_factor(const char* plant_name, const char* hand, double seconds) {
  const PlantSpec plant = load_plant(plant_name);
  const bool press = std::string_view{hand} == "press";
  SimulatedPair pair{{.master = {.plant = plant, .hand = hand},
                      .slave = {.plant = plant, .contact = environment(press ? "wall" : "free")}}};
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

/// Both sides as they are shipped, pressed against a wall; without any effect and with every effect
/// there is, in free motion.
int bench_sim(const BenchOptions& options) {
  const double share = options.seconds / 3.0;
  report_rows({row("sim_realtime_factor", realtime_factor("phantom-1.5", "press", share)),
               row("sim_bare", realtime_factor("phantom-1.5-bare", "reach", share)),
               row("sim_every_effect", realtime_factor("phantom-1.5-everything", "reach", share))},
              options);
  return 0;
}

}  // namespace teleop
