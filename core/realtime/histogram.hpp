#pragma once

#include <array>
#include <atomic>
#include <bit>
#include <cstdint>

#include "core/base/time.hpp"

namespace teleop {

/// Counts durations from 1 ns to about 9 s in buckets 1/16 of their size apart, so a quantile is
/// exact to 6 %. Fixed memory; one thread records, any thread may read.
class Histogram {
 public:
  /// Loop: wait-free. Negative durations count as zero.
  void record(Duration duration) noexcept {
    const auto ns = static_cast<std::uint64_t>(duration.count() < 0 ? 0 : duration.count());
    auto& bucket = buckets_[index_of(ns)];
    bucket.store(bucket.load(std::memory_order_relaxed) + 1, std::memory_order_relaxed);
  }

  [[nodiscard]] std::uint64_t count() const noexcept {
    std::uint64_t sum = 0;
    for (const auto& bucket : buckets_) {
      sum += bucket.load(std::memory_order_relaxed);
    }
    return sum;
  }

  /// The duration below which the share `q` (0 to 1) of all records lies; upper edge of its bucket.
  /// Zero when nothing was recorded.
  [[nodiscard]] Duration quantile(double q) const noexcept {
    const std::uint64_t total = count();
    if (total == 0) return Duration{0};
    const double wanted = q * static_cast<double>(total);
    std::uint64_t sum = 0;
    std::size_t last = 0;
    for (std::size_t i = 0; i < kBuckets; ++i) {
      const std::uint64_t here = buckets_[i].load(std::memory_order_relaxed);
      if (here == 0) continue;
      sum += here;
      last = i;
      if (static_cast<double>(sum) >= wanted) break;
    }
    return Duration{static_cast<std::int64_t>(upper_edge(last))};
  }

 private:
  static constexpr unsigned kFraction = 4;  // bits below the leading one
  static constexpr std::size_t kSteps = std::size_t{1} << kFraction;
  static constexpr std::size_t kBuckets = 31 * kSteps;

  static constexpr std::size_t index_of(std::uint64_t ns) noexcept {
    if (ns < kSteps) return static_cast<std::size_t>(ns);
    const unsigned exponent = static_cast<unsigned>(std::bit_width(ns)) - 1 - kFraction;
    const auto index = static_cast<std::size_t>(exponent + 1) * kSteps +
                       static_cast<std::size_t>((ns >> exponent) & (kSteps - 1));
    return index < kBuckets ? index : kBuckets - 1;
  }
  static constexpr std::uint64_t upper_edge(std::size_t index) noexcept {
    if (index < kSteps) return index;
    const std::size_t exponent = index / kSteps - 1;
    return ((kSteps + index % kSteps + 1) << exponent) - 1;
  }

  std::array<std::atomic<std::uint64_t>, kBuckets> buckets_{};
};

}  // namespace teleop
