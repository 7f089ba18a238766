#include <algorithm>
#include <array>
#include <cstdio>
#include <memory>
#include <sstream>
#include <thread>
#include <vector>

#include <fmt/format.h>

#include "core/base/error.hpp"
#include "core/device/device.hpp"
#include "core/realtime/loop.hpp"
#include "core/realtime/scheduling.hpp"
#include "core/simulation/network.hpp"
#include "core/station/station.hpp"
#include "scenarios/bench.hpp"

namespace teleop {
namespace {

struct Lateness {
  double p50_us = 0.0;
  double p90_us = 0.0;
};

constexpr Realtime kAsked{.priority = 80, .core = 0};
constexpr double kBlock_s = 10.0;

/// Our loop, with a whole station and a simulated arm in it, as a side's process runs it.
Lateness run_ours(double length_s) {
  SystemClock clock;
  const auto arm = open_device("sim", {.clock = clock});
  const ArmModel model = load_arm(arm->info().model);
  SilentLink link;
  Station station{StationConfig{}, Role::master, model, {*arm, link, clock}};
  std::vector<double> lateness_us;
  lateness_us.reserve(static_cast<std::size_t>(length_s * 1100.0));
  std::vector<std::string> refused;
  std::thread loop{[&] {
    refused = prepare_thread(kAsked);
    const auto turns = static_cast<std::uint64_t>(length_s * 1000.0);
    run_periodically(clock, std::chrono::milliseconds{1}, [&](const Tick& tick) noexcept {
      (void)station.step(tick);
      lateness_us.push_back(1e6 * seconds(tick.lateness()));
      return tick.index + 1 >= turns ? Next::stop : Next::again;
    });
    station.stop();
  }};
  loop.join();
  for (const std::string& line : refused) {
    std::fprintf(stderr, "real time: %s\n", line.c_str());
  }
  std::sort(lateness_us.begin(), lateness_us.end());
  const auto at = [&](double q) {
    return lateness_us[static_cast<std::size_t>(q * static_cast<double>(lateness_us.size() - 1))];
  };
  return {.p50_us = at(0.5), .p90_us = at(0.9)};
}

/// cyclictest at the same priority on the same core: its histogram has buckets of 1 µs; a figure is
/// interpolated within its bucket.
Lateness run_cyclictest(double length_s) {
  const std::string command = fmt::format(
      "cyclictest --quiet --mlockall --threads=1 --affinity={} --priority={} --interval=1000 "
      "--loops={} --histogram=5000 2>/dev/null",
      kAsked.core, kAsked.priority, static_cast<long>(length_s * 1000.0));
  // NOLINTNEXTLINE(cert-env33-c): a fixed program of a Debian package, no input in its command line
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> pipe{popen(command.c_str(), "r"), pclose};
  if (!pipe) throw ConfigError{"cyclictest cannot be started"};
  std::vector<double> counts;
  std::array<char, 256> line{};
  while (std::fgets(line.data(), line.size(), pipe.get()) != nullptr) {
    std::istringstream words{line.data()};
    std::size_t us = 0;
    double count = 0.0;
    if (line[0] == '#' || !(words >> us >> count)) continue;
    counts.resize(std::max(counts.size(), us + 1));
    counts[us] = count;
  }
  double total = 0.0;
  for (const double count : counts) {
    total += count;
  }
  if (total == 0.0) {
    throw ConfigError{
        "cyclictest gave no figures: install the package rt-tests, and run with the right to "
        "SCHED_FIFO"};
  }
  const auto at = [&](double q) {
    double sum = 0.0;
    for (std::size_t us = 0; us < counts.size(); ++us) {
      if (sum + counts[us] >= q * total) {
        return static_cast<double>(us) + (q * total - sum) / counts[us];
      }
      sum += counts[us];
    }
    return static_cast<double>(counts.size());
  };
  return {.p50_us = at(0.5), .p90_us = at(0.9)};
}

}  // namespace

int bench_loop(const BenchOptions& options) {
  for (const std::string& line : prepare_process()) {
    std::fprintf(stderr, "real time: %s\n", line.c_str());
  }
  const auto pairs = std::max(1, static_cast<int>(options.seconds / (2.0 * kBlock_s)));
  const double block_s = std::min(kBlock_s, options.seconds / 2.0);
  std::vector<double> p50;
  std::vector<double> p90;
  Lateness ours;
  Lateness peer;
  for (int i = 0; i < pairs; ++i) {
    ours = run_ours(block_s);
    peer = run_cyclictest(block_s);
    std::fprintf(stderr,
                 "block %d of %d: ours p50 %.1f p90 %.1f us, cyclictest p50 %.1f p90 %.1f us\n",
                 i + 1, pairs, ours.p50_us, ours.p90_us, peer.p50_us, peer.p90_us);
    p50.push_back(ours.p50_us / peer.p50_us);
    p90.push_back(ours.p90_us / peer.p90_us);
  }
  report_rows({{"loop_p50", ours.p50_us, peer.p50_us, "cyclictest", "us", median(p50)},
               {"loop_p90", ours.p90_us, peer.p90_us, "cyclictest", "us", median(p90)}},
              options);
  return 0;
}

}  // namespace teleop
