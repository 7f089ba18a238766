#include "core/simulation/pair.hpp"

namespace teleop {

SimulatedPair::SimulatedPair(const Config& config)
    : period_{static_cast<std::int64_t>(1e9 / config.station.rate_Hz)},
      master_arm_{config.master, clock_},
      slave_arm_{config.slave, clock_},
      network_{clock_, config.network_delay},
      master_{config.station,
              Role::master,
              master_arm_.model(),
              {master_arm_, network_.end(Role::master), clock_}},
      slave_{config.station,
             Role::slave,
             slave_arm_.model(),
             {slave_arm_, network_.end(Role::slave), clock_}} {}

void SimulatedPair::step() noexcept {
  clock_.sleep_until(due_);
  master_record_ = &master_.step(tick());
  clock_.sleep_until(due_ + period_ / 2);
  slave_record_ = &slave_.step(tick());
  due_ += period_;
  ++index_;
}

Tick SimulatedPair::tick() noexcept {
  const Instant now = clock_.now();
  return {.index = index_, .due = now, .now = now, .elapsed = period_};
}

}  // namespace teleop
