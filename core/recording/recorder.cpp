#include "core/recording/recorder.hpp"

#include <csignal>
#include <exception>
#include <utility>

#include <pthread.h>
#include <sched.h>

#include "core/base/contract.hpp"

namespace teleop {
namespace {

using std::chrono::steady_clock;

LogWriter::Config on_wall_clock(LogWriter::Config config) {
  config.epoch_offset_ns = wall_clock_offset_ns();
  return config;
}

/// Signals are for the thread that waits for them, and a full file must be an error, not SIGXFSZ.
/// Threads inherit a real-time priority: the writer must not have the loop's.
void become_background() noexcept {
  sigset_t all{};
  sigfillset(&all);
  pthread_sigmask(SIG_BLOCK, &all, nullptr);
  const sched_param none{};
  pthread_setschedparam(pthread_self(), SCHED_OTHER, &none);
}

}  // namespace

std::int64_t wall_clock_offset_ns() {
  const auto wall = std::chrono::system_clock::now().time_since_epoch();
  const auto monotonic = steady_clock::now().time_since_epoch();
  return std::chrono::duration_cast<Duration>(wall - monotonic).count();
}

Recorder::Recorder(Config config)
    : log_{on_wall_clock(std::move(config.log))}, ring_{config.ring_records} {
  writer_ = std::thread{[this] {
    write();
  }};
}

Recorder::~Recorder() { close(); }

bool Recorder::record(const TickRecord& record) noexcept {
  const bool kept = !failed_.load(std::memory_order_relaxed) &&
                    !closing_.load(std::memory_order_relaxed) && ring_.push(record);
  if (!kept) dropped_.fetch_add(1, std::memory_order_relaxed);
  return kept;
}

void Recorder::close(Metadata last) {
  if (!writer_.joinable()) return;
  last_ = std::move(last);
  closing_.store(true, std::memory_order_release);
  writer_.join();
}

const std::string& Recorder::failure() const {
  expects(failed(), "the recording has not failed");
  return failure_;
}

void Recorder::write() {
  become_background();
  try {
    for (int turn = 1; !closing_.load(std::memory_order_acquire); ++turn) {
      drain();
      if (turn % kDrainsPerChunk == 0) log_.flush();
      std::this_thread::sleep_for(kDrainEvery);
    }
    drain();
    last_["dropped"] = std::to_string(dropped());
    log_.close(std::move(last_));
  } catch (const std::exception& error) {
    failure_ = error.what();
    failed_.store(true, std::memory_order_release);
  }
}

void Recorder::drain() {
  TickRecord record;
  while (ring_.pop(record)) {
    log_.append(record);
  }
}

}  // namespace teleop
