#pragma once

#include <cstdint>

#include "core/ports/link.hpp"

namespace teleop {

/// Tells new packets of one session from late and repeated ones, and counts them: the 64 sequence
/// numbers up to the newest are remembered one by one.
///
/// - beyond the newest: newest; every number that it skips counts as lost
/// - remembered as seen: duplicated
/// - remembered as missing: reordered, and no longer lost
/// - 64 or more behind the newest: reordered; whether it filled a gap is no longer known
///
/// Numbers before the first one seen were sent before anybody listened and are not lost.
/// Loop: neither allocates, blocks nor throws.
class SequenceWindow {
 public:
  static constexpr std::uint64_t kSize = 64;

  enum class Place : std::uint8_t { newest, duplicate, late };

  /// @pre sequence is 1 or more.
  [[nodiscard]] Place step(std::uint64_t sequence, LinkStatistics& counted) noexcept {
    if (sequence > newest_) return advance(sequence, counted);
    const std::uint64_t behind = newest_ - sequence;
    if (behind < kSize) {
      const std::uint64_t bit = std::uint64_t{1} << behind;
      if ((seen_ & bit) != 0) {
        ++counted.duplicated;
        return Place::duplicate;
      }
      seen_ |= bit;
      if (sequence > first_) --counted.lost;
    }
    ++counted.reordered;
    return Place::late;
  }

 private:
  Place advance(std::uint64_t sequence, LinkStatistics& counted) noexcept {
    const std::uint64_t ahead = sequence - newest_;
    if (newest_ == 0) {
      first_ = sequence;
    } else {
      counted.lost += ahead - 1;
    }
    seen_ = ahead < kSize ? (seen_ << ahead) | 1U : 1U;
    newest_ = sequence;
    return Place::newest;
  }

  std::uint64_t first_ = 0;
  std::uint64_t newest_ = 0;  // 0: nothing seen yet
  std::uint64_t seen_ = 0;    // bit n: newest_ − n was seen
};

}  // namespace teleop
