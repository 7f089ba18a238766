#include "core/program/side.hpp"

#include <atomic>
#include <cstdio>
#include <filesystem>
#include <optional>
#include <thread>

#include <fmt/format.h>
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include "core/base/error.hpp"
#include "core/base/version.hpp"
#include "core/device/device.hpp"
#include "core/program/command_line.hpp"
#include "core/program/side_config.hpp"
#include "core/program/status.hpp"
#include "core/program/stop_signal.hpp"
#include "core/realtime/loop.hpp"
#include "core/realtime/mailbox.hpp"
#include "core/recording/recorder.hpp"
#include "core/station/station.hpp"

namespace teleop {
namespace {

using namespace std::chrono_literals;  // NOLINT(google-build-using-namespace): literals only

/// Everything that the process owns, in the order in which it is opened.
class Side {
 public:
  Side(Role role, const SideConfig& config, const LinkPlug& plug, const Settings& settings)
      : role_{role},
        config_{config},
        refused_{prepare_process()},
        arm_{open_device(config.device,
                         {.clock = clock_,
                          .hand = hand(),
                          .environment = config.environment,
                          .seed = config.seed})},
        model_{load_arm(arm_->info().model)},
        opened_{plug.open()},
        station_{config.station, role, model_, {*arm_, *opened_.link, clock_}} {
    refused_.insert(refused_.end(), opened_.refused.begin(), opened_.refused.end());
    for (const std::string& line : station_.notices()) {
      spdlog::warn("{}", line);
    }
    if (!config.out.empty()) open_recording(settings);
  }

  /// Runs the loop until it ends by itself or is told to. @returns the exit code.
  int run(StopSignal& stop, std::uint32_t own_version) {
    std::atomic<bool> started{false};
    std::thread loop{[&] {
      const std::vector<std::string> refused = prepare_thread(config_.realtime);
      refused_.insert(refused_.end(), refused.begin(), refused.end());
      started.store(true, std::memory_order_release);
      started.notify_one();
      run_loop();
    }};
    started.wait(false, std::memory_order_acquire);
    for (const std::string& line : refused_) {
      spdlog::warn("real time: {}", line);
    }
    spdlog::info("{} on {}, {} Hz, {}", name_of(role_), arm_->info().name, config_.station.rate_Hz,
                 opened_.address);
    announce();
    std::optional<std::string> wrong;
    while (!done_.load(std::memory_order_acquire)) {
      if (stop.wait(100ms)) stop_.store(true, std::memory_order_relaxed);
      if (status_box_.take(status_)) show();
      if (status_.link.peer_version != 0 && status_.link.received == 0) {
        wrong =
            fmt::format("the peer speaks protocol version {}, this side {}: update the older one",
                        status_.link.peer_version, own_version);
        stop_.store(true, std::memory_order_relaxed);
      }
    }
    loop.join();
    (void)status_box_.take(status_);
    show();
    if (isatty(STDERR_FILENO) != 0 && !config_.status_json) std::fputc('\n', stderr);
    close_recording();
    if (status_.link.refused > 0) {
      spdlog::warn("link: {} packets refused: torn, foreign or of another protocol version",
                   status_.link.refused);
    }
    if (wrong) throw TransportError{*wrong};
    return status_.record.fault == 0 ? 0 : 1;
  }

 private:
  /// Of a simulated arm; when nobody says, the operator's holds the master.
  [[nodiscard]] std::string hand() const {
    if (!config_.hand.empty()) return config_.hand;
    return role_ == Role::master ? "reach" : "none";
  }

  void open_recording(const Settings& settings) {
    std::error_code error;
    std::filesystem::create_directories(config_.out, error);
    if (error) {
      throw RecordingError{fmt::format("{}: cannot be made: {}", config_.out, error.message())};
    }
    const auto file = std::filesystem::path{config_.out} / fmt::format("{}.mcap", name_of(role_));
    const StationConfig& station = config_.station;
    Metadata metadata{
        {"role", name_of(role_)},
        {"version", std::string{kVersion}},
        {"arm", arm_->info().model},
        {"device", config_.device},
        {"device_details", arm_->info().details},
        {"rate_Hz", fmt::format("{}", station.rate_Hz)},
        {"seed", fmt::format("{}", config_.seed)},
        {"hand", hand()},
        {"environment", config_.environment},
        {"host", host_name()},
        {"config", settings.print()},
    };
    metadata.merge(station_.metadata());
    recorder_.emplace(Recorder::Config{.log = {.file = file, .role = role_, .metadata = metadata}});
  }

  void close_recording() {
    if (!recorder_) return;
    std::string granted;
    for (const std::string& line : refused_) {
      granted += (granted.empty() ? "" : "; ") + line;
    }
    recorder_->close({
        {"realtime", granted.empty() ? "granted" : granted},
        {"turns", std::to_string(status_.turns)},
        {"turns_missed", std::to_string(status_.missed)},
        {"turns_not_recorded", std::to_string(status_.dropped)},
    });
    if (recorder_->failed()) spdlog::error("recording stopped: {}", recorder_->failure());
  }

  static std::string host_name() {
    std::array<char, 256> name{};
    return gethostname(name.data(), name.size() - 1) == 0 ? name.data() : "unknown";
  }

  /// The loop's thread.
  void run_loop() noexcept {
    const Duration period{static_cast<std::int64_t>(1e9 / config_.station.rate_Hz)};
    const Instant end =
        config_.seconds > 0.0
            ? clock_.now() + Duration{static_cast<std::int64_t>(1e9 * config_.seconds)}
            : Instant::max();
    Status status;
    run_periodically(clock_, period, [&](const Tick& tick) noexcept {
      status.record = station_.step(tick);
      status.link = station_.link_statistics();
      ++status.turns;
      status.missed = tick.missed;
      if (recorder_) {
        if (!recorder_->record(status.record)) ++status.dropped;
        if (recorder_->failed()) station_.report_recording_failed();
      }
      lateness_.record(tick.lateness());
      status_box_.put(status);
      const bool stop = stop_.load(std::memory_order_relaxed) || tick.now >= end;
      return stop ? Next::stop : Next::again;
    });
    status.record = station_.stop();
    if (recorder_) (void)recorder_->record(status.record);
    status_box_.put(status);
    done_.store(true, std::memory_order_release);
  }

  void announce() const {
    if (!config_.status_json) return;
    std::printf("{\"role\":\"%s\",\"address\":\"%s\"}\n", name_of(role_), opened_.address.c_str());
    std::fflush(stdout);
  }

  void show() {
    if (config_.status_json) {
      std::printf("%s\n", status_json(role_, status_, lateness_).c_str());
      // Whoever started this side is gone: nobody could stop it any more.
      if (std::fflush(stdout) != 0) stop_.store(true, std::memory_order_relaxed);
    } else if (isatty(STDERR_FILENO) != 0) {
      std::fprintf(stderr, "\r\033[K%s", status_line(role_, status_, lateness_).c_str());
    }
  }

  Role role_;
  const SideConfig& config_;
  SystemClock clock_;
  std::vector<std::string> refused_;
  std::unique_ptr<Arm> arm_;
  ArmModel model_;
  LinkPlug::Opened opened_;
  Station station_;
  std::optional<Recorder> recorder_;
  Mailbox<Status> status_box_;
  Status status_{};
  Histogram lateness_;
  std::atomic<bool> stop_{false};
  std::atomic<bool> done_{false};
};

}  // namespace

int run_side(Role role, int argc, char** argv, const LinkPlug& plug) {
  SideConfig config;
  Settings settings;
  add_settings(settings, config);
  plug.add_settings(settings);
  const std::string description =
      fmt::format("teleop-{}: one side of a bilateral teleoperator", name_of(role));
  if (const auto code = read_command_line(argc, argv, description, settings)) return *code;
  auto logger = spdlog::stderr_color_mt(fmt::format("teleop-{}", name_of(role)));
  logger->set_pattern("%n: %^%l%$: %v");
  spdlog::set_default_logger(logger);

  StopSignal stop;
  Side side{role, config, plug, settings};
  return side.run(stop, plug.protocol_version);
}

}  // namespace teleop
