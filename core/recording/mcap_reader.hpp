#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "core/recording/log.hpp"
#include "core/recording/mcap_format.hpp"
#include "core/recording/mcap_writer.hpp"

namespace teleop {

struct McapMessage {
  std::uint32_t sequence = 0;
  std::uint64_t log_time_ns = 0;
  ByteView data{};  ///< valid during the call
};

/// What a file held besides its messages.
struct McapScan {
  McapWriter::Channel channel{};  ///< of the messages; an empty topic when there is none
  Metadata metadata{};            ///< all records of it, later ones win
  std::uint64_t messages = 0;
  std::uint64_t unread_bytes = 0;     ///< behind the place where the file is torn
  std::vector<std::string> damage{};  ///< in words, at most kMostDamage of them
  std::uint64_t damages = 0;          ///< all of them

  static constexpr std::size_t kMostDamage = 3;
  [[nodiscard]] std::string damage_text() const;  ///< one line, empty when the file is whole
};

using McapVisitor = std::function<void(const McapMessage&)>;

/// Reads an MCAP file front to back and shows the messages of Protobuf type `schema_name` to
/// `visit`, in the order of the file. Every length and CRC is checked: a chunk that is damaged is
/// left out, a file that is torn ends there, and both are told. Never throws for what the bytes
/// say; a chunk that claims more than 16 MiB is damaged.
[[nodiscard]] McapScan scan_mcap(ByteView file,
                                 const std::string& schema_name,
                                 const McapVisitor& visit);

[[nodiscard]] bool is_mcap(ByteView file) noexcept;

/// @throws RecordingError: no such file, unreadable, not an MCAP file.
[[nodiscard]] Bytes read_mcap_file(const std::filesystem::path& file);

}  // namespace teleop
