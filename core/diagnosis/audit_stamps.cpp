#include <algorithm>
#include <cmath>
#include <vector>

#include <fmt/format.h>

#include "core/diagnosis/audit_checks.hpp"

namespace teleop {
namespace {

constexpr double kRateTolerance = 0.002;  ///< of mean and median step, as a share of the period
constexpr double kLongStep = 1.5;         ///< periods
constexpr double kMuchJitter = 0.05;      ///< periods, RMS about an even grid
constexpr double kWorstJitter = 0.5;      ///< periods, of one row

double median_of(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// Stamps that stand still or go back. @returns whether there are such.
bool stands_still(const AuditNotes& notes, const std::vector<double>& t_s) {
  for (std::size_t k = 1; k < t_s.size(); ++k) {
    if (t_s[k] > t_s[k - 1]) continue;
    notes.add(Severity::fatal, "repeated_time", "t_s", k,
              fmt::format("{} after {}: time must increase; remove repeated rows, or split the run "
                          "there",
                          t_s[k], t_s[k - 1]));
    return true;
  }
  return false;
}

/// Rows that are missing: the steps across them stay long, as those around a late row do not.
bool has_gap(const AuditNotes& notes, const std::vector<double>& t_s, double period) {
  for (std::size_t k = 1; k < t_s.size(); ++k) {
    const double step = (t_s[k] - t_s[k - 1]) / period;
    const double around = k + 1 < t_s.size() ? (t_s[k + 1] - t_s[k - 1]) / period : step + 1.0;
    if (step <= kLongStep || around <= kLongStep + 1.0) continue;
    notes.add(
        Severity::fatal, "gap", "t_s", k,
        fmt::format("{:.6g} s after the row before, the period is {:.6g} s: rows are missing; "
                    "make two runs of it with start_s and stop_s",
                    step * period, period));
    return true;
  }
  return false;
}

void find_jitter(const AuditNotes& notes, const std::vector<double>& t_s, double period) {
  const double mean = (t_s.back() - t_s.front()) / static_cast<double>(t_s.size() - 1);
  double squares = 0.0;
  double worst = 0.0;
  std::size_t row = 0;
  for (std::size_t k = 0; k < t_s.size(); ++k) {
    const double off = (t_s[k] - t_s.front() - mean * static_cast<double>(k)) / period;
    squares += off * off;
    if (std::abs(off) > std::abs(worst)) {
      worst = off;
      row = k;
    }
  }
  const double rms = std::sqrt(squares / static_cast<double>(t_s.size()));
  if (rms < kMuchJitter && std::abs(worst) < kWorstJitter) return;
  notes.add(
      Severity::warning, "jitter", "t_s", row,
      fmt::format("time stamps are {:.0f} % of a period off an even grid (RMS), here {:.0f} %: "
                  "speeds are as uncertain",
                  100.0 * rms, 100.0 * worst));
}

}  // namespace

bool audit_stamps(const AuditNotes& notes) {
  const std::vector<double>& t_s = notes.run().t_s;
  const double period = notes.of().period_s;
  if (t_s.empty()) return true;  // nobody wrote any: rows are even by construction
  if (t_s.size() < 3) return false;
  if (stands_still(notes, t_s)) return false;
  std::vector<double> steps;
  steps.reserve(t_s.size());
  for (std::size_t k = 1; k < t_s.size(); ++k) {
    steps.push_back(t_s[k] - t_s[k - 1]);
  }
  const double median = median_of(std::move(steps));
  const double mean = (t_s.back() - t_s.front()) / static_cast<double>(t_s.size() - 1);
  const auto off = [&](double step) {
    return std::abs(step / period - 1.0) > kRateTolerance;
  };
  if (off(median) && off(mean)) {
    notes.add(Severity::fatal, "wrong_rate", "t_s", 1,
              fmt::format("time stamps are {:.6g} s apart, which is {:.6g} Hz, and the case says "
                          "sample_rate_Hz = {:.6g}: correct the one that is wrong",
                          mean, 1.0 / mean, 1.0 / period));
    return false;
  }
  if (has_gap(notes, t_s, period)) return false;
  find_jitter(notes, t_s, period);
  return true;
}

}  // namespace teleop
