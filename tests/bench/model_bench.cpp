// What one evaluation of the arm's model costs, on postures that change from one to the next.

#include <array>
#include <cstddef>

#include <benchmark/benchmark.h>

#include "core/math/random.hpp"
#include "core/model/dynamics.hpp"
#include "core/model/kinematics.hpp"

namespace teleop {
namespace {

struct Input {
  JointVector q = JointVector::Zero();
  JointVector qd = JointVector::Zero();
  JointVector u = JointVector::Zero();  ///< a torque or an acceleration
  Vector3 p_BT = Vector3::Zero();
};

using Inputs = std::array<Input, 1024>;

/// Postures that the stops allow.
Inputs make_inputs(const ArmModel& arm) {
  Random random{1};
  const auto vector = [&random](double bound) -> JointVector {
    return {random.uniform(-bound, bound), random.uniform(-bound, bound),
            random.uniform(-bound, bound)};
  };
  Inputs inputs;
  for (Input& input : inputs) {
    do {
      input.q = vector(1.6);
    } while (check_limits(arm, input.q) != Reach::ok);
    input.qd = vector(5.0);
    input.u = vector(0.5);
    input.p_BT = tool_position(arm, input.q);
  }
  return inputs;
}

template <typename Evaluate>
void run(benchmark::State& state, Evaluate evaluate) {
  const ArmModel arm = load_arm("phantom-1.5");
  const Inputs inputs = make_inputs(arm);
  std::size_t i = 0;
  for ([[maybe_unused]] const auto turn : state) {
    auto result = evaluate(arm, inputs[i]);
    benchmark::DoNotOptimize(result);
    i = (i + 1) % inputs.size();
  }
}

void fk(benchmark::State& state) {
  run(state, [](const ArmModel& arm, const Input& x) { return forward_kinematics(arm, x.q); });
}
void ik(benchmark::State& state) {
  run(state, [](const ArmModel& arm, const Input& x) { return inverse_kinematics(arm, x.p_BT); });
}
void jacobian(benchmark::State& state) {
  run(state, [](const ArmModel& arm, const Input& x) { return hybrid_jacobian(arm, x.q); });
}
void linear_jacobian_only(benchmark::State& state) {
  run(state, [](const ArmModel& arm, const Input& x) { return linear_jacobian(arm, x.q); });
}
void manipulability_only(benchmark::State& state) {
  run(state, [](const ArmModel& arm, const Input& x) { return manipulability(arm, x.q); });
}
void dynamics_terms(benchmark::State& state) {
  run(state, [](const ArmModel& arm, const Input& x) { return dynamics(arm, x.q, x.qd); });
}
void inverse_dynamics_only(benchmark::State& state) {
  run(state,
      [](const ArmModel& arm, const Input& x) { return inverse_dynamics(arm, x.q, x.qd, x.u); });
}
void forward_dynamics_only(benchmark::State& state) {
  run(state,
      [](const ArmModel& arm, const Input& x) { return forward_dynamics(arm, x.q, x.qd, x.u); });
}

// NOLINTBEGIN(cert-err58-cpp, cppcoreguidelines-owning-memory): how the library registers
BENCHMARK(fk);
BENCHMARK(ik);
BENCHMARK(jacobian);
BENCHMARK(linear_jacobian_only)->Name("linear_jacobian");
BENCHMARK(manipulability_only)->Name("manipulability");
BENCHMARK(dynamics_terms)->Name("dynamics");
BENCHMARK(inverse_dynamics_only)->Name("inverse_dynamics");
BENCHMARK(forward_dynamics_only)->Name("forward_dynamics");
// NOLINTEND(cert-err58-cpp, cppcoreguidelines-owning-memory)

}  // namespace
}  // namespace teleop
