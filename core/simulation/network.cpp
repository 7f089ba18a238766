#include "core/simulation/network.hpp"

namespace teleop {

SimulatedNetwork::SimulatedNetwork(Clock& clock, Duration delay) noexcept
    : clock_{clock}, delay_{delay} {
  master_.peer_ = &slave_;
  slave_.peer_ = &master_;
}

void SimulatedNetwork::restart(Role role) noexcept {
  End& end = role == Role::master ? master_ : slave_;
  end.session_ = ++sessions_;
  end.sequence_ = 0;
  end.count_ = 0;
  end.peer_->last_received_ = 0;
}

void SimulatedNetwork::End::send(const PeerState& state) noexcept {
  ++statistics_.sent;
  ++sequence_;
  if (network_.outage_ || peer_->count_ == kOnTheWay) return;
  PeerSample& sample = peer_->inbox_[(peer_->first_ + peer_->count_) % kOnTheWay];
  const Instant now = network_.clock_.now();
  sample = {.state = state,
            .session = session_,
            .sequence = sequence_,
            .received = now + network_.delay_,
            .sent = now,
            .round_trip = 2 * network_.delay_,
            .has_round_trip = true,
            .one_way = network_.delay_,
            .one_way_bound = network_.delay_};
  ++peer_->count_;
}

std::optional<PeerSample> SimulatedNetwork::End::receive() noexcept {
  const Instant now = network_.clock_.now();
  std::optional<PeerSample> newest;
  while (count_ > 0 && inbox_[first_].received <= now) {
    newest = inbox_[first_];
    first_ = (first_ + 1) % kOnTheWay;
    --count_;
    ++statistics_.received;
    if (newest->sequence > last_received_ + 1) {
      statistics_.lost += newest->sequence - last_received_ - 1;
    }
    last_received_ = newest->sequence;
  }
  return newest;
}

}  // namespace teleop
