#include "core/recording/csv.hpp"

#include <iterator>
#include <ostream>
#include <type_traits>

#include <fmt/format.h>

namespace teleop {
namespace {

/// Calls visit(index, number) for every number of a field; the index of a scalar is negative.
template <class Visitor>
void for_each_number(const auto& value, Visitor&& visit) {
  if constexpr (std::is_arithmetic_v<std::remove_cvref_t<decltype(value)>>) {
    visit(-1, value);
  } else {
    int index = 0;
    for (const auto number : value) {
      visit(index++, number);
    }
  }
}

/// arm_flags that some record has.
std::uint32_t flags_of(const Log& log) {
  std::uint32_t flags = 0;
  for (const TickRecord& tick : log.ticks) {
    flags |= tick.arm_flags;
  }
  return flags;
}

void end_line(fmt::memory_buffer& line, std::ostream& out) {
  line.data()[line.size() - 1] = '\n';  // in place of the last comma
  out.write(line.data(), static_cast<std::streamsize>(line.size()));
  line.clear();
}

}  // namespace

void export_csv(const Log& log, std::ostream& out) {
  fmt::memory_buffer line;
  const auto end = std::back_inserter(line);
  const std::uint32_t flags = flags_of(log);
  const auto is_column = [flags](const Field& field) {
    return field.only_with == 0 || (field.only_with & flags) != 0;
  };
  const TickRecord names;
  for_each_field(names, [&](const Field& field, const auto& value) {
    if (!is_column(field)) return;
    for_each_number(value, [&](int index, auto) {
      fmt::format_to(end, "{}", field.name);
      if (index >= 0) fmt::format_to(end, "[{}]", index);
      line.push_back(',');
    });
  });
  end_line(line, out);
  for (const TickRecord& tick : log.ticks) {
    for_each_field(tick, [&](const Field& field, const auto& value) {
      if (!is_column(field)) return;
      for_each_number(value, [&](int, auto number) { fmt::format_to(end, "{},", number); });
    });
    end_line(line, out);
  }
}

}  // namespace teleop
