// Closing missing samples up shifts the phase of every line behind them, and many shifts smear it
// over the spectrum. So a missing sample is drawn from what those around it allow,
//   y_t = m_J + sum_j beta_j (m_{j-1} - m_j) + r,    m_j the mean of the samples at most 4^j away,
// beta by least squares over the record (all 0 for white noise, 1 for a slow signal: a Wiener filter
// by octaves, so that the covariance with what is around stays that of the record) and r the
// residual of a place nearby (a bootstrap, Efron 1979).
#include "libchar/fit/detail/band/bridge.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>

#include "libchar/core/numeric/present.hpp"

namespace libchar {
namespace {

constexpr std::size_t kLongestBridge = 16;
constexpr double kMostBridged = 0.05;
constexpr std::array<std::size_t, 7> kReaches = {1, 4, 16, 64, 256, 1024, 4096};
constexpr int kBands = static_cast<int>(kReaches.size()) - 1;
constexpr std::size_t kRegressionPlaces = 32768;

struct MissingRun {
  std::size_t first = 0, end = 0;
};

/// Runs short enough, with present samples at both ends; empty when they are too many.
std::vector<MissingRun> short_runs(std::span<const double> record) {
  std::vector<MissingRun> runs;
  std::size_t count = 0;
  for (std::size_t t = 0; t < record.size(); ++t) {
    t += present_run(record.subspan(t));
    const std::size_t first = t;
    while (t < record.size() && std::isnan(record[t])) ++t;
    if (first == 0 || t >= record.size() || t - first > kLongestBridge) continue;
    runs.push_back({first, t});
    count += t - first;
  }
  if (static_cast<double>(count) > kMostBridged * static_cast<double>(record.size())) runs.clear();
  return runs;
}

class Bridge {
 public:
  explicit Bridge(std::span<const double> record) : record_(record) {
    for (const double value : record)
      if (!std::isnan(value)) {
        origin_ = value;
        break;
      }
    sums_.reserve(record.size() + 1);
    counts_.reserve(record.size() + 1);
    sums_.push_back(0);
    counts_.push_back(0);
    for (const double value : record) {
      const bool there = !std::isnan(value);
      sums_.push_back(sums_.back() + (there ? value - origin_ : 0));
      counts_.push_back(counts_.back() + there);
    }
    learn();
  }

  void fill(MissingRun run, std::span<double> out) {
    const auto from = source(run);
    if (!from) return;
    for (std::size_t i = 0; i < run.end - run.first; ++i) {
      const std::size_t there = *from + i;
      out[run.first + i] = expected(run.first + i) + record_[there] - expected(there);
    }
  }

 private:
  using Bands = Eigen::Matrix<double, kBands, 1>;
  struct Around {
    Bands band = Bands::Zero();  ///< m_{j-1} - m_j
    double level = 0;            ///< m_J
  };

  /// The means around t, itself left out; one without a sample is that of the next reach.
  Around around(std::size_t t) const {
    std::array<double, kReaches.size()> mean{};
    for (std::size_t j = kReaches.size(); j-- > 0;) {
      const std::size_t first = t > kReaches[j] ? t - kReaches[j] : 0,
                        end = std::min(record_.size(), t + kReaches[j] + 1);
      const bool there = !std::isnan(record_[t]);
      const double count = static_cast<double>(counts_[end] - counts_[first]) - (there ? 1 : 0);
      const double sum = sums_[end] - sums_[first] - (there ? record_[t] - origin_ : 0);
      mean[j] = count > 0 ? origin_ + sum / count : j + 1 < kReaches.size() ? mean[j + 1] : origin_;
    }
    Around out;
    for (int j = 0; j < kBands; ++j)
      out.band[j] = mean[static_cast<std::size_t>(j)] - mean[static_cast<std::size_t>(j) + 1];
    out.level = mean.back();
    return out;
  }

  double expected(std::size_t t) const {
    const Around at = around(t);
    return at.level + beta_.dot(at.band);
  }

  void learn() {
    Eigen::Matrix<double, kBands, kBands> normal = Eigen::Matrix<double, kBands, kBands>::Zero();
    Bands right = Bands::Zero();
    const std::size_t stride = std::max<std::size_t>(1, record_.size() / kRegressionPlaces);
    for (std::size_t t = 1; t + 1 < record_.size(); t += stride) {
      if (!present(t, 1)) continue;
      const Around at = around(t);
      normal += at.band * at.band.transpose();
      right += (record_[t] - at.level) * at.band;
    }
    normal.diagonal().array() += 1e-12 * normal.trace();
    const auto solver = normal.ldlt();
    if (normal.trace() > 0) beta_ = solver.solve(right);
  }

  /// Are n samples from t and both neighbours there?
  bool present(std::size_t t, std::size_t n) const {
    return t >= 1 && t + n < record_.size() && counts_[t + n + 1] - counts_[t - 1] == n + 2;
  }

  /// A whole stretch as long as the run, 40 to 1063 samples away.
  std::optional<std::size_t> source(MissingRun run) {
    const std::size_t n = run.end - run.first;
    for (int attempt = 0; attempt < 32; ++attempt) {
      state_ = state_ * 6364136223846793005U + 1442695040888963407U;
      const auto distance = 40 + static_cast<std::size_t>(state_ >> 54U);
      const bool behind = ((state_ >> 40U) & 1U) != 0;
      if (behind && run.first < distance) continue;
      const std::size_t from = behind ? run.first - distance : run.first + distance;
      if (present(from, n)) return from;
    }
    return std::nullopt;
  }

  std::span<const double> record_;
  double origin_ = 0;  ///< the first sample, so that an offset costs the sums no digits
  std::vector<double> sums_;
  std::vector<std::size_t> counts_;
  Bands beta_ = Bands::Zero();
  std::uint64_t state_ = 1;
};

}  // namespace

std::vector<double> bridged(std::span<const double> record) {
  const std::vector<MissingRun> runs = short_runs(record);
  if (runs.empty()) return {};
  std::vector<double> out(record.begin(), record.end());
  Bridge bridge(record);
  for (const MissingRun& run : runs) bridge.fill(run, out);
  return out;
}

}  // namespace libchar
