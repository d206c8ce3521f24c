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
#include "libchar/fit/remedies.hpp"

namespace libchar {
namespace {

constexpr std::size_t kLongestBridge = 16;
constexpr double kMostBridged = 0.05, kMostOfPhase = 0.75;
constexpr std::size_t kLongestOfPhase = 8;  ///< part of the record
constexpr std::array<std::size_t, 7> kReaches = {1, 4, 16, 64, 256, 1024, 4096};
constexpr int kBands = static_cast<int>(kReaches.size()) - 1;
constexpr std::size_t kRegressionPlaces = 32768;

struct MissingRun {
  std::size_t first = 0, end = 0;
};

/// Runs of `longest` at most, with present samples at both ends; empty when they are too many.
std::vector<MissingRun> short_runs(std::span<const double> record, std::size_t longest, double most) {
  std::vector<MissingRun> runs;
  std::size_t count = 0;
  for (std::size_t t = 0; t < record.size(); ++t) {
    t += present_run(record.subspan(t));
    const std::size_t first = t;
    while (t < record.size() && std::isnan(record[t])) ++t;
    if (first == 0 || t >= record.size() || t - first > longest) continue;
    runs.push_back({first, t});
    count += t - first;
  }
  if (static_cast<double>(count) > most * static_cast<double>(record.size())) runs.clear();
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

  bool fill(MissingRun run, std::span<double> out) {
    const auto from = source(run);
    if (!from) return false;
    for (std::size_t i = 0; i < run.end - run.first; ++i) {
      const std::size_t there = *from + i;
      out[run.first + i] = expected(run.first + i) + record_[there] - expected(there);
    }
    return true;
  }

  /// A long run takes the way that a stretch as long takes between its ends: of a phase with white frequency noise the
  /// conditional draw itself.
  bool lead_over(MissingRun run, std::span<double> out) {
    const std::size_t n = run.end - run.first;
    const auto from = source(run);
    if (!from) return false;
    const auto beside = [&](std::size_t before, std::size_t after, std::size_t i) {
      const double share = static_cast<double>(i + 1) / static_cast<double>(n + 1);
      return record_[before] + share * (record_[after] - record_[before]);
    };
    for (std::size_t i = 0; i < n; ++i)
      out[run.first + i] = beside(run.first - 1, run.end, i) + record_[*from + i] - beside(*from - 1, *from + n, i);
    return true;
  }

  double expected(std::size_t t) const {
    const Around at = around(t);
    return at.level + beta_.dot(at.band);
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

  /// A whole stretch as long as the run, 40 to 1063 samples away; of a long one as much further as it is long.
  std::optional<std::size_t> source(MissingRun run) {
    const std::size_t n = run.end - run.first, further = n > kLongestBridge ? n : 0;
    for (int attempt = 0; attempt < 32; ++attempt) {
      state_ = state_ * 6364136223846793005U + 1442695040888963407U;
      const auto distance = 40 + further + static_cast<std::size_t>(state_ >> 54U);
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
  const std::vector<MissingRun> runs = short_runs(record, kLongestBridge, kMostBridged);
  if (runs.empty()) return {};
  std::vector<double> out(record.begin(), record.end());
  Bridge bridge(record);
  for (const MissingRun& run : runs) bridge.fill(run, out);
  return out;
}

/// Readings over which a phase walks as far as its own noise is wide: white frequency noise N and white phase noise q
/// have the variances N² + 2 q² of first and 2 N² + 6 q² of second differences. Beyond, a draw about the level would
/// leave a step at each end; below, a way between two noisy ends would spread their noise.
static double width_of_noise(std::span<const double> phase) {
  constexpr double kFar = 4, kLeastShare = 1e-3;
  double first = 0, second = 0;
  for (std::size_t t = 2; t < phase.size(); ++t) {
    const double step = phase[t] - phase[t - 1], bend = step - (phase[t - 1] - phase[t - 2]);
    if (std::isnan(bend)) continue;
    first += step * step;
    second += bend * bend;
  }
  const double of_phase = std::max(0.0, second - 2 * first) / 2;
  return kFar * of_phase / std::max(first - 2 * of_phase, kLeastShare * first);
}

void detail::bridge_phase(std::vector<double>& phase) {
  const std::vector<MissingRun> runs = short_runs(phase, phase.size() / kLongestOfPhase, kMostOfPhase);
  if (runs.empty()) return;
  const auto is_there = [](double value) { return !std::isnan(value); };
  const auto first = std::find_if(phase.begin(), phase.end(), is_there) - phase.begin();
  const auto last = phase.rend() - std::find_if(phase.rbegin(), phase.rend(), is_there) - 1;
  // The offset in frequency: a mean over readings on one side of a place is none for it.
  const double origin = phase[static_cast<std::size_t>(first)];
  const double slope = (phase[static_cast<std::size_t>(last)] - origin) / static_cast<double>(last - first);
  const auto line = [&](std::size_t t) {
    return origin + slope * (static_cast<double>(t) - static_cast<double>(first));
  };
  std::vector<double> level(phase.size());
  for (std::size_t t = 0; t < phase.size(); ++t) level[t] = phase[t] - line(t);
  std::vector<double> filled = level;
  const double width = width_of_noise(level);
  Bridge bridge(level);
  for (const MissingRun& run : runs) {
    const std::size_t length = run.end - run.first;
    const bool walks = length > 1 && static_cast<double>(length) > width;
    const bool whole = walks ? bridge.lead_over(run, filled) : bridge.fill(run, filled);
    for (std::size_t t = run.first; t < run.end; ++t) {
      // Where as long a stretch is nowhere around, one by one.
      if (!whole && !bridge.fill({t, t + 1}, filled)) filled[t] = bridge.expected(t);
      phase[t] = filled[t] + line(t);
    }
  }
}

}  // namespace libchar
