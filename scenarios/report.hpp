#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace teleop {

/// `teleop report LOG… [--out FILE] [--json FILE]`: one page about the recording of one side or of
/// both. An empty `out` stands for report.html beside the first log; an empty `json` for none. The
/// story goes to stdout.
/// @throws RecordingError: a log that cannot be read, or logs that do not make a run.
/// @throws ConfigError: `out` or `json` is a log or a folder, both are one file, or one cannot be
///         written. What can be refused is refused before a log is read.
int run_report(const std::vector<std::string>& logs,
               std::filesystem::path out,
               const std::filesystem::path& json);

}  // namespace teleop
