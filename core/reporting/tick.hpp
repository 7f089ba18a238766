#pragma once

#include "core/base/fault.hpp"
#include "core/ports/arm.hpp"
#include "core/ports/peer.hpp"
#include "core/recording/log.hpp"
#include "core/recording/tick_record.hpp"

namespace teleop {

// How the reports read the plain numbers of a record.

[[nodiscard]] constexpr Mode mode_of(const TickRecord& record) noexcept {
  return static_cast<Mode>(record.mode);
}

[[nodiscard]] constexpr bool has(const TickRecord& record, Limit limit) noexcept {
  return ((record.limits >> static_cast<unsigned>(limit)) & 1U) != 0;
}

[[nodiscard]] constexpr bool has(const TickRecord& record, ArmFlag flag) noexcept {
  return (record.arm_flags & static_cast<std::uint32_t>(flag)) != 0;
}

/// The side that wrote a log.
/// @throws RecordingError unless metadata "role" is "master" or "slave".
[[nodiscard]] Role role_of(const Log& log);

/// Turns a second that the loop was asked for, Hz: metadata "rate_Hz", or where it is missing the
/// inverse of the median recorded turn. 0 when neither says.
[[nodiscard]] double nominal_rate(const Log& log);

}  // namespace teleop
