// What one millisecond of one simulated arm costs.

#include <benchmark/benchmark.h>

#include "core/effects/plant_spec.hpp"
#include "core/effects/vocabulary.hpp"
#include "core/model/kinematics.hpp"
#include "core/realtime/clock.hpp"
#include "core/simulation/arm_sim.hpp"
#include "core/simulation/plant.hpp"

namespace teleop {
namespace {

using namespace std::chrono_literals;  // NOLINT(google-build-using-namespace): literals only

Plant make_plant(const char* plant, const char* hand, const char* surface) {
  const PlantSpec spec = load_plant(plant);
  const ArmModel arm = load_arm(spec.arm);
  return Plant{arm,
               {
                   .terms = terms_of(spec.effects),
                   .hand = make_hand(hand, arm, Vector3::Zero(), 1, {}),
                   .contact = environment(surface),
               }};
}

void run(benchmark::State& state, Plant plant) {
  const ArmModel arm = load_arm("phantom-1.5");
  const auto counts = Eigen::Map<const JointVector>(arm.parameters().encoder_counts_per_rev.data());
  Sensing edges{{}, counts, plant.q()};
  for (auto _ : state) {
    plant.advance(1ms, &edges);
    plant.set_torque(-0.01 * plant.qd());
    benchmark::DoNotOptimize(plant.qd());
  }
  state.counters["events_per_ms"] =
      static_cast<double>(plant.events()) / static_cast<double>(state.iterations());
}

void bare(benchmark::State& state) { run(state, make_plant("phantom-1.5-bare", "none", "free")); }
void friction_and_hand(benchmark::State& state) {
  run(state, make_plant("phantom-1.5", "reach", "free"));
}
void friction_hand_and_wall(benchmark::State& state) {
  run(state, make_plant("phantom-1.5", "reach", "wall"));
}
void pressing_on_the_wall(benchmark::State& state) {
  run(state, make_plant("phantom-1.5", "press", "wall"));
}

/// The whole port: read and write, once a millisecond, with hand and wall.
void turn_of_a_simulated_arm(benchmark::State& state) {
  SimulatedClock clock;
  SimulatedArm arm{
      {.plant = load_plant("phantom-1.5"), .hand = "reach", .contact = environment("wall")}, clock};
  arm.amplifiers(true);
  for (auto _ : state) {
    const ArmState reading = arm.read();
    arm.write(-0.1 * reading.q);
    clock.sleep_until(clock.now() + 1ms);
  }
}

BENCHMARK(bare);
BENCHMARK(friction_and_hand);
BENCHMARK(friction_hand_and_wall);
BENCHMARK(pressing_on_the_wall);
BENCHMARK(turn_of_a_simulated_arm);

}  // namespace
}  // namespace teleop
