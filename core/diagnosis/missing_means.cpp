#include "core/diagnosis/missing_means.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include "core/math/random.hpp"

namespace teleop {
namespace {

constexpr std::uint64_t kSeed = 1;
constexpr int kDraws = 200;

struct BlockSum {
  std::size_t cell = 0;
  double sum = 0.0;
  double rows = 0.0;
};

}  // namespace

bool MissingMean::significant() const noexcept {
  constexpr std::size_t kFewestBlocks = 4;
  constexpr double kFar = 2.6;  // two-sided 1 %
  return blocks >= kFewestBlocks && std::abs(mean) > kFar * deviation;
}

std::vector<MissingMean> block_means(const std::vector<CellSample>& samples,
                                     std::size_t cells,
                                     std::size_t blocks) {
  std::vector<std::vector<BlockSum>> sums(blocks);
  std::vector<MissingMean> means(cells);
  std::vector<double> totals(cells, 0.0);
  for (const CellSample& each : samples) {
    std::vector<BlockSum>& own = sums[each.block];
    auto place = std::find_if(own.begin(), own.end(),
                              [&](const BlockSum& other) { return other.cell == each.cell; });
    if (place == own.end()) place = own.insert(own.end(), {.cell = each.cell});
    place->sum += each.value;
    place->rows += 1.0;
    totals[each.cell] += each.value;
    ++means[each.cell].rows;
  }
  for (const std::vector<BlockSum>& own : sums) {
    for (const BlockSum& each : own) {
      ++means[each.cell].blocks;
    }
  }
  for (std::size_t c = 0; c < cells; ++c) {
    if (means[c].rows > 0) means[c].mean = totals[c] / static_cast<double>(means[c].rows);
  }
  Random random{kSeed};
  std::vector<double> squares(cells, 0.0);
  std::vector<double> drawn(cells, 0.0);
  for (int draw = 0; draw < kDraws; ++draw) {
    std::vector<double> sum(cells, 0.0);
    std::vector<double> rows(cells, 0.0);
    for (std::size_t b = 0; b < blocks; ++b) {
      const auto taken = static_cast<std::size_t>(random.uniform() * static_cast<double>(blocks));
      for (const BlockSum& each : sums[taken]) {
        sum[each.cell] += each.sum;
        rows[each.cell] += each.rows;
      }
    }
    for (std::size_t c = 0; c < cells; ++c) {
      if (rows[c] <= 0.0) continue;
      const double off = sum[c] / rows[c] - means[c].mean;
      squares[c] += off * off;
      drawn[c] += 1.0;
    }
  }
  for (std::size_t c = 0; c < cells; ++c) {
    if (drawn[c] > 0.0) means[c].deviation = std::sqrt(squares[c] / drawn[c]);
  }
  return means;
}

std::vector<double> even_edges(std::vector<double> values, std::size_t bins) {
  std::sort(values.begin(), values.end());
  std::vector<double> edges;
  edges.reserve(bins);
  for (std::size_t b = 1; b < bins && !values.empty(); ++b) {
    const double edge = values[b * values.size() / bins];
    if (edges.empty() || edge > edges.back()) edges.push_back(edge);
  }
  return edges;
}

std::vector<double> whitened_spectrum(const std::vector<std::vector<double>>& runs,
                                      double period_s,
                                      const std::vector<double>& f_Hz) {
  constexpr std::size_t kSegment = 1024;
  std::vector<double> window(kSegment);
  double power = 0.0;
  for (std::size_t k = 0; k < kSegment; ++k) {
    const double s = std::sin(std::numbers::pi * static_cast<double>(k) / kSegment);
    window[k] = s * s;
    power += window[k] * window[k];
  }
  std::vector<double> sums(f_Hz.size(), 0.0);
  double segments = 0.0;
  for (const std::vector<double>& w : runs) {
    for (std::size_t first = 0; first + kSegment <= w.size(); first += kSegment / 2) {
      segments += 1.0;
      for (std::size_t i = 0; i < f_Hz.size(); ++i) {
        const std::complex<double> turn =
            std::polar(1.0, -2.0 * std::numbers::pi * f_Hz[i] * period_s);
        std::complex<double> phase{1.0, 0.0};
        std::complex<double> sum{0.0, 0.0};
        for (std::size_t k = 0; k < kSegment; ++k) {
          sum += window[k] * w[first + k] * phase;
          phase *= turn;
        }
        sums[i] += std::norm(sum);
      }
    }
  }
  for (double& each : sums) {
    each /= std::max(segments, 1.0) * power;
  }
  return sums;
}

}  // namespace teleop
