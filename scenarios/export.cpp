#include "scenarios/export.hpp"

#include <cstdio>
#include <fstream>

#include <fmt/format.h>

#include "core/base/error.hpp"
#include "core/recording/csv.hpp"
#include "core/recording/log.hpp"
#include "core/recording/recover.hpp"

namespace teleop {
namespace fs = std::filesystem;

int run_export(const fs::path& log, const fs::path& csv) {
  if (fs::exists(csv)) {
    throw RecordingError{
        fmt::format("{}: exists already and is not overwritten: name another file", csv.string())};
  }
  const Log read = read_log(log);
  std::ofstream out{csv, std::ios::binary};
  if (!out) throw RecordingError{fmt::format("{}: cannot be created", csv.string())};
  export_csv(read, out);
  out.close();
  if (!out) throw RecordingError{fmt::format("{}: cannot be written to its end", csv.string())};

  fmt::print(stderr, "{}: {} records to {}\n", log.string(), read.ticks.size(), csv.string());
  if (!read.complete) fmt::print(stderr, "{}: damaged: {}\n", log.string(), read.damage);
  return 0;
}

int run_recover(const fs::path& log, fs::path out) {
  if (out.empty()) out = recovered_name(log);
  const Recovery recovery = recover_log(log, out);
  fmt::print(stderr, "{}: {} records kept, {} lost between them, {} bytes of a torn end: {}\n",
             log.string(), recovery.kept, recovery.lost, recovery.unread_bytes, out.string());
  fmt::print(stderr, "{}: {}\n", log.string(),
             recovery.damage.empty() ? "was whole" : recovery.damage);
  return 0;
}

}  // namespace teleop
