#pragma once

#include <array>
#include <bit>
#include <concepts>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <limits>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "core/math/random.hpp"
#include "core/recording/log_writer.hpp"
#include "tests/support/temporary_folder.hpp"

namespace teleop::testing {

/// Cases of a property test.
inline int cases(int usual) {
  const char* text = std::getenv("TELEOP_CASES");  // NOLINT(concurrency-mt-unsafe)
  return text != nullptr ? std::atoi(text) : usual;
}

/// Fills every field with numbers of every size, the ends of the type and zero among them.
class AnyValue {
 public:
  explicit AnyValue(Random& random) noexcept : random_{random} {}

  template <std::integral T>
  void operator()(const Field&, T& value) {
    value = number<T>();
  }
  void operator()(const Field&, double& value) { value = real(); }
  void operator()(const Field&, std::array<std::int32_t, kJoints>& values) {
    for (std::int32_t& value : values) {
      value = number<std::int32_t>();
    }
  }
  void operator()(const Field&, Vector3& values) {
    for (double& value : values) {
      value = real();
    }
  }

 private:
  template <class T>
  T number() {
    switch (random_.bits() % 8) {
      case 0:
        return 0;
      case 1:
        return std::numeric_limits<T>::max();
      case 2:
        return std::numeric_limits<T>::min();
      default:
        return static_cast<T>(random_.bits() >> (random_.bits() % 64));
    }
  }
  double real() {
    switch (random_.bits() % 8) {
      case 0:
        return 0.0;
      case 1:
        return -0.0;
      case 2:
        return std::numeric_limits<double>::denorm_min();
      case 3:
        return -std::numeric_limits<double>::max();
      default:
        return random_.normal();
    }
  }
  Random& random_;
};

inline TickRecord any_tick(Random& random) {
  TickRecord record;
  for_each_field(record, AnyValue{random});
  return record;
}

/// Ticks every `period_ms`, with any values besides.
inline std::vector<TickRecord> any_ticks(std::uint64_t seed, std::size_t size, int period_ms = 1) {
  Random random{seed};
  std::vector<TickRecord> ticks;
  for (std::size_t i = 0; i < size; ++i) {
    ticks.push_back(any_tick(random));
    ticks.back().tick = i;
    ticks.back().stamp_ns = static_cast<std::int64_t>(i) * period_ms * 1'000'000;
  }
  return ticks;
}

/// A tick in which all numbers are small and none is the same as another.
inline TickRecord plain_tick(std::uint64_t number) {
  TickRecord record{.tick = number, .stamp_ns = static_cast<std::int64_t>(number) * 1'000'000};
  record.counts = {1, -2, static_cast<std::int32_t>(number)};
  record.q_rad = {0.1, 0.2, 1e-3 * static_cast<double>(number)};
  return record;
}

/// The numbers of a record as bits, so that −0 is not 0.
inline std::vector<std::uint64_t> bits_of(const TickRecord& record) {
  std::vector<std::uint64_t> bits;
  for_each_field(record, [&](const Field&, const auto& value) {
    using Value = std::remove_cvref_t<decltype(value)>;
    if constexpr (std::integral<Value>) {
      bits.push_back(static_cast<std::uint64_t>(value));
    } else if constexpr (std::same_as<Value, double>) {
      bits.push_back(std::bit_cast<std::uint64_t>(value));
    } else if constexpr (std::same_as<Value, Vector3>) {
      for (const double number : value) {
        bits.push_back(std::bit_cast<std::uint64_t>(number));
      }
    } else {
      for (const std::int32_t number : value) {
        bits.push_back(static_cast<std::uint64_t>(number));
      }
    }
  });
  return bits;
}

/// @returns whether `ticks` are the first of `all`, bit for bit.
inline bool begin_with(const std::vector<TickRecord>& all, const std::vector<TickRecord>& ticks) {
  if (ticks.size() > all.size()) return false;
  for (std::size_t i = 0; i < ticks.size(); ++i) {
    if (bits_of(ticks[i]) != bits_of(all[i])) return false;
  }
  return true;
}

inline void write_log(const LogWriter::Config& config, const std::vector<TickRecord>& ticks) {
  LogWriter writer{config};
  for (const TickRecord& tick : ticks) {
    writer.append(tick);
  }
  writer.close();
}

inline Bytes bytes_of_file(const std::filesystem::path& path) {
  std::ifstream stream{path, std::ios::binary};
  Bytes bytes(std::filesystem::file_size(path));
  stream.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  return bytes;
}

inline void write_file(const std::filesystem::path& path, ByteView bytes) {
  std::ofstream stream{path, std::ios::binary};
  stream.write(reinterpret_cast<const char*>(bytes.data()),
               static_cast<std::streamsize>(bytes.size()));
}

}  // namespace teleop::testing
