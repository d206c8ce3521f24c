#include "libchar/fit/record/noise_powers.hpp"

#include <algorithm>
#include <array>
#include <memory>
#include <span>

#include "libchar/core/numeric/distributions.hpp"
#include "libchar/fit/detail/band/bin_likelihood.hpp"
#include "libchar/fit/detail/band/goodness.hpp"
#include "libchar/fit/detail/events/series_powers.hpp"
#include "libchar/fit/detail/record/ends.hpp"
#include "libchar/spectrum/fft.hpp"

namespace libchar {

namespace {

/// Log bins as of the noise fit: single coefficients to 24, then eight an octave.
std::vector<std::size_t> bin_edges(std::size_t n) {
  std::vector<std::size_t> edge;
  for (std::size_t k = 0; k < n; k = std::max(k + 1, static_cast<std::size_t>(static_cast<double>(k) * 1.0905)))
    edge.push_back(k);
  edge.push_back(n);
  return edge;
}

double mean_of(std::span<const double> values, std::size_t from, std::size_t to) {
  double sum = 0;
  for (std::size_t k = from; k < to; ++k) sum += values[k];
  return sum / static_cast<double>(to - from);
}

constexpr std::array kSeriesTerms = {Term::white, Term::flicker, Term::walk, Term::quantization};

/// What the noise terms of theta = 1 put into the coefficients of a series of a length, and into its bins: the same
/// whatever is taken out of the series.
struct SeriesUnits {
  std::size_t points = 0, per_point = 0;
  double step_s = 0;
  bool ends_free = false;
  bool of(const EventSeries& series) const {
    return points == series.value.size() && per_point == series.per_point && step_s == series.step_s &&
           ends_free == series.ends_free;
  }
  std::array<std::vector<double>, kSeriesTerms.size()> power;  ///< k = 1..n-1 at [k-1]
  std::vector<std::size_t> edge;
  std::vector<PowerBin> bins;  ///< without energies
};

double rate_of(const EventSeries& series) { return static_cast<double>(series.per_point) / series.step_s; }

SeriesUnits units_of(const EventSeries& series) {
  SeriesUnits units;
  units.points = series.value.size();
  units.per_point = series.per_point;
  units.step_s = series.step_s;
  units.ends_free = series.ends_free;
  std::vector<std::vector<double>> power =
      at_every_k(units.points, kSeriesTerms.size(), [&](double k, std::span<double> out) {
        auto unit = mean_unit_powers(k, units.points, series.per_point, 1 / rate_of(series));
        if (series.ends_free)
          unit[static_cast<std::size_t>(Term::quantization)] =
              detail::quantization_without_ends(k, units.points, series.step_s);
        for (std::size_t i = 0; i < kSeriesTerms.size(); ++i) out[i] = unit[static_cast<std::size_t>(kSeriesTerms[i])];
      });
  std::move(power.begin(), power.end(), units.power.begin());
  units.edge = bin_edges(units.points - 1);
  for (std::size_t b = 0; b + 1 < units.edge.size(); ++b) {
    PowerBin bin;
    bin.dof = static_cast<double>(units.edge[b + 1] - units.edge[b]);
    for (std::size_t i = 0; i < kSeriesTerms.size(); ++i)
      bin.unit[static_cast<std::size_t>(kSeriesTerms[i])] = mean_of(units.power[i], units.edge[b], units.edge[b + 1]);
    units.bins.push_back(bin);
  }
  return units;
}

/// Bins of a series for these terms, slow ones first.
std::vector<PowerBin> bins_of(const EventSeries& series, const SeriesUnits& units) {
  Dct dct(units.points);
  const std::span<const double> c = dct.transform(series.value).subspan(1);
  std::vector<double> square(c.size());
  for (std::size_t k = 0; k < c.size(); ++k) square[k] = c[k] * c[k];
  std::vector<PowerBin> bins = units.bins;
  for (std::size_t b = 0; b < bins.size(); ++b) bins[b].energy = mean_of(square, units.edge[b], units.edge[b + 1]);
  return bins;
}

EventSeries::Noise noise_of(const Mixture& theta, const SeriesUnits& units) {
  EventSeries::Noise noise{std::vector<double>(units.points - 1)};
  std::vector<double>& power = noise.power;
  for (std::size_t i = 0; i < kSeriesTerms.size(); ++i) {
    const double square = theta[static_cast<std::size_t>(kSeriesTerms[i])];
    for (std::size_t k = 0; k < power.size(); ++k) power[k] += square * units.power[i][k];
    if (kSeriesTerms[i] != Term::quantization || units.ends_free) continue;
    const double least = *std::min_element(power.begin(), power.end());
    if (least > 0) noise.ends = square * units.power[i][0] / least;
  }
  return noise;
}

/// Does the mixture describe the bins?
bool describes(const std::vector<PowerBin>& bins, const Mixture& theta) {
  constexpr double kProbability = 1e-3;
  double chi2 = 0;
  for (const PowerBin& bin : bins) {
    const double z = normal_deviate(bin.energy / expected_energy(bin, theta), bin.dof);
    chi2 += z * z;
  }
  return chi_square_tail(chi2, static_cast<double>(bins.size())) > kProbability;
}

}  // namespace

// From the slow end up: a filter's slope at the top has ten thousand coefficients and would bend the slow noise to its
// own use.
NoisePowers fitted_powers() {
  const auto kept = std::make_shared<SeriesUnits>();
  return [kept](const EventSeries& series) {
    constexpr std::size_t kFewestBins = 32, kHalfOctave = 4;
    if (!kept->of(series)) *kept = units_of(series);
    std::vector<PowerBin> bins = bins_of(series, *kept);
    // The slowest even and odd one went with the ends.
    if (series.ends_free) bins.erase(bins.begin(), bins.begin() + 2);
    const TermSet terms = {true, true, true, true, false};
    ScoringResult fit = score(bin_problem(bins), terms);
    while (bins.size() >= kFewestBins + kHalfOctave && !describes(bins, fit.at.theta)) {
      bins.resize(bins.size() - kHalfOctave);
      fit = score(bin_problem(bins), terms);
    }
    return noise_of(fit.at.theta, *kept);
  };
}

}  // namespace libchar
