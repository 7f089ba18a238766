#pragma once

#include <array>
#include <atomic>
#include <cstdint>

namespace teleop {

/// Hands the latest value from one writing to one reading thread; older ones are overwritten.
/// Wait-free on both sides by three slots: one being written, one being read, one in between.
template <class T>
class Mailbox {
 public:
  /// Writer only.
  void put(const T& value) noexcept {
    slots_[writing_] = value;
    writing_ = between_.exchange(writing_ | kFresh, std::memory_order_acq_rel) & kIndex;
  }

  /// Reader only. @returns false when nothing new came since the last take; `value` is untouched.
  [[nodiscard]] bool take(T& value) noexcept {
    if ((between_.load(std::memory_order_relaxed) & kFresh) == 0) return false;
    reading_ = between_.exchange(reading_, std::memory_order_acq_rel) & kIndex;
    value = slots_[reading_];
    return true;
  }

 private:
  static constexpr std::uint8_t kIndex = 3;
  static constexpr std::uint8_t kFresh = 4;

  std::array<T, 3> slots_{};
  std::uint8_t writing_ = 0;
  std::uint8_t reading_ = 1;
  std::atomic<std::uint8_t> between_{2};
};

}  // namespace teleop
