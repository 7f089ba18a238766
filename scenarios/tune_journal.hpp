#pragma once

#include <cstddef>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "core/tuning/probe_result.hpp"

namespace teleop {

/// What a tuning run has done so far, as JSON lines beside its results: the first line says what
/// was asked, each further one is a probe, written before the next one starts. A run that was
/// killed goes on from here: no finished probe is repeated.
class TuneJournal {
 public:
  /// Opens `file`; `asked` describes the run. With `resume` an existing journal is read first, else
  /// replaced.
  /// @throws ConfigError: it cannot be written, or is of another run.
  TuneJournal(const std::filesystem::path& file, const nlohmann::json& asked, bool resume);

  /// Probes that were done for a job.
  [[nodiscard]] const std::vector<ProbeResult>& done(std::size_t job) const;

  void append(std::size_t job, const ProbeResult& probe);

 private:
  void load(const std::filesystem::path& file, const nlohmann::json& asked);

  std::vector<std::vector<ProbeResult>> jobs_;
  std::ofstream out_;
};

[[nodiscard]] nlohmann::json to_json(const ProbeResult& probe);
[[nodiscard]] ProbeResult probe_from_json(const nlohmann::json& json);

}  // namespace teleop
