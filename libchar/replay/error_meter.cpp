// RMSE = sqrt(sum e^2 / n). Its interval: moving-block bootstrap (H. R. Künsch, Ann. Stat. 17
// (1989) 1217): stretches of record/blocks consecutive samples, starting anywhere, are drawn with
// replacement until the record is full; percentiles of the resampled RMSE. Stretches run on from
// the end at the beginning (Politis & Romano 1992), or both ends, where filters settle, would be
// drawn too seldom. Errors are correlated in time, and a stretch keeps their correlation. Cells are
// the grain at which stretches begin.
#include "libchar/replay/error_meter.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "libchar/core/not_known.hpp"
#include "libchar/simulate/random.hpp"

namespace libchar {
namespace {

constexpr std::size_t kMostCells = 4096;

ErrorCell merged(const ErrorCell& a, const ErrorCell& b) {
  return {a.n + b.n,
          a.sum + b.sum,
          a.squares + b.squares,
          std::max(a.maximum, b.maximum),
          a.missing + b.missing};
}

ErrorCell total(const std::vector<ErrorCell>& cells) {
  ErrorCell all;
  for (const ErrorCell& cell : cells) all = merged(all, cell);
  return all;
}

double rms(const ErrorCell& cell) {
  return cell.n > 0 ? std::sqrt(cell.squares / cell.n) : kNone;
}

// Starts of the stretches of one replicate; drawn alike for every meter of one length.
class Resampler {
 public:
  Resampler(std::size_t cells, const ScoreOptions& options)
      : cells_(cells),
        length_(std::max<std::size_t>(1, cells / std::max<std::size_t>(options.blocks, 1))),
        deviates_({options.seed, 0, Purpose::bootstrap}) {}
  const std::vector<std::size_t>& draw() {
    starts_.clear();
    const double places = static_cast<double>(cells_);
    for (std::size_t filled = 0; filled < cells_; filled += length_)
      starts_.push_back(static_cast<std::size_t>(deviates_.uniform() * places));
    return starts_;
  }
  std::size_t length() const { return length_; }

 private:
  std::size_t cells_, length_;
  DeviateStream deviates_;
  std::vector<std::size_t> starts_;
};

// Sums before each cell, the record once round and once more: a stretch is a difference.
std::vector<ErrorCell> cumulated(const std::vector<ErrorCell>& cells) {
  std::vector<ErrorCell> sums(2 * cells.size() + 1);
  for (std::size_t i = 0; i + 1 < sums.size(); ++i)
    sums[i + 1] = merged(sums[i], cells[i % cells.size()]);
  return sums;
}

ErrorCell of_stretches(const std::vector<ErrorCell>& sums,
                       const std::vector<std::size_t>& starts,
                       std::size_t length) {
  ErrorCell all;
  for (const std::size_t start : starts) {
    const ErrorCell &a = sums[start], &b = sums[start + length];
    all.n += b.n - a.n;
    all.sum += b.sum - a.sum;
    all.squares += b.squares - a.squares;
  }
  return all;
}

Interval percentiles(std::vector<double> values) {
  values.erase(std::remove_if(values.begin(), values.end(), [](double v) { return std::isnan(v); }),
               values.end());
  if (values.empty()) return {kNone, kNone};
  std::sort(values.begin(), values.end());
  const auto at = [&](double p) {
    const double position = p * static_cast<double>(values.size() - 1);
    const auto below = static_cast<std::size_t>(position);
    const double rest = position - static_cast<double>(below);
    return below + 1 < values.size() ? values[below] + rest * (values[below + 1] - values[below])
                                     : values.back();
  };
  return {at(0.025), at(0.975)};
}

// The final level is the RMS of the second half; windows are a fiftieth of the record.
double convergence(const std::vector<ErrorCell>& cells, double cell_s) {
  const std::size_t window = std::max<std::size_t>(1, cells.size() / 50);
  if (cells.size() < 4 * window) return kNone;
  const auto sums = cumulated(cells);
  const auto level = [&](std::size_t from, std::size_t to) {
    return std::sqrt((sums[to].squares - sums[from].squares) / (sums[to].n - sums[from].n));
  };
  const double final_level = level(cells.size() / 2, cells.size());
  std::size_t settled = 0;
  for (std::size_t from = 0; from + window <= cells.size() / 2; ++from) {
    const double here = level(from, from + window);
    if (!(here <= 1.1 * final_level)) settled = from + 1;
  }
  return settled + window > cells.size() / 2 ? kNone : static_cast<double>(settled) * cell_s;
}

}  // namespace

void ErrorMeter::put(double error) {
  if (in_last_ == 0) {
    if (cells_.size() == kMostCells) {
      for (std::size_t i = 0; i < kMostCells / 2; ++i)
        cells_[i] = merged(cells_[2 * i], cells_[2 * i + 1]);
      cells_.resize(kMostCells / 2);
      cell_samples_ *= 2;
    }
    cells_.emplace_back();
  }
  ErrorCell& cell = cells_.back();
  if (std::isnan(error)) {
    cell.missing += 1;
  } else {
    cell.n += 1;
    cell.sum += error;
    cell.squares += error * error;
    cell.maximum = std::max(cell.maximum, std::abs(error));
  }
  if (++in_last_ == cell_samples_) in_last_ = 0;
}

void ErrorMeter::push(std::span<const double> error) {
  for (const double e : error) put(e);
}

std::vector<ErrorCell> ErrorMeter::cells() const {
  return cells_;
}

ErrorScore score(const ErrorMeter& meter, double rate_hz, const ScoreOptions& options) {
  const std::vector<ErrorCell> cells = meter.cells();
  const ErrorCell all = total(cells);
  ErrorScore out;
  out.samples = static_cast<std::uint64_t>(all.n);
  out.rmse = rms(all);
  out.bias = all.n > 0 ? all.sum / all.n : kNone;
  out.deviation = std::sqrt(std::max(0.0, (out.rmse - out.bias) * (out.rmse + out.bias)));
  if (all.n == 0) out.deviation = kNone;
  out.maximum = all.n > 0 ? all.maximum : kNone;
  out.availability = all.n + all.missing > 0 ? all.n / (all.n + all.missing) : 0;
  out.rmse_ci95 = out.bias_ci95 = {kNone, kNone};
  out.converged_s = kNone;
  if (all.n == 0) return out;
  const auto sums = cumulated(cells);
  Resampler resampler(cells.size(), options);
  std::vector<double> rmses, biases;
  for (std::size_t r = 0; r < options.replicates; ++r) {
    const ErrorCell drawn = of_stretches(sums, resampler.draw(), resampler.length());
    rmses.push_back(rms(drawn));
    biases.push_back(drawn.n > 0 ? drawn.sum / drawn.n : kNone);
  }
  out.rmse_ci95 = percentiles(std::move(rmses));
  out.bias_ci95 = percentiles(std::move(biases));
  out.converged_s = convergence(cells, static_cast<double>(meter.cell_samples()) / rate_hz);
  return out;
}

Interval rmse_ratio_ci95(const ErrorMeter& a, const ErrorMeter& b, const ScoreOptions& options) {
  const auto cells_a = a.cells(), cells_b = b.cells();
  if (cells_a.size() != cells_b.size() || cells_a.empty()) return {kNone, kNone};
  const auto sums_a = cumulated(cells_a), sums_b = cumulated(cells_b);
  Resampler resampler(cells_a.size(), options);
  std::vector<double> ratios;
  for (std::size_t r = 0; r < options.replicates; ++r) {
    const auto& starts = resampler.draw();
    ratios.push_back(rms(of_stretches(sums_a, starts, resampler.length())) /
                     rms(of_stretches(sums_b, starts, resampler.length())));
  }
  return percentiles(std::move(ratios));
}

}  // namespace libchar
