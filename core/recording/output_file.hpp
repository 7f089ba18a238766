#pragma once

#include <filesystem>

#include "core/recording/mcap_format.hpp"

namespace teleop {

/// A new file, written front to back without a buffer in the process: what write() took survives
/// the process. It never replaces a file.
class OutputFile {
 public:
  /// @throws RecordingError: the file exists already or cannot be created.
  explicit OutputFile(std::filesystem::path path);
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;
  OutputFile(OutputFile&&) = delete;
  OutputFile& operator=(OutputFile&&) = delete;
  ~OutputFile();

  /// @throws RecordingError: the disk is full or failed; part of the bytes may have been written.
  void write(ByteView bytes);

 private:
  std::filesystem::path path_;
  int descriptor_ = -1;
};

}  // namespace teleop
