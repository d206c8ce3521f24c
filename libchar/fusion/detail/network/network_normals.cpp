#include "libchar/fusion/detail/network/network_normals.hpp"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "libchar/core/numeric/lanes.hpp"

namespace libchar::fusion {
namespace {

constexpr std::size_t kPanel = 512;             // rows at once: half a megabyte with 140 parameters
constexpr std::size_t kAtOnce = 64;             // rows that are not worth sharing out
constexpr std::size_t kRows = 4, kColumns = 8;  // of the matrix that are summed in registers

/// Four rows of the sums, from row i on, and their columns on and right of the diagonal.
LIBCHAR_WIDE_LANES void add_rows(
    const double* panel, std::size_t rows, std::size_t width, std::size_t i, double* sums) {
  for (std::size_t j = i / kColumns * kColumns; j < width; j += kColumns) {
    double* const to = sums + i * width + j;
    Four a0 = LIBCHAR_FOUR(to), a1 = LIBCHAR_FOUR(to + 4);
    Four b0 = LIBCHAR_FOUR(to + width), b1 = LIBCHAR_FOUR(to + width + 4);
    Four c0 = LIBCHAR_FOUR(to + 2 * width), c1 = LIBCHAR_FOUR(to + 2 * width + 4);
    Four d0 = LIBCHAR_FOUR(to + 3 * width), d1 = LIBCHAR_FOUR(to + 3 * width + 4);
    for (const double* row = panel; row != panel + rows * width; row += width) {
      const Four right0 = LIBCHAR_FOUR(row + j), right1 = LIBCHAR_FOUR(row + j + 4);
      a0 += row[i] * right0;
      a1 += row[i] * right1;
      b0 += row[i + 1] * right0;
      b1 += row[i + 1] * right1;
      c0 += row[i + 2] * right0;
      c1 += row[i + 2] * right1;
      d0 += row[i + 3] * right0;
      d1 += row[i + 3] * right1;
    }
    LIBCHAR_FOUR_TO(to) = a0;
    LIBCHAR_FOUR_TO(to + 4) = a1;
    LIBCHAR_FOUR_TO(to + width) = b0;
    LIBCHAR_FOUR_TO(to + width + 4) = b1;
    LIBCHAR_FOUR_TO(to + 2 * width) = c0;
    LIBCHAR_FOUR_TO(to + 2 * width + 4) = c1;
    LIBCHAR_FOUR_TO(to + 3 * width) = d0;
    LIBCHAR_FOUR_TO(to + 3 * width + 4) = d1;
  }
}

void on_all_cores(std::size_t count, std::size_t grain, const auto& work) {
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, grain), [&](const auto& range) {
    for (std::size_t k = range.begin(); k != range.end(); ++k) work(k);
  });
}

}  // namespace

NetworkNormals::NetworkNormals(const TanhNetwork& network)
    : network_(network),
      width_((network.size() + 1 + kColumns - 1) / kColumns * kColumns),
      panel_(kPanel * width_),
      sums_(width_ * width_) {}

double NetworkNormals::squares(const TrainingRows& rows, const double* parameters) {
  errors_.resize(rows.count);
  on_all_cores(rows.count, kAtOnce, [&](std::size_t k) {
    const double* const z = rows.rows + k * (network_.inputs + 1);
    errors_[k] = network_.output(parameters, z) - z[network_.inputs];
  });
  double sum = 0;
  for (const double e : errors_) sum += e * e;
  return std::isfinite(sum) ? sum : std::numeric_limits<double>::infinity();
}

void NetworkNormals::fill(const TrainingRows& rows, std::size_t first, const double* parameters) {
  on_all_cores(std::min(kPanel, rows.count - first), kAtOnce, [&](std::size_t k) {
    const double* const z = rows.rows + (first + k) * (network_.inputs + 1);
    double* const row = panel_.data() + k * width_;
    row[network_.size()] = network_.output(parameters, z, row) - z[network_.inputs];
  });
}

bool NetworkNormals::linearise(const TrainingRows& rows, const double* parameters) {
  std::fill(sums_.begin(), sums_.end(), 0.0);
  for (std::size_t first = 0; first < rows.count; first += kPanel) {
    fill(rows, first, parameters);
    const std::size_t count = std::min(kPanel, rows.count - first);
    on_all_cores(width_ / kRows, 1, [&](std::size_t i) {
      add_rows(panel_.data(), count, width_, i * kRows, sums_.data());
    });
  }
  // A square that is no number stands on the diagonal: it marks whatever was none.
  for (std::size_t i = 0; i <= network_.size(); ++i)
    if (!std::isfinite(sums_[i * width_ + i])) return false;
  return true;
}

double NetworkNormals::curvature(Eigen::Index i, Eigen::Index j) const {
  return sums_[static_cast<std::size_t>(std::min(i, j)) * width_ +
               static_cast<std::size_t>(std::max(i, j))];
}

Eigen::VectorXd NetworkNormals::slope() const {
  Eigen::VectorXd out(static_cast<Eigen::Index>(network_.size()));
  for (Eigen::Index i = 0; i < out.size(); ++i)
    out[i] = curvature(i, static_cast<Eigen::Index>(network_.size()));
  return out;
}

}  // namespace libchar::fusion
