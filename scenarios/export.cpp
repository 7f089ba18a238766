#include "scenarios/export.hpp"

#include <cstdio>
#include <fstream>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/base/error.hpp"
#include "core/recording/csv.hpp"
#include "core/recording/log.hpp"
#include "core/recording/recover.hpp"
#include "scenarios/output.hpp"

namespace teleop {
namespace fs = std::filesystem;

int run_export(const fs::path& log, const fs::path& csv, const fs::path& json) {
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
  if (!json.empty()) {
    write_json(json, {{"log", log.string()},
                      {"csv", csv.string()},
                      {"records", read.ticks.size()},
                      {"complete", read.complete},
                      {"damage", read.damage}});
  }
  return 0;
}

int run_recover(const fs::path& log, fs::path out, const fs::path& json) {
  if (out.empty()) out = recovered_name(log);
  const Recovery recovery = recover_log(log, out);
  fmt::print(stderr, "{}: {} records kept, {} lost between them, {} bytes of a torn end: {}\n",
             log.string(), recovery.kept, recovery.lost, recovery.unread_bytes, out.string());
  fmt::print(stderr, "{}: {}\n", log.string(),
             recovery.damage.empty() ? "was whole" : recovery.damage);
  if (!json.empty()) {
    write_json(json, {{"log", log.string()},
                      {"out", out.string()},
                      {"kept", recovery.kept},
                      {"lost", recovery.lost},
                      {"unread_bytes", recovery.unread_bytes},
                      {"damage", recovery.damage}});
  }
  return 0;
}

}  // namespace teleop
