#include "transport/session.hpp"

#include <algorithm>

namespace teleop {

Datagram Sender::step(const PeerState& state,
                      const std::optional<Heard>& heard,
                      Instant now) noexcept {
  Datagram datagram{
      .session = session_, .sequence = ++sequence_, .sent = now, .echo = {}, .state = state};
  if (heard) {
    datagram.echo = Echo{.sent = heard->sent, .hold = std::max(now - heard->received, Duration{0})};
  }
  return datagram;
}

std::optional<PeerSample> Receiver::step(const Datagram& datagram, Instant arrival) noexcept {
  if (datagram.session != session_) {
    if (!would_adopt(datagram.session, arrival)) {
      ++statistics_.refused;
      return std::nullopt;
    }
    adopt(datagram.session);
  }
  ++statistics_.received;
  if (window_.step(datagram.sequence, statistics_) != SequenceWindow::Place::newest) {
    return std::nullopt;
  }
  heard_ = Heard{.sent = datagram.sent, .received = arrival};
  const std::optional<Duration> round_trip = measure(datagram, arrival);
  const ClockSync::Delay delay = clock_.delay(datagram.sent, arrival);
  return PeerSample{.state = datagram.state,
                    .session = datagram.session,
                    .sequence = datagram.sequence,
                    .received = arrival,
                    .sent = datagram.sent,
                    .round_trip = round_trip.value_or(Duration{0}),
                    .has_round_trip = round_trip.has_value(),
                    .one_way = delay.one_way,
                    .one_way_bound = delay.bound};
}

void Receiver::refuse(const Decoded& decoded) noexcept {
  ++statistics_.refused;
  if (decoded.check == Check::version) statistics_.peer_version = decoded.version;
}

bool Receiver::would_adopt(std::uint64_t session, Instant now) const noexcept {
  if (session == session_ || session == own_ || session == retired_) return false;
  return !heard_ || now - heard_->received >= kSessionSilence;
}

void Receiver::adopt(std::uint64_t session) noexcept {
  retired_ = session_;
  session_ = session;
  window_ = {};
  clock_ = {};
  heard_.reset();
}

/// The network's share of an echoed round trip. An echo from the future, or held for longer than it
/// was away (beyond the drift of the clocks), is a lie or of a restarted clock: no measurement.
std::optional<Duration> Receiver::measure(const Datagram& datagram, Instant arrival) noexcept {
  if (!datagram.echo) return std::nullopt;
  const Duration away = arrival - datagram.echo->sent;
  const Duration hold = datagram.echo->hold;
  const double longest = static_cast<double>(away.count()) * (1.0 + kMaxDrift);
  if (away < Duration{0} || static_cast<double>(hold.count()) > longest) return std::nullopt;
  clock_.step(
      {.asked = datagram.echo->sent, .held = hold, .answered = datagram.sent, .received = arrival});
  return std::max(away - hold, Duration{0});
}

}  // namespace teleop
