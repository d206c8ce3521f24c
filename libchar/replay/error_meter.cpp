// RMSE = sqrt(sum e^2 / n). ln RMSE is half the logarithm of a mean of squares, so a cell of n_k samples moves it by
//   z_k = (sum e^2 - n_k RMSE^2) K / (2 n RMSE^2),   the mean of z over the K cells is 0;
// how well that mean is known (detail/judge/mean_uncertainty.hpp) is how well ln RMSE is. For ratios it
// is the difference of two such series: what both errors have in common cancels.
#include "libchar/replay/error_meter.hpp"

#include <algorithm>
#include <cmath>

#include "libchar/core/not_known.hpp"
#include "libchar/core/numeric/distributions.hpp"
#include "libchar/replay/detail/judge/mean_uncertainty.hpp"

namespace libchar {
namespace {

constexpr std::size_t kMostCells = 4096;

ErrorCell merged(const ErrorCell& a, const ErrorCell& b) {
  return {a.n + b.n, a.sum + b.sum, a.squares + b.squares, std::max(a.maximum, b.maximum), a.missing + b.missing};
}

ErrorCell total(const std::vector<ErrorCell>& cells) {
  ErrorCell all;
  for (const ErrorCell& cell : cells) all = merged(all, cell);
  return all;
}

double rms(const ErrorCell& cell) { return cell.n > 0 ? std::sqrt(cell.squares / cell.n) : kNone; }

// Sums before each cell.
std::vector<ErrorCell> cumulated(const std::vector<ErrorCell>& cells) {
  std::vector<ErrorCell> sums(cells.size() + 1);
  for (std::size_t i = 0; i < cells.size(); ++i) sums[i + 1] = merged(sums[i], cells[i]);
  return sums;
}

/// Adds `share` of what each cell moves ln RMS by.
void add_influence(const std::vector<ErrorCell>& cells, double share, std::vector<double>& z) {
  const ErrorCell all = total(cells);
  const double mean_square = all.squares / all.n;
  if (!(mean_square > 0)) return;
  const double scale = share * static_cast<double>(cells.size()) / (2 * all.n * mean_square);
  for (std::size_t k = 0; k < cells.size(); ++k) z[k] += scale * (cells[k].squares - cells[k].n * mean_square);
}

std::vector<double> influence(const Meters& meters) {
  std::vector<double> z(meters.empty() ? 0 : meters[0]->cells().size(), 0.0);
  for (const ErrorMeter* meter : meters) add_influence(meter->cells(), 1 / static_cast<double>(meters.size()), z);
  return z;
}

std::vector<double> cell_means(const std::vector<ErrorCell>& cells, double otherwise) {
  std::vector<double> means;
  means.reserve(cells.size());
  for (const ErrorCell& cell : cells) means.push_back(cell.n > 0 ? cell.sum / cell.n : otherwise);
  return means;
}

double log_geometric_mean(const Meters& meters) {
  double sum = 0;
  for (const ErrorMeter* meter : meters) sum += std::log(rms(total(meter->cells())));
  return sum / static_cast<double>(meters.size());
}

/// Takes the mean of each stretch out.
void centre(const ErrorMeter& meter, const ScoreOptions& options, std::vector<double>& z) {
  std::vector<std::size_t> edges = {0};
  for (const std::int64_t start : options.sections) {
    const auto cell =
        static_cast<std::size_t>(std::max<std::int64_t>(start, 0)) / static_cast<std::size_t>(meter.cell_samples());
    if (cell > edges.back() && cell < z.size()) edges.push_back(cell);
  }
  edges.push_back(z.size());
  for (std::size_t i = 0; i + 1 < edges.size(); ++i) {
    double mean = 0;
    for (std::size_t k = edges[i]; k < edges[i + 1]; ++k) mean += z[k] / static_cast<double>(edges[i + 1] - edges[i]);
    for (std::size_t k = edges[i]; k < edges[i + 1]; ++k) z[k] -= mean;
  }
}

/// Beyond this slope the slow part grows with time; flicker is at 0 +- 0.25 in 95 % of records.
constexpr double kWalks = 0.25;
/// Between the slopes of an error whose correlation ends (-1) and of flicker (0).
constexpr double kNeverEnds = -0.5;
/// Beyond this slope a walk may begin to show: what it does later is not seen yet.
constexpr double kWanders = 0.1;
/// The variance of a mean that is extrapolated may be so many times too large.
constexpr double kLeastOfMean = 6;
constexpr double kEqualMean = 1e-9;  // of the square that is left without it, at least

/// Of ln RMSE. Where the error does not end the square of the record's own mean m is one draw, with one degree of
/// freedom, of what others have, and no batch shows it. Others may have more, by how far their means reach; less by no
/// more than m, which is known. A walk may begin to show, and then nothing is known.
Interval reach_of(const std::vector<double>& z, const MeanUncertainty& spread, const MeanUncertainty& bias,
                  double slope, const ErrorScore& of) {
  if (!bias.long_memory || !(slope > kNeverEnds)) return {-spread.reach95, spread.reach95};
  const double square = of.rmse * of.rmse;
  const double high = std::hypot(spread.reach95, bias.reach95 * bias.reach95 / (2 * square));
  if (slope > kWanders) return {-high, high};
  const double without = 1 - (of.bias * of.bias - bias.sd * bias.sd / kLeastOfMean) / square;
  const double less = without < 1 ? std::log(std::max(without, kEqualMean)) / 2 : 0;
  return {-std::hypot(mean_uncertainty(z, 0.05, 2 * kEndless).reach95, less), high};
}

void add_intervals(const ErrorMeter& meter, const ScoreOptions& options, ErrorScore& out) {
  const std::vector<ErrorCell> cells = meter.cells();
  std::vector<double> z(cells.size(), 0.0);
  add_influence(cells, 1, z);
  std::vector<double> means = cell_means(cells, out.bias);
  for (std::vector<double>* series : {&z, &means}) centre(meter, options, *series);
  const MeanUncertainty spread = mean_uncertainty(z), bias = mean_uncertainty(means);
  const double slope = slow_slope(means);
  out.stationary = !(spread.long_memory && slope > kWalks);
  if (!out.stationary) return;
  const Interval reach = reach_of(z, spread, bias, slope, out);
  out.rmse_ci95 = {out.rmse * std::exp(reach.low), out.rmse * std::exp(reach.high)};
  if (!(bias.long_memory && slope > kWalks)) out.bias_ci95 = {out.bias - bias.reach95, out.bias + bias.reach95};
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
      for (std::size_t i = 0; i < kMostCells / 2; ++i) cells_[i] = merged(cells_[2 * i], cells_[2 * i + 1]);
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

std::uint64_t ErrorMeter::cell_samples_of(std::uint64_t samples) {
  std::uint64_t cell = 1;
  while (cell * kMostCells < samples) cell *= 2;
  return cell;
}

ErrorMeter ErrorMeter::where_known(const ErrorMeter& other) const {
  ErrorMeter out = *this;
  for (std::size_t k = 0; k < std::min(out.cells_.size(), other.cells_.size()); ++k)
    if (other.cells_[k].n == 0) out.cells_[k] = {0, 0, 0, 0, out.cells_[k].n + out.cells_[k].missing};
  return out;
}

std::vector<ErrorCell> ErrorMeter::cells() const { return cells_; }

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
  if (options.intervals) add_intervals(meter, options, out);
  out.converged_s = convergence(cells, static_cast<double>(meter.cell_samples()) / rate_hz);
  return out;
}

GeometricRms geometric_rms(const Meters& meters, const ScoreOptions& options) {
  if (meters.empty()) return {kNone, {kNone, kNone}};
  const double rms_of_all = std::exp(log_geometric_mean(meters));
  std::vector<double> z = influence(meters);
  centre(*meters[0], options, z);
  const double reach = mean_uncertainty(z).reach95;
  return {rms_of_all, {rms_of_all * std::exp(-reach), rms_of_all * std::exp(reach)}};
}

double larger_throughout(const Meters& a, const Meters& b) {
  constexpr std::size_t kStretches = 16;
  if (a.empty() || b.empty()) return 1;
  const auto of_stretch = [](const Meters& meters, std::size_t k) {
    double sum = 0;
    for (const ErrorMeter* meter : meters) {
      const std::vector<ErrorCell> cells = meter->cells();
      const auto from = static_cast<std::ptrdiff_t>(k * cells.size() / kStretches),
                 to = static_cast<std::ptrdiff_t>((k + 1) * cells.size() / kStretches);
      sum += std::log(rms(total({cells.begin() + from, cells.begin() + to})));
    }
    return sum / static_cast<double>(meters.size());
  };
  int larger = 0, unlike = 0;
  for (std::size_t k = 0; k < kStretches; ++k) {
    const double difference = of_stretch(a, k) - of_stretch(b, k);
    larger += difference > 0;
    unlike += difference > 0 || difference < 0;
  }
  if (larger == 0) return 1;
  return binomial_tail(larger - 1, unlike, 0.5);
}

Interval rms_ratio_interval(const Meters& a, const Meters& b, const ScoreOptions& options, double level) {
  std::vector<double> z = influence(a);
  const std::vector<double> other = influence(b);
  if (z.size() != other.size() || z.empty()) return {kNone, kNone};
  for (std::size_t k = 0; k < z.size(); ++k) z[k] -= other[k];
  centre(*a[0], options, z);
  const double ratio = log_geometric_mean(a) - log_geometric_mean(b);
  const double reach = mean_uncertainty(z, level).reach95;
  return {std::exp(ratio - reach), std::exp(ratio + reach)};
}

}  // namespace libchar
