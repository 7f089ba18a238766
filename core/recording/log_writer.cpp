#include "core/recording/log_writer.hpp"

#include <string>
#include <utility>

#include "core/recording/tick_codec.hpp"

namespace teleop {

LogWriter::LogWriter(const Config& config)
    : mcap_{config.file,
            {.topic = std::string{"/"} + name_of(config.role),
             .schema_name = kTickMessage,
             .schema = tick_schema()}},
      epoch_offset_ns_{config.epoch_offset_ns} {
  Metadata metadata = config.metadata;
  metadata["role"] = name_of(config.role);
  metadata["epoch_offset_ns"] = std::to_string(config.epoch_offset_ns);
  mcap_.metadata("teleop.start", metadata);
}

void LogWriter::append(const TickRecord& record) {
  message_.clear();
  encode_tick(record, message_);
  mcap_.message(static_cast<std::uint32_t>(records()),
                static_cast<std::uint64_t>(record.stamp_ns + epoch_offset_ns_), message_);
}

void LogWriter::close(Metadata last) {
  mcap_.write_chunk();
  last["records"] = std::to_string(records());
  mcap_.metadata("teleop.end", last);
  mcap_.finish();
}

}  // namespace teleop
