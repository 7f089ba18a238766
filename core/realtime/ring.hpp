#pragma once

#include <atomic>
#include <bit>
#include <cstddef>
#include <vector>

namespace teleop {

/// A queue between one writing and one reading thread. Wait-free: a full ring refuses, an empty one
/// returns false. Memory is taken once, in the constructor.
template <class T>
class Ring {
 public:
  /// Holds at least `capacity` elements; rounded up to a power of two.
  explicit Ring(std::size_t capacity) : slots_(std::bit_ceil(capacity)), mask_{slots_.size() - 1} {}

  /// Writer only. @returns false when the ring is full; nothing was stored.
  [[nodiscard]] bool push(const T& value) noexcept {
    const std::size_t head = head_.load(std::memory_order_relaxed);
    if (head - tail_.load(std::memory_order_acquire) == slots_.size()) return false;
    slots_[head & mask_] = value;
    head_.store(head + 1, std::memory_order_release);
    return true;
  }

  /// Reader only. @returns false when the ring is empty; `value` is untouched.
  [[nodiscard]] bool pop(T& value) noexcept {
    const std::size_t tail = tail_.load(std::memory_order_relaxed);
    if (tail == head_.load(std::memory_order_acquire)) return false;
    value = slots_[tail & mask_];
    tail_.store(tail + 1, std::memory_order_release);
    return true;
  }

  [[nodiscard]] std::size_t capacity() const noexcept { return slots_.size(); }

 private:
  static constexpr std::size_t kCacheLine = 64;

  std::vector<T> slots_;
  std::size_t mask_;
  alignas(kCacheLine) std::atomic<std::size_t> head_{0};
  alignas(kCacheLine) std::atomic<std::size_t> tail_{0};
};

}  // namespace teleop
