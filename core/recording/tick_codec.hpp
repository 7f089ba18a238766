#pragma once

#include <optional>
#include <string>

#include "core/recording/mcap_format.hpp"
#include "core/recording/tick_record.hpp"

namespace teleop {

/// A TickRecord as the Protobuf message `teleop.Tick`, made of for_each_field(): one field a
/// member, its number the tag. Unsigned and signed numbers are varints, doubles 8 bytes, the joint
/// counts a packed `repeated sint32`, vectors a packed `repeated double`. A scalar that is zero is
/// left out, as in proto3.

inline constexpr const char* kTickMessage = "teleop.Tick";

/// Appends the message to `out`.
void encode_tick(const TickRecord& record, Bytes& out);

/// What a newer writer added is ignored, what an older one lacked is zero.
/// @returns nothing when the bytes are not a Protobuf message.
[[nodiscard]] std::optional<TickRecord> decode_tick(ByteView message) noexcept;

/// The message's definition, as a serialised google.protobuf.FileDescriptorSet with the fields'
/// meanings as comments: what makes a log explain itself.
[[nodiscard]] std::string tick_schema();

}  // namespace teleop
