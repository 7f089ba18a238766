#include "core/recording/recover.hpp"

#include <fmt/format.h>

#include "core/base/error.hpp"
#include "core/recording/mcap_reader.hpp"
#include "core/recording/tick_codec.hpp"

namespace teleop {

Recovery recover_log(const std::filesystem::path& in, const std::filesystem::path& out) {
  const Bytes bytes = read_mcap_file(in);
  Recovery recovery;
  std::uint32_t next = 0;
  const McapScan scan = scan_mcap(bytes, kTickMessage, [&](const McapMessage& message) {
    recovery.lost += message.sequence - next;
    next = message.sequence + 1;
  });
  recovery.kept = scan.messages;
  recovery.unread_bytes = scan.unread_bytes;
  recovery.damage = scan.damage_text();
  if (recovery.kept == 0) {
    throw RecordingError{
        fmt::format("{}: holds no readable record: {}", in.string(), recovery.damage)};
  }

  Metadata metadata = scan.metadata;
  metadata["recovered_from"] = in.filename().string();
  metadata["damage"] = recovery.damage;
  McapWriter writer{out, scan.channel};
  writer.metadata("teleop.recovered", metadata);
  static_cast<void>(scan_mcap(bytes, kTickMessage, [&](const McapMessage& message) {
    writer.message(message.sequence, message.log_time_ns, message.data);
  }));
  writer.finish();
  return recovery;
}

std::filesystem::path recovered_name(const std::filesystem::path& log) {
  std::filesystem::path name = log;
  return name.replace_extension(".recovered" + log.extension().string());
}

}  // namespace teleop
