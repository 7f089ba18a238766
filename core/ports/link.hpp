#pragma once

#include <cstdint>
#include <optional>

#include "core/ports/peer.hpp"

namespace teleop {

/// Counted since the link was opened.
struct LinkStatistics {
  std::uint64_t sent = 0;
  std::uint64_t received = 0;  ///< valid packets, duplicates and late ones included
  std::uint64_t lost = 0;      ///< gaps in the sequence that never filled
  std::uint64_t duplicated = 0;
  std::uint64_t reordered = 0;     ///< arrived after a newer one; not used
  std::uint64_t refused = 0;       ///< torn, foreign or of another protocol version
  std::uint32_t peer_version = 0;  ///< protocol version of the last packet refused for its version
};

/// The port to the other side. Newest wins: a packet that arrives after a newer one is counted,
/// never delivered.
///
/// Thread: the loop's only. No call blocks, allocates or throws.
class Link {
 public:
  Link() = default;
  Link(const Link&) = delete;
  Link& operator=(const Link&) = delete;
  Link(Link&&) = delete;
  Link& operator=(Link&&) = delete;
  virtual ~Link() = default;

  /// The newest sample that has not been returned before.
  [[nodiscard]] virtual std::optional<PeerSample> receive() noexcept = 0;
  virtual void send(const PeerState& state) noexcept = 0;
  [[nodiscard]] virtual LinkStatistics statistics() const noexcept = 0;

  /// Tells this opening of the link from any other, as its packets do.
  [[nodiscard]] virtual std::uint64_t session() const noexcept = 0;
};

}  // namespace teleop
