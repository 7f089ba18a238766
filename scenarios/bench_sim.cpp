#include <chrono>

#include "core/effects/contact.hpp"
#include "core/simulation/pair.hpp"
#include "scenarios/bench.hpp"

namespace teleop {

/// Both arms with friction, a hand that presses, a wall, the whole stations: as fast as it goes,
/// against the clock on the wall.
int bench_sim(const BenchOptions& options) {
  const PlantSpec plant = load_plant("phantom-1.5");
  SimulatedPair pair{{.master = {.plant = plant, .hand = "press"},
                      .slave = {.plant = plant, .contact = environment("wall")}}};
  using WallClock = std::chrono::steady_clock;
  const auto begin = WallClock::now();
  std::uint64_t steps = 0;
  double wall_s = 0.0;
  while (wall_s < options.seconds) {
    for (int i = 0; i < 1000; ++i) {
      pair.step();
    }
    steps += 1000;
    wall_s = std::chrono::duration<double>(WallClock::now() - begin).count();
  }
  const double simulated_s = static_cast<double>(steps) * 1e-3;
  report_rows({{.id = "sim_realtime_factor",
                .ours = simulated_s / wall_s,
                .peer = 1.0,
                .peer_name = "real time",
                .unit = "s/s",
                .ratio = simulated_s / wall_s,
                .lower_is_better = false}},
              options);
  return 0;
}

}  // namespace teleop
