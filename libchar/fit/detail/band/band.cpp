// A likelihood weighs every frequency by its information, and nearly all of that is at the top,
// where it concerns nothing but white noise: a small misfit there is paid for with the slow
// coefficients. So the noise terms are asked to hold from the slow end up to where they do,
// together with a shape, ln |H(f)|² = a_1 x + a_2 x² + …, x = (f / f_band)²: of any linear filter
// with a real impulse response it is even and analytic about f = 0, and |H(0)| = 1 by construction.
//   1. the whole spectrum, terms alone; 2. with quantization noise, or a filter known by name; 3.
//   cuts every half octave from the
//   top, orders 0..4 of the shape: the first that passes, with the orders that explain something and
//   two more, which take out the bias that "just passes" leaves;
//   4. where the band is cut: the same without the broad peaks, if that makes it wider.
// A band passes when the residuals of its bins (the slowest few aside, where drift lives) and of
// its top octave and a half are those of noise.
#include "libchar/fit/detail/band/band.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

#include "libchar/core/numeric/dense.hpp"
#include "libchar/core/numeric/distributions.hpp"
#include "libchar/core/numeric/median.hpp"
#include "libchar/fit/detail/band/bin_likelihood.hpp"
#include "libchar/fit/detail/band/goodness.hpp"
#include "libchar/fit/detail/record/dct_means.hpp"

namespace libchar {
namespace {

constexpr std::size_t kSlowest = 5;      ///< coefficients that a drift falls into
constexpr std::size_t kFewestBins = 20;  ///< of a band
constexpr double kTopOctaves = 1.5;
constexpr double kBandStep = 0.5;  ///< octaves
constexpr double kDeepCut = 0.25;  ///< of half the rate
/// Of half the rate: below it hardly a filter has more than the beginning of its slope, and a free
/// shape would take the place of slow noise.
constexpr double kDeepest = 0.125;
constexpr double kPeak = 4;              ///< standard deviations that a broad peak stands above its sides
constexpr double kFewestPeakDof = 16;    ///< of its bins
constexpr std::size_t kSkirt = 2;        ///< bins on each side of it that hold too much of it as well
constexpr std::size_t kMostLeftOut = 4;  ///< a quarter of the bins
constexpr std::array<std::uint64_t, 13> kTaps = {2, 3, 4, 5, 6, 8, 10, 12, 16, 20, 24, 32, 64};
constexpr double kNull = 0.01;  ///< of a filter's power gain
constexpr double kAsWide = 0.7;
constexpr auto kQuantizationTerm = static_cast<std::size_t>(Term::quantization);
constexpr auto kLentTerm = static_cast<std::size_t>(Term::ramp);  ///< to a Gauss-Markov process

double mean_ratio(const NoiseShape& filter, const PowerBin& bin, double rate_hz) {
  constexpr int kNodes = 17;
  double ratio = 0;
  for (int i = 0; i < kNodes; ++i) {
    const double f = bin.low_hz + (bin.high_hz - bin.low_hz) * (i + 0.5) / kNodes;
    ratio += shape_ratio(filter, std::min(f, rate_hz / 2), rate_hz) / kNodes;
  }
  return ratio;
}

/// The fit of a band that is being tried.
struct Trial {
  Band band;
  std::vector<std::size_t> index;  ///< of its bins among all
  std::vector<double> z, ratio;    ///< residuals, and measured over model
  ModelPoint best;
  Mixture theta{};  ///< of it
  double half_deviance = 0;
};

std::vector<std::size_t> members(const std::vector<PowerBin>& bins, const Band& band) {
  std::vector<std::size_t> index;
  for (std::size_t j = 0; j < bins.size(); ++j)
    if (band.inside[j] != 0) index.push_back(j);
  return index;
}

void judge_band(const std::vector<PowerBin>& bins, std::size_t fitted, const BandOptions& options, Trial& trial) {
  double slowest_hz = 0;
  std::size_t slow = 0;
  // The slowest coefficients of the longest transform come first in frequency, wherever they stand in the list.
  std::vector<double> frequency;
  for (const std::size_t j : trial.index) frequency.push_back(bins[j].frequency_hz);
  std::nth_element(frequency.begin(), frequency.begin() + kSlowest - 1, frequency.end());
  slowest_hz = frequency[kSlowest - 1];
  Goodness all, top;
  for (std::size_t i = 0; i < trial.index.size(); ++i) {
    const PowerBin& bin = bins[trial.index[i]];
    const double square = trial.z[i] * trial.z[i];
    if (bin.frequency_hz <= slowest_hz) {
      ++slow;
    } else {
      all.chi2 += square;
    }
    if (bin.high_hz > trial.band.top_hz * std::exp2(-kTopOctaves)) {
      top.chi2 += square;
      top.dof += 1;
    }
  }
  all.dof = std::max(1.0, static_cast<double>(trial.index.size() - slow) - static_cast<double>(fitted));
  all.p = chi_square_tail(all.chi2, all.dof);
  top.p = chi_square_tail(top.chi2, std::max(1.0, top.dof));
  trial.band.goodness = all;
  trial.band.top = top;
  trial.band.passes = std::min(all.p, top.p) >= options.probability;
}

/// `nested`: the same band with the first of its orders, or nearly the same, whose maximum is a start near this one's.
std::optional<Trial> tried(const std::vector<PowerBin>& bins, double rate_hz, TermSet terms, const Band& band,
                           const BandOptions& options, const Trial* nested = nullptr) {
  Trial trial;
  trial.band = band;
  trial.index = members(bins, band);
  if (trial.index.size() < kFewestBins || unknowns_of(band) > std::size_t{kMostShape}) return std::nullopt;
  if (band.quantized) terms[kQuantizationTerm] = true;
  if (band.tau_s) terms[kLentTerm] = true;
  if (band.faster_s) terms[kQuantizationTerm] = true;
  const std::vector<PowerBin> inside = bins_of(bins, band, rate_hz);
  const BinProblem problem = band_problem(bins, band, rate_hz);
  const ScoringResult best = score(problem, terms, nested != nullptr ? &nested->best : nullptr, 1e-6);
  if (!std::isfinite(best.half_deviance)) return std::nullopt;
  const Eigen::ArrayXd model = model_of(problem, best.at);
  for (std::size_t i = 0; i < inside.size(); ++i) {
    trial.ratio.push_back(inside[i].energy / model[static_cast<Eigen::Index>(i)]);
    trial.z.push_back(normal_deviate(trial.ratio.back(), inside[i].dof));
  }
  trial.half_deviance = best.half_deviance;
  trial.best = best.at;
  trial.theta = best.at.theta;
  judge_band(bins, count_of(only_positive(best.at.theta)) + unknowns_of(band), options, trial);
  return trial;
}

Band cut_at(Band band, const std::vector<PowerBin>& bins, double top_hz) {
  band.top_hz = top_hz;
  for (std::size_t j = 0; j < bins.size(); ++j)
    if (bins[j].high_hz > top_hz * (1 + 1e-9)) band.inside[j] = 0;
  return band;
}

/// Bins at the zeros of a filter hold what leaks into them from their neighbours.
void leave_out_nulls(const std::vector<PowerBin>& bins, double rate_hz, Band& band) {
  for (std::size_t j = 0; j < bins.size(); ++j)
    if (mean_ratio(band.filter, bins[j], rate_hz) < kNull) band.inside[j] = 0;
}

/// Most of a narrow filter's band is near its zeros: the differences of neighbouring samples, which
/// live there, must not be several times what the filter lets through.
bool explains_nulls(const std::vector<PowerBin>& bins, double rate_hz, const Trial& trial) {
  constexpr double kTimes = 2, kBeside = 0.5;
  double inside = 0, outside = 0, expected = 0;
  for (std::size_t j = 0; j < bins.size(); ++j) {
    const PowerBin& bin = bins[j];
    const double sine = std::sin(std::numbers::pi * std::min(bin.frequency_hz / rate_hz, 0.5));
    const double weight = (bin.high_hz - bin.low_hz) * sine * sine;
    if (trial.band.inside[j] != 0) {
      inside += weight * bin.energy;
      continue;
    }
    outside += weight * bin.energy;
    expected += weight * expected_energy(bin, trial.theta) * mean_ratio(trial.band.filter, bin, rate_hz);
  }
  return outside <= kTimes * expected + kBeside * inside;
}

/// The named filter that explains most, with the whole spectrum.
std::optional<Trial> named_filter(const std::vector<PowerBin>& bins, double rate_hz, const TermSet& terms,
                                  const BandOptions& options) {
  std::optional<Trial> best;
  for (const auto kind : {NoiseShape::Kind::boxcar, NoiseShape::Kind::bartlett})
    for (const std::uint64_t taps : kTaps) {
      Band band = whole_band(bins, rate_hz);
      band.tau_s = options.tau_s;
      band.filter.kind = kind;
      band.filter.taps = taps;
      leave_out_nulls(bins, rate_hz, band);
      std::optional<Trial> trial = tried(bins, rate_hz, terms, band, options);
      if (trial && (!best || trial->half_deviance < best->half_deviance)) best = std::move(trial);
    }
  return best;
}

/// Median of measured/model over entries from..to-1, +infinity when there are fewer than three.
double median_of_ratio(const std::vector<double>& ratio, std::size_t from, std::size_t to) {
  if (to < from + 3) return std::numeric_limits<double>::infinity();
  std::vector<double> part(ratio.begin() + static_cast<std::ptrdiff_t>(from),
                           ratio.begin() + static_cast<std::ptrdiff_t>(to));
  return median_in_place(part, Middle::upper);
}

/// Neighbouring bins that stand above those on both sides of them.
struct BroadPeak {
  std::size_t from = 0, to = 0;  ///< of a trial's entries, to beyond the last
  double deviations = 0;         ///< standard deviations of noise
};

/// A broad peak (vibration, a floor that sways, a wandering line): up to ten bins whose mean, on
/// the scale of the model, is above the median of the ten bins before as well as of the ten after,
/// so that a slope or a rising end is none.
BroadPeak highest_peak(const std::vector<PowerBin>& bins, const Trial& trial) {
  constexpr std::size_t kReach = 10, kLongest = 10;
  constexpr double kLowest = 0.02;
  BroadPeak best;
  for (std::size_t from = kReach; from < trial.index.size(); ++from) {
    const double before = median_of_ratio(trial.ratio, from - kReach, from);
    double sum = 0, dof = 0;
    for (std::size_t to = from + 1; to <= std::min(from + kLongest, trial.index.size()); ++to) {
      const PowerBin& bin = bins[trial.index[to - 1]];
      if (bin.dof < kFewestPeakDof) break;
      sum += bin.dof * trial.ratio[to - 1];
      dof += bin.dof;
      const double after = median_of_ratio(trial.ratio, to, std::min(to + kReach, trial.ratio.size()));
      const double excess = sum / dof / std::max(before, after) - 1;
      const double deviations = excess / std::sqrt(2 / dof);
      if (excess > kLowest && deviations > best.deviations) best = {from, to, deviations};
    }
  }
  return best;
}

struct Search {
  const std::vector<PowerBin>& bins;
  double rate_hz;
  const TermSet& terms;
  const BandOptions& options;
  std::optional<Trial> closest;    ///< of those that did not pass
  bool edges = false;              ///< what looked like peaks
  double highest_step = 1.0 / 12;  ///< corner of a shelf or loop, of the rate: higher ones are left of other filters

  /// Lower edge of the slowest coefficient: a quarter over the duration.
  double slowest_hz() const {
    double slowest = rate_hz / 2;
    for (const PowerBin& bin : bins) slowest = std::min(slowest, std::max(bin.low_hz, 1e-300));
    return slowest;
  }

  std::optional<Trial> at(const Band& band, const Trial* nested = nullptr) const {
    return tried(bins, rate_hz, terms, band, options, nested);
  }

  void keep_closest(std::optional<Trial> trial) {
    if (!trial) return;
    const auto worst = [](const Trial& t) { return std::min(t.band.goodness.p, t.band.top.p); };
    if (!closest || worst(*trial) > worst(*closest)) closest = std::move(trial);
  }

  /// The widest band under `from` that passes.
  std::optional<Band> widest(const Band& from, double top_hz) {
    for (;; top_hz *= std::exp2(-kBandStep)) {
      Band band = cut_at(from, bins, top_hz);
      if (members(bins, band).size() < kFewestBins) return std::nullopt;
      const int most = top_hz < kDeepest * rate_hz / 2 ? std::min(1, options.most_orders) : options.most_orders;
      std::optional<Trial> fewer;
      for (band.orders = 0; band.orders <= most; ++band.orders) {
        std::optional<Trial> trial = at(band, fewer ? &*fewer : nullptr);
        if (trial && trial->band.passes) return trial->band;
        keep_closest(trial);
        fewer = std::move(trial);
      }
    }
  }

  /// The whole band with the polynomial that is the likeliest for its coefficients; none where that is worth little.
  std::optional<Band> wavy(const Trial& plain) const {
    constexpr double kWorth = 4;  ///< of ln L beyond one a coefficient
    double least = plain.half_deviance - kWorth;
    std::optional<Band> best;
    std::optional<Trial> trial;
    Band band = plain.band;
    band.quantized = false;
    for (band.orders = 1; band.orders <= kMostShape; ++band.orders) {
      const std::optional<Trial> fewer = std::move(trial);
      trial = at(band, fewer ? &*fewer : nullptr);
      if (!trial || !trial->band.passes || !(trial->half_deviance + band.orders < least)) continue;
      least = trial->half_deviance + band.orders;
      best = trial->band;
    }
    return best;
  }

  /// `band` with the likeliest shape of a family in it; none where its corner is not seen there.
  std::optional<Trial> named_in(Band band, NamedShape::Family family, const std::optional<NamedShape>& start,
                                double hopeless) const {
    // A corner shows by what is beyond it; less damped it is a peak.
    // Two poles far apart, or a corner in the slowest coefficients, are a drift that is no noise.
    constexpr double kInside = 0.5, kDamped = 0.25, kOverdamped = 2, kPeriods = 12;
    const bool low_pass = family == NamedShape::Family::second_order || family == NamedShape::Family::third_order;
    const double highest = low_pass ? 0.2 : highest_step;
    if (members(bins, band).size() < kFewestBins) return std::nullopt;
    TermSet offered = terms;
    offered[kLentTerm] = offered[kLentTerm] || band.tau_s;
    const auto shape = fit_named_shape(bins_of(bins, band, rate_hz), rate_hz, offered, family, start, hopeless);
    if (!shape || shape->damping < kDamped || shape->damping > kOverdamped ||
        shape->pole_hz < kPeriods * 4 * slowest_hz() ||
        shape->pole_hz > std::min(kInside * band.top_hz, highest * rate_hz))
      return std::nullopt;
    // A shelf that is higher is an edge of something else; one that falls further may be a process above white noise.
    constexpr double kHighest = 4, kFurthest = 32;
    const double rise = shape->zero_hz > 0 ? std::log(shape->pole_hz / shape->zero_hz) : 0;
    if (family == NamedShape::Family::shelf && (rise > std::log(kHighest) || rise < -std::log(kFurthest)))
      return std::nullopt;
    band.named = *shape;
    band.orders = static_cast<int>(unknowns_of(family));
    std::optional<Trial> trial = at(band);
    const bool rises = shape->zero_hz > 0 && shape->pole_hz > shape->zero_hz;
    if (trial && rises && !shows_white_below(bins, trial->band.named, trial->theta)) return std::nullopt;
    return trial;
  }

  /// The widest band that passes with a filter or loop of low corner: found in the middle of the
  /// spectrum, then followed up and down.
  std::optional<Trial> widest_named(const Band& from, NamedShape::Family family,
                                    const std::optional<NamedShape>& start = {}) const {
    constexpr int kCuts = 10, kMiddle = 2;
    const auto cut = [&](int steps) { return cut_at(from, bins, rate_hz / 2 * std::exp2(-kBandStep * steps)); };
    constexpr double kFar = 3000;  ///< of ln L that no step from a corner of the grid makes good
    constexpr double kNever = std::numeric_limits<double>::infinity();
    Band plain = cut(kMiddle);
    plain.orders = static_cast<int>(unknowns_of(family));
    const std::optional<Trial> rival = at(plain);
    const std::optional<Trial> middle =
        named_in(cut(kMiddle), family, start, rival ? rival->half_deviance + kFar : kNever);
    if (!middle || !needed(*middle)) return std::nullopt;
    NamedShape shape = middle->band.named;
    for (int steps = 0; steps < kCuts; ++steps) {
      const std::optional<Trial> trial = steps == kMiddle ? middle : named_in(cut(steps), family, shape, kNever);
      if (!trial) continue;
      if (trial->band.passes) return trial;
      if (steps > kMiddle) shape = trial->band.named;
    }
    return std::nullopt;
  }

  /// Not where a polynomial of as many coefficients explains the same band as well, and not where
  /// no shape at all could by chance: a shape leaves white noise ten times less well known.
  bool needed(const Trial& named) const {
    constexpr double kWorth = 1, kBeyondChance = 9;  ///< of ln L
    Band plain = named.band;
    plain.named = {};
    const std::optional<Trial> polynomial = at(plain);
    plain.orders = 0;
    const std::optional<Trial> none = at(plain);
    return (!polynomial || polynomial->half_deviance - named.half_deviance > kWorth) &&
           (!none || none->half_deviance - named.half_deviance > kBeyondChance);
  }

  /// The same over all families: the widest, then the fewest unknowns, then the likeliest.
  std::optional<Band> named(const Band& from) const {
    std::optional<Trial> best;
    using Family = NamedShape::Family;
    for (const Family family : {Family::second_order, Family::shelf, Family::loop}) {
      if (family == Family::loop && best) break;  // what is simpler explains it
      std::optional<Trial> trial = widest_named(from, family);
      if (!trial) continue;
      const bool wider = best && trial->band.top_hz > 1.01 * best->band.top_hz;
      const bool same = best && trial->band.top_hz > 0.99 * best->band.top_hz &&
                        trial->band.orders == best->band.orders && trial->half_deviance < best->half_deviance;
      if (!best || wider || same) best = std::move(trial);
    }
    if (!best) return std::nullopt;
    if (best->band.named.family == Family::second_order) {
      const NamedShape second = best->band.named;
      add_root(from, Family::third_order, second, *best);
      if (best->band.top_hz < 0.99 * rate_hz / 2) add_root(from, Family::loop, {}, *best);
    }
    return best->band;
  }

  /// The corner of a filter looks like a peak on a spectrum without a shape: a filter that describes more bins than are
  /// left between the peaks takes their place.
  Band corner_or(const Band& between, const Band& whole) const {
    const std::optional<Band> filter = named(whole);
    return filter && members(bins, *filter).size() > members(bins, between).size() ? *filter : between;
  }

  /// A pole or a zero more, where that describes a wider band or is likelier.
  void add_root(const Band& from, NamedShape::Family family, const std::optional<NamedShape>& start,
                Trial& best) const {
    constexpr double kWorth = 2.5;  ///< of ln L
    std::optional<Trial> more = widest_named(from, family, start);
    if (!more) return;
    const bool wider = more->band.top_hz > 1.01 * best.band.top_hz;
    const bool same = more->band.top_hz > 0.99 * best.band.top_hz;
    if (wider || (same && more->half_deviance < best.half_deviance - kWorth)) best = std::move(*more);
  }

  /// Without its broad peaks and their skirts, the highest first, each seen beside what is left of the others.
  Band without_peaks(Band band) const {
    std::size_t most = band.inside.size() / kMostLeftOut;
    for (bool first = true;; first = false) {
      const std::optional<Trial> trial = at(band);
      if (!trial) break;
      const BroadPeak peak = highest_peak(bins, *trial);
      const std::size_t from = peak.from - std::min(peak.from, kSkirt);
      const std::size_t to = std::min(peak.to + kSkirt, trial->index.size());
      const bool found = peak.deviations > kPeak && to - from <= most;
      if (!found && !first) break;
      for (std::size_t i = from; found && i < to; ++i) band.inside[trial->index[i]] = 0;
      if (found) most -= to - from;
      // The highest would distort a shape; the lowest are not seen without one.
      band.orders = options.most_orders;
    }
    band.orders = 0;
    return band;
  }

  /// Runs of bins that are left out, up to its top: from..to-1 of `order`.
  std::vector<std::pair<std::size_t, std::size_t>> holes_of(const Band& band,
                                                            const std::vector<std::size_t>& order) const {
    std::vector<std::pair<std::size_t, std::size_t>> holes;
    for (std::size_t from = 0, to = 0; from < order.size(); from = to + 1) {
      for (to = from; to < order.size() && band.inside[order[to]] == 0;) ++to;
      if (to < order.size() && bins[order[to]].high_hz > band.top_hz) break;
      if (to > from) holes.push_back({from, to});
    }
    return holes;
  }

  std::vector<std::size_t> by_frequency() const {
    std::vector<std::size_t> order(bins.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::sort(order.begin(), order.end(),
              [&](std::size_t a, std::size_t b) { return bins[a].frequency_hz < bins[b].frequency_hz; });
    return order;
  }

  /// Centre of the upper half of a peak.
  double top_of(const std::vector<std::size_t>& hole, const Mixture& theta, double height) const {
    double sum = 0, area = 0;
    for (const std::size_t j : hole) {
      const double excess = bins[j].energy / expected_energy(bins[j], theta) - 1;
      if (excess < height / 2) continue;
      area += excess * (bins[j].high_hz - bins[j].low_hz);
      sum += excess * (bins[j].high_hz - bins[j].low_hz) * bins[j].frequency_hz;
    }
    return sum / area;
  }

  /// What a hole was cut for: excess e over the model, of the height a and the area a f pi / (2 Q) of a resonance.
  std::optional<Resonance> resonance_in(const std::vector<std::size_t>& hole, const Mixture& theta) const {
    double sum = 0, weight = 0, area = 0, height = 0;
    for (const std::size_t j : hole) {
      const double excess = std::max(0.0, bins[j].energy / expected_energy(bins[j], theta) - 1);
      sum += bins[j].dof * excess * bins[j].frequency_hz;
      weight += bins[j].dof * excess;
      area += excess * (bins[j].high_hz - bins[j].low_hz);
      height = std::max(height, excess);
    }
    if (!(weight > 0)) return std::nullopt;
    const double frequency_hz = sum / weight, quality = height * frequency_hz * std::numbers::pi / 2 / area;
    const double angle = 2 * std::numbers::pi * frequency_hz / rate_hz, half = angle / (2 * quality);
    Resonance out{frequency_hz, height * half * half, std::pow(half * std::sin(angle), 2)};
    out.top_hz = top_of(hole, theta, height);
    return out;
  }

  /// The likeliest strength of all skirts together, which that of the cores is a guess at; unlike ones where they
  /// explain more.
  std::optional<Trial> with_skirts(Band band) const {
    constexpr double kExplains = 1;  ///< of ln L
    std::optional<Trial> best;
    for (const bool unlike : {false, true}) {
      for (Resonance& resonance : band.resonances) resonance.unlike = unlike;
      const std::optional<Trial> like = best;
      for (const double factor : {0.25, 0.5, 1.0, 2.0, 4.0}) {
        Band scaled = band;
        for (Resonance& resonance : scaled.resonances) resonance.strength *= factor;
        std::optional<Trial> trial = at(scaled, best ? &*best : nullptr);
        if (trial && like && !(trial->half_deviance < like->half_deviance - kExplains)) continue;
        if (trial && (!best || trial->half_deviance < best->half_deviance)) best = std::move(trial);
      }
    }
    return best;
  }

  /// Each hole stands above the level of the slow side somewhere: the edge of a filter does not, which unlike skirts
  /// describe as well.
  bool all_rise(const Trial& trial, const std::vector<std::size_t>& order) const {
    for (const auto& [from, to] : holes_of(trial.band, order)) {
      double clearest = 0;
      for (std::size_t i = from; i < to; ++i) {
        const PowerBin& bin = bins[order[i]];
        if (bin.dof < kFewestPeakDof) continue;
        const double excess = bin.energy / expected_energy(bin, trial.theta) - 1;
        clearest = std::max(clearest, excess * std::sqrt(bin.dof / 2));
      }
      if (!(clearest > kPeak)) return false;
    }
    return true;
  }

  /// The whole band without `holes`, each a resonance whose skirts are fitted, wider where that does not pass: a shape
  /// beside a narrow hole, or none, would put the skirts into N.
  std::optional<Band> between_peaks(Band band) {
    constexpr std::size_t kOf = 4;  ///< a quarter wider on each side
    const std::vector<std::size_t> order = by_frequency();
    const std::size_t fewest = bins.size() - bins.size() / kMostLeftOut;
    const std::optional<Trial> bare = at(band);
    const auto holes = holes_of(band, order);
    if (!bare) return std::nullopt;
    for (const auto& [from, to] : holes) {
      const auto first = order.begin() + static_cast<std::ptrdiff_t>(from);
      const auto found = resonance_in({first, first + static_cast<std::ptrdiff_t>(to - from)}, bare->theta);
      if (found) band.resonances.push_back(*found);
    }
    for (;;) {
      const std::optional<Trial> trial = with_skirts(band);
      if (!trial || trial->index.size() < fewest) return std::nullopt;
      if (trial->band.passes) {
        edges = !all_rise(*trial, order);
        return edges ? std::nullopt : std::optional(trial->band);
      }
      const Band before = band;
      for (const auto& [from, to] : holes_of(before, order)) {
        const std::size_t width = (to - from + kOf - 1) / kOf;
        for (std::size_t i = from - std::min(from, width); i < std::min(order.size(), to + width); ++i)
          band.inside[order[i]] = 0;
      }
      if (band.inside == before.inside) return std::nullopt;
    }
  }

  /// `narrow`, or the band without broad peaks where that is twice as wide. What is left of their skirts is a small
  /// misfit, and moves the coefficients less than a deep cut does: there a smaller probability passes.
  std::optional<Band> wider_between_peaks(const Band& whole, std::optional<Band> narrow) {
    const Band holes = edges ? whole : without_peaks(whole);
    if (holes.inside == whole.inside && !edges) return narrow;
    BandOptions lenient = options;
    lenient.probability = options.misfit;
    Search eased{bins, rate_hz, terms, lenient, std::nullopt};
    const auto take = [&](const std::optional<Band>& found) {
      if (found && (!narrow || found->top_hz > 2 * narrow->top_hz)) narrow = found;
    };
    for (Search* search : {this, &eased}) {
      if (edges) break;
      std::optional<Band> found = search->between_peaks(holes);
      if (!found && !search->edges) found = search->widest(holes, rate_hz / 2);
      const auto trial = found ? at(*found) : std::nullopt;
      edges = search->edges || (trial && !all_rise(*trial, by_frequency()));
      if (!edges) take(found);
    }
    if (edges) take(eased.widest(whole, rate_hz / 2));
    return narrow;
  }

  /// Probability of the residuals of a band's lowest two octaves.
  double foot_of(const Trial& trial) const {
    double chi2 = 0, dof = 0;
    for (std::size_t i = 0; i < trial.index.size(); ++i) {
      if (bins[trial.index[i]].low_hz > 4 * trial.band.bottom_hz) continue;
      chi2 += trial.z[i] * trial.z[i];
      dof += 1;
    }
    return dof > 0 ? chi_square_tail(chi2, dof) : 1;
  }

  /// Where nothing but a sliver at the slow end holds, what stands there is a cycle or a movement, not noise in the
  /// bandwidth of the sensor: the widest band of white noise from the top down, of five octaves at least.
  std::optional<Band> above_hump(Band band) const {
    constexpr double kLeast = 1.0 / 32;
    const TermSet white = {true, false, false, false, false};
    std::optional<Band> widest;
    for (double low = kLeast * rate_hz / 2; low > slowest_hz(); low *= std::exp2(-kBandStep)) {
      band.bottom_hz = low;
      for (std::size_t j = 0; j < bins.size(); ++j) band.inside[j] = bins[j].low_hz >= low ? 1 : 0;
      std::optional<Trial> trial;
      for (const bool quantized : {false, true}) {
        band.quantized = quantized;
        trial = tried(bins, rate_hz, white, band, options);
        if (trial && trial->band.passes) break;
      }
      if (!trial || !trial->band.passes || foot_of(*trial) < options.probability) break;
      widest = trial->band;
    }
    if (!widest) return std::nullopt;
    // The skirt of what is below rises slowly out of the noise: an octave of margin.
    widest->bottom_hz *= 2;
    for (std::size_t j = 0; j < bins.size(); ++j) widest->inside[j] = bins[j].low_hz >= widest->bottom_hz ? 1 : 0;
    return widest;
  }

  /// A polynomial of two orders, or a filter with a low corner, makes a band likelier by `worth` of ln L.
  bool explained_by_shape(const Trial& trial, double worth) const {
    Band band = trial.band;
    band.quantized = false;
    const auto likelier = [&](const std::optional<Trial>& other) {
      return other && trial.half_deviance - other->half_deviance > worth;
    };
    const std::optional<Band> filter = named(band);
    band.orders = 2;
    return likelier(at(band)) || (filter && likelier(at(*filter)));
  }

  /// With the orders that explain something, and two more of few, one more of many: what just passes leaves a bias.
  /// A cut band that passes without a shape is halved.
  Band with_margin(Band band) const {
    constexpr double kExplains = 1;  ///< of ln L
    constexpr int kMostMore = 4;
    const bool whole = band.top_hz > rate_hz / 2 * 0.99;
    if (whole && band.orders == 0) return band;
    const auto with_orders = [&](Band next, int more) {
      next.orders = std::min(next.orders + more, kMostShape - static_cast<int>(unknowns_of(next.resonances)));
      return at(next);
    };
    std::optional<Trial> best = at(band);
    for (int more = 1; best && band.orders > 0 && more <= kMostMore; ++more) {
      std::optional<Trial> next = with_orders(band, 1);
      if (!next || !next->band.passes || best->half_deviance - next->half_deviance < kExplains) break;
      best = std::move(next);
      band = best->band;
    }
    const int margin = band.orders > 0 && band.orders <= options.most_orders ? 2 : 1;
    const std::optional<Trial> trial =
        with_orders(band.orders == 0 ? cut_at(band, bins, band.top_hz / 2) : band, margin);
    return trial && trial->band.passes ? trial->band : band;
  }
};

}  // namespace

std::size_t unknowns_of(const Band& band) {
  return static_cast<std::size_t>(band.orders) + unknowns_of(band.resonances);
}

Band whole_band(const std::vector<PowerBin>& bins, double rate_hz) {
  Band band;
  band.top_hz = rate_hz / 2;
  band.inside.assign(bins.size(), 1);
  return band;
}

std::vector<PowerBin> filtered(std::vector<PowerBin> bins, const NoiseShape& filter, double rate_hz) {
  if (filter.kind == NoiseShape::Kind::none) return bins;
  for (PowerBin& bin : bins) {
    const double ratio = mean_ratio(filter, bin, rate_hz);
    for (double& unit : bin.unit) unit *= ratio;
  }
  return bins;
}

std::vector<PowerBin> bins_of(const std::vector<PowerBin>& bins, const Band& band, double rate_hz) {
  std::vector<PowerBin> inside;
  for (std::size_t j = 0; j < bins.size(); ++j)
    if (band.inside[j] != 0) inside.push_back(bins[j]);
  if (band.tau_s)
    for (PowerBin& bin : inside) bin.unit[kLentTerm] = gauss_markov_unit(bin, *band.tau_s, rate_hz);
  if (band.faster_s)
    for (PowerBin& bin : inside) bin.unit[kQuantizationTerm] = gauss_markov_unit(bin, *band.faster_s, rate_hz);
  inside = filtered(std::move(inside), band.filter, rate_hz);
  for (PowerBin& bin : inside) {
    const double gain = std::exp(band_log_gain(band, bin, rate_hz));
    for (double& unit : bin.unit) unit *= gain;
  }
  return band.low_pass ? low_passed(std::move(inside), band.low_pass->corner_hz, rate_hz) : inside;
}

double band_log_gain(const Band& band, const PowerBin& bin, double rate_hz) {
  return small_shape_log_gain(band.small, bin, rate_hz) + named_log_gain(band.named, bin, rate_hz);
}

BinProblem band_problem(const std::vector<PowerBin>& bins, const Band& band, double rate_hz) {
  const std::vector<PowerBin> inside = bins_of(bins, band, rate_hz);
  const std::size_t unknowns = unknowns_of(band.named.family);
  if (unknowns == 0) return bin_problem(inside, band.orders, band.top_hz, band.resonances, rate_hz);
  BinProblem problem = bin_problem(inside);
  const Eigen::ArrayXd root = (problem.dof / 2).sqrt();
  Eigen::MatrixXd slopes(problem.size(), static_cast<Eigen::Index>(unknowns));
  for (Eigen::Index j = 0; j < problem.size(); ++j) {
    const auto slope = named_log_slopes(band.named, inside[static_cast<std::size_t>(j)], rate_hz);
    for (std::size_t k = 0; k < unknowns; ++k) slopes(j, static_cast<Eigen::Index>(k)) = root[j] * slope[k];
  }
  problem.shape = thin_qr(slopes).q.array().colwise() / root;
  return problem;
}

namespace {

/// The largest deviate of score tests for a shelf, ln gain = a x / (1 + x), x = (f / f_c)², its corner at one of the
/// octaves of the record: what rises from the slow end on is behind a high-pass. And that of tests for an echo of k
/// samples, ln gain = a (cos(2 pi k f / rate) - 1), of which those of a few samples answer to any filter.
struct ShelfTest {
  double largest = 0, rising = 0, near_echo = 0, echo = 0;
  NamedShape clearest;  ///< the shelf of the largest
  NamedShape echoing;   ///< of two samples or more
};
/// The columns and that of the corner of a low-pass, which is fitted too.
Eigen::MatrixXd with_corner(const Search& search, const Trial& trial, const Eigen::ArrayXd& root,
                            Eigen::MatrixXd columns) {
  if (!trial.band.low_pass) return columns;
  columns.conservativeResize(Eigen::NoChange, columns.cols() + 1);
  for (Eigen::Index j = 0; j < columns.rows(); ++j) {
    const PowerBin& bin = search.bins[trial.index[static_cast<std::size_t>(j)]];
    columns(j, columns.cols() - 1) =
        root[j] * low_pass_gain(bin, trial.band.low_pass->corner_hz, search.rate_hz).log_slope;
  }
  return columns;
}
ShelfTest shelf_test(const Search& search, const Trial& trial, double slowest_hz) {
  constexpr double kTopOctave = 0.25, kSeen = 1e-3, kLargest = 2, kMostEcho = 0.5;  ///< of ln gain, of g
  constexpr int kNear = 8, kLongestEcho = 32;
  const BinProblem problem = band_problem(search.bins, trial.band, search.rate_hz);
  const Eigen::ArrayXd root = (problem.dof / 2).sqrt(), model = mixture_of(problem, trial.theta);
  std::vector<Eigen::Index> in;
  for (std::size_t i = 0; i < kTerms; ++i)
    // One at zero would take its own opposite for the slope of a high-pass.
    if (trial.theta[i] > 0) in.push_back(static_cast<Eigen::Index>(i));
  Eigen::MatrixXd columns(problem.size(), static_cast<Eigen::Index>(in.size()));
  for (std::size_t i = 0; i < in.size(); ++i)
    columns.col(static_cast<Eigen::Index>(i)) = (root * problem.unit.col(in[i]) / model).matrix();
  const Eigen::MatrixXd basis = column_basis(with_corner(search, trial, root, std::move(columns)));
  const Eigen::VectorXd residual = (root * (problem.energy / model - 1)).matrix();
  Eigen::ArrayXd square(problem.size());
  for (Eigen::Index j = 0; j < problem.size(); ++j)
    square[j] = std::pow(search.bins[trial.index[static_cast<std::size_t>(j)]].frequency_hz, 2);
  ShelfTest out;
  const auto tested = [&](const Eigen::ArrayXd& log_gain) {
    const Eigen::VectorXd shape = (root * log_gain).matrix();
    const Eigen::VectorXd apart = without_columns_of(basis, shape);
    const double deviate = apart.norm() > kSeen * shape.norm() ? apart.dot(residual) / apart.norm() : 0;
    return std::pair{deviate, 1 / apart.norm()};
  };
  Eigen::ArrayXd wave(problem.size());
  for (int lag = 1; lag <= kLongestEcho; ++lag) {
    for (Eigen::Index j = 0; j < problem.size(); ++j)
      wave[j] = mean_cosine(search.bins[trial.index[static_cast<std::size_t>(j)]], lag, search.rate_hz) - 1;
    const auto [deviate, sd] = tested(wave);
    if (lag <= kNear) out.near_echo = std::max(out.near_echo, std::abs(deviate));
    if (lag < 2 || !(std::abs(deviate) > out.echo)) continue;
    out.echo = std::abs(deviate);
    // ln |H|² ~ 2 g (cos - 1)
    out.echoing = echo_shape(std::clamp(deviate * sd / 2, -kMostEcho, kMostEcho), lag, search.rate_hz);
  }
  for (double corner = kTopOctave * search.rate_hz / 2; corner > 4 * slowest_hz; corner /= 2) {
    const auto [deviate, sd] = tested(square / (square + corner * corner));
    out.rising = std::max(out.rising, deviate);
    if (!(std::abs(deviate) > out.largest)) continue;
    out.largest = std::abs(deviate);
    const double root_of_half = std::exp(std::clamp(deviate * sd, -kLargest, kLargest) / 4);
    out.clearest = {NamedShape::Family::shelf, corner * root_of_half, corner / root_of_half};
  }
  return out;
}

/// The slow end of a trial over the largest that its model is anywhere, in the model or as it was measured below a
/// third of the corner: near one is a plateau that begins above, a process, and no high-pass.
double slow_end_of(const Search& search, const Trial& trial) {
  Band all = trial.band;
  std::fill(all.inside.begin(), all.inside.end(), 1);
  const std::vector<PowerBin> bins = bins_of(search.bins, all, search.rate_hz);
  double slowest_hz = std::numeric_limits<double>::infinity(), shape = 1, most = 0;
  // Inside, the model with what a straight line in the unknowns adds to the shape; below, as in the slowest bin inside.
  for (std::size_t i = 0; i < trial.index.size(); ++i) {
    const PowerBin& bin = bins[trial.index[i]];
    const double model = search.bins[trial.index[i]].energy / trial.ratio[i];
    most = std::max(most, model);
    if (bin.frequency_hz >= slowest_hz) continue;
    slowest_hz = bin.frequency_hz;
    shape = model / expected_energy(bin, trial.theta);
  }
  double slow = most, energy = 0, dof = 0;
  for (const PowerBin& bin : bins) {
    if (bin.high_hz < trial.band.named.pole_hz / 3) {
      energy += bin.dof * bin.energy;
      dof += bin.dof;
    }
    if (bin.frequency_hz > slowest_hz) continue;
    slow = std::min(slow, shape * expected_energy(bin, trial.theta));
  }
  return std::min(slow, dof > 0 ? energy / dof : slow) / most;
}

double chance_of(const Trial& trial) { return std::min(trial.band.goodness.p, trial.band.top.p); }

/// A low-pass is the first that passes of what falls: where a directed test sees more, a filter or loop with another
/// root takes its place, or is known to its interval.
Band low_pass_or(const Search& search, Trial trial, const Band& whole, double slowest_hz) {
  constexpr double kWorth = 4;  ///< of ln L
  const ShelfTest beside = shelf_test(search, trial, slowest_hz);
  if (!(std::max(beside.largest, beside.near_echo) > search.options.step)) return trial.band;
  trial.band.hidden.push_back(beside.clearest);
  const std::optional<Band> named = search.named(whole);
  const std::optional<Trial> other = named && named->top_hz > 0.99 * whole.top_hz ? search.at(*named) : std::nullopt;
  return other && other->half_deviance < trial.half_deviance - kWorth ? *named : trial.band;
}

/// The whole band behind an echo, where that describes it and neither a pole nor a polynomial of two orders does as
/// well.
std::optional<Band> echo_in(const Search& search, Band band, const Trial& plain, const NamedShape& start) {
  constexpr double kMost = 0.9, kWorth = 1;  ///< of g; of ln L
  TermSet offered = search.terms;
  offered[kLentTerm] = offered[kLentTerm] || band.tau_s;
  const std::vector<PowerBin> inside = bins_of(search.bins, band, search.rate_hz);
  const auto shape = fit_named_shape(inside, search.rate_hz, offered, NamedShape::Family::echo, start);
  if (!shape || std::abs(shape->echo) > kMost) return std::nullopt;
  Band other = band;
  band.named = *shape;
  band.orders = static_cast<int>(unknowns_of(shape->family));
  const std::optional<Trial> trial = search.at(band);
  if (!trial || !trial->band.passes || !search.needed(*trial) || !shows_white_below(search.bins, *shape, trial->theta))
    return std::nullopt;
  const auto as_good = [&](const std::optional<Trial>& rival) {
    return rival && rival->half_deviance < trial->half_deviance + kWorth;
  };
  other.orders = 2;
  if (as_good(search.at(other, &plain))) return std::nullopt;
  other.orders = 0;
  other.low_pass = fit_low_pass(inside, search.rate_hz, offered);
  if (other.low_pass && as_good(search.at(other))) return std::nullopt;
  return trial->band;
}

Band passing(const Trial& trial) {
  Band band = trial.band;
  band.passes = true;
  return band;
}

/// The band with the likeliest corner in it, which the ends of the record do not draw upwards.
std::optional<Trial> high_passed_in(const Search& search, Band band) {
  Band plain = band;
  plain.named = {};
  const std::vector<PowerBin> inside = bins_of(search.bins, plain, search.rate_hz);
  if (inside.size() < kFewestBins) return std::nullopt;
  if (const auto shape = fit_named_shape(inside, search.rate_hz, search.terms, band.named.family, band.named))
    band.named = *shape;
  return search.at(band);
}

/// A walk behind a high-pass is level below its corner: with white noise it has the spectrum of a shelf that rises.
bool is_shelf(const Search& search, const Trial& high_passed) {
  constexpr double kAsLikely = 2;  ///< of ln L
  if (!(high_passed.theta[static_cast<std::size_t>(Term::walk)] > 0)) return false;
  Band band = high_passed.band;
  band.named = {};
  const auto shelf = search.named_in(band, NamedShape::Family::shelf, {}, std::numeric_limits<double>::infinity());
  return shelf && shelf->half_deviance < high_passed.half_deviance + kAsLikely;
}

/// The level above a high-pass: what rises from its corner on is phase noise, which no high-pass is needed for.
bool seen_above(const Search& search, const Trial& high_passed) {
  constexpr double kHighest = 20;  ///< corners below the rate
  const double corner_hz = high_passed.band.named.pole_hz;
  if (!(corner_hz < search.rate_hz / kHighest)) return false;
  for (const PowerBin& bin : search.bins)
    if (bin.low_hz <= corner_hz && bin.high_hz >= corner_hz)
      return !(high_passed.theta[kQuantizationTerm] * bin.unit[kQuantizationTerm] > high_passed.theta[0] * bin.unit[0]);
  return true;
}

/// The slow end falls: a high-pass, where it explains much that the terms do not, and the rest passes with it. A walk
/// leaves a plateau behind a high-pass, as processes do: then it is none, and the band has `doubtful_end`.
std::optional<Band> high_passed(const Search& search, Trial& unshaped, double slowest_hz) {
  constexpr double kFalls = 0.5;   ///< at the slow end, of the largest
  constexpr double kShelf = 0.15;  ///< the same, of what a shelf may be
  constexpr double kClear = 50;    ///< of ln L
  constexpr double kNeeded = 15;   ///< of 2 lnL; records without a high-pass reach 12.5 in 2 of 1,000
  constexpr double kDoubted = 7;   ///< the same from which on limits have to know of it
  constexpr double kPeriods = 4;   ///< of the corner in the record: below, a drift looks like that
  const double duration_s = 0.25 / slowest_hz;
  Band band = unshaped.band;
  NamedShape best;
  double least = unshaped.half_deviance - kDoubted / 2;
  const auto take = [&](const NamedShape& shape) {
    band.named = shape;
    const BinProblem problem = bin_problem(bins_of(search.bins, band, search.rate_hz));
    const double value = score(problem, search.terms, nullptr, 1e-6).half_deviance;
    if (!(value < least)) return;
    least = value;
    best = shape;
  };
  for (const NamedShape& start : high_pass_starts(search.rate_hz, duration_s)) take(start);
  if (best.family == NamedShape::Family::none) return std::nullopt;
  // Between the octaves too: a walk that fills what a corner too high takes away keeps a step in its place.
  for (double apart = std::numbers::sqrt2; apart > 1.1; apart = std::sqrt(apart))
    for (const double factor : {apart, 1 / apart}) {
      NamedShape next = best;
      next.pole_hz *= factor;
      take(next);
    }
  const auto shape = fit_named_shape(bins_of(search.bins, unshaped.band, search.rate_hz), search.rate_hz, search.terms,
                                     NamedShape::Family::high_pass, best);
  if (!shape || !(shape->pole_hz * duration_s > kPeriods)) return std::nullopt;
  if (!(least < unshaped.half_deviance - kNeeded / 2)) {
    unshaped.band.hidden.push_back(*shape);
    return std::nullopt;
  }
  band.named = *shape;
  band.orders = 1;
  // A walk behind a high-pass is a Gauss-Markov process, and quantization noise rises: they have their own searches.
  constexpr double kAsGood = 4;  ///< of ln L
  Band process = unshaped.band;
  process.tau_s = 1 / (2 * std::numbers::pi * shape->pole_hz);
  TermSet offered = search.terms;
  offered[kLentTerm] = offered[kQuantizationTerm] = true;
  if (score(bin_problem(bins_of(search.bins, process, search.rate_hz)), offered).half_deviance < least + kAsGood)
    return std::nullopt;
  // Below, the two ends of the record hold more power than what the high-pass lets through.
  const double corner = shape->pole_hz;
  const double ends_hz = 2 * corner / std::sqrt(2 * std::numbers::pi * corner * duration_s);
  for (std::size_t j = 0; j < search.bins.size(); ++j)
    if (search.bins[j].high_hz < ends_hz) band.inside[j] = 0;
  const std::optional<Trial> trial = high_passed_in(search, band);
  // What a cut would leave of a record that falls this clearly is its foot.
  const bool clear = unshaped.half_deviance - least > kClear;
  if (!trial || chance_of(*trial) < (clear ? search.options.misfit : search.options.probability)) return std::nullopt;
  if (!seen_above(search, *trial)) return std::nullopt;
  const double slow_end = slow_end_of(search, *trial);
  unshaped.band.doubtful_end = slow_end > kFalls;
  if (unshaped.band.doubtful_end || (slow_end > kShelf && is_shelf(search, *trial))) return std::nullopt;
  return passing(*trial);
}

}  // namespace

bool shows_white_below(const std::vector<PowerBin>& bins, const NamedShape& shape, const Mixture& theta) {
  const double corner_hz = std::min(shape.pole_hz, shape.zero_hz);
  const auto at = std::find_if(bins.begin(), bins.end(), [&](const PowerBin& bin) { return bin.high_hz > corner_hz; });
  if (at == bins.end()) return true;
  double slow = 0;
  for (const std::size_t i : {static_cast<std::size_t>(Term::flicker), static_cast<std::size_t>(Term::walk), kLentTerm})
    slow += theta[i] * at->unit[i];
  return slow < theta[0] * at->unit[0];
}

std::optional<Band> judged(const std::vector<PowerBin>& bins, double rate_hz, const TermSet& terms, const Band& band) {
  const auto trial = tried(bins, rate_hz, terms, band, {});
  return trial ? std::optional(trial->band) : std::nullopt;
}

std::optional<Band> with_shelf(const std::vector<PowerBin>& bins, double rate_hz, const TermSet& terms,
                               const Band& band, const NamedShape& start) {
  const BandOptions options;
  Search search{bins, rate_hz, terms, options, std::nullopt};
  search.highest_step = 0.2;
  const auto trial = search.named_in(band, NamedShape::Family::shelf, start, std::numeric_limits<double>::infinity());
  return trial ? std::optional(trial->band) : std::nullopt;
}

namespace {

Band passing_band(const std::vector<PowerBin>& bins, double rate_hz, const TermSet& terms, const BandOptions& options) {
  Band whole = whole_band(bins, rate_hz);
  whole.tau_s = options.tau_s;
  Search search{bins, rate_hz, terms, options, std::nullopt};
  std::optional<Trial> unshaped = search.at(whole);
  if (!unshaped) return whole;
  const double slowest_hz = search.slowest_hz();
  ShelfTest shelf = shelf_test(search, *unshaped, slowest_hz);
  if (shelf.rising > options.high_pass)
    if (const std::optional<Band> falling = high_passed(search, *unshaped, slowest_hz)) return *falling;
  if (!options.corners) shelf = {};
  const bool describes = chance_of(*unshaped) >= options.probability_unshaped;
  const bool peaked = options.corners && highest_peak(bins, *unshaped).deviations > options.peak;
  const bool echoes = shelf.near_echo > options.shelf;
  if (shelf.echo > options.echo)
    if (const auto echo = echo_in(search, whole, *unshaped, shelf.echoing)) return *echo;
  if (shelf.largest > options.step) unshaped->band.hidden.push_back(shelf.clearest);
  if (shelf.echo > options.hint_of_echo) unshaped->band.hidden.push_back(shelf.echoing);
  if (describes && !(shelf.largest > options.shelf) && !echoes && !peaked) return passing(*unshaped);
  Band with_quantization = whole;
  with_quantization.quantized = true;
  const std::optional<Trial> quantized = search.at(with_quantization);
  constexpr double kWorth = 4;  ///< of ln L, where the terms alone describe the record
  const auto worth = [&](const Trial& trial) {
    return !describes || unshaped->half_deviance - trial.half_deviance > kWorth;
  };
  const bool rises = quantized && chance_of(*quantized) >= options.probability_unshaped && worth(*quantized);
  if (rises && !search.explained_by_shape(*quantized, kWorth)) return passing(*quantized);
  if (const auto named = named_filter(bins, rate_hz, terms, options);
      named && named->band.passes && worth(*named) && explains_nulls(bins, rate_hz, *named))
    return named->band;
  if (peaked)
    if (const std::optional<Band> between = search.between_peaks(search.without_peaks(whole)))
      return search.corner_or(*between, whole);
  Band low_pass = whole;
  TermSet offered = terms;
  offered[kLentTerm] = offered[kLentTerm] || options.tau_s;
  low_pass.low_pass = fit_low_pass(bins_of(bins, whole, rate_hz), rate_hz, offered);
  if (low_pass.low_pass)
    if (auto trial = search.at(low_pass); trial && trial->band.passes && worth(*trial))
      return low_pass_or(search, std::move(*trial), whole, slowest_hz);
  const Trial& plainest = rises ? *quantized : *unshaped;
  if (describes && echoes)
    if (const auto wavy = search.wavy(plainest)) return *wavy;
  if (describes) return search.named(whole).value_or(passing(plainest));
  std::optional<Band> best = search.widest(whole, rate_hz / 2);
  const bool simple = best && best->orders < kMany;
  const std::optional<Band> named = simple && best->top_hz > 0.99 * rate_hz / 2 ? std::nullopt : search.named(whole);
  if (named && (!simple || named->top_hz > kAsWide * best->top_hz)) return *named;
  if (!best || best->top_hz < rate_hz / 2 * 0.99) best = search.wider_between_peaks(whole, best);
  // One clean record in a hundred is here by chance, and where the chance is in its slow part only
  // a deep cut takes it away. Filters and motion are told from chance by far less than a millionth.
  const Trial& plain = quantized && chance_of(*quantized) > chance_of(*unshaped) ? *quantized : *unshaped;
  const double chance = chance_of(plain), left = best ? best->top_hz / (rate_hz / 2) : 0;
  if ((chance >= options.misfit && left < kDeepCut) || (chance >= options.clear_misfit && left < kDeepest))
    return passing(plain);
  if (best) return search.with_margin(*best);
  return search.closest ? search.closest->band : unshaped->band;
}

/// What is seen has a name, if that explains it as well: quantization noise where it rises, a low-pass where it falls.
Band named_instead(const std::vector<PowerBin>& bins, double rate_hz, TermSet terms, Band plain, const Band& shaped) {
  if (plain.quantized || plain.low_pass || plain.filter.kind != NoiseShape::Kind::none) return shaped;
  const auto deviance = [&](const Band& band) {
    return score(bin_problem(bins_of(bins, band, rate_hz)), terms).half_deviance;
  };
  const double with_shape = deviance(shaped);
  if (shaped.small.amplitude > 0) {
    plain.quantized = true;
    terms[kQuantizationTerm] = true;
  } else {
    plain.low_pass = fit_low_pass(bins_of(bins, plain, rate_hz), rate_hz, terms);
    if (!plain.low_pass) return shaped;
  }
  if (!(deviance(plain) < with_shape)) return shaped;
  take_small_shape(bins, rate_hz, terms, plain);
  return plain;
}

}  // namespace

Band find_band(const std::vector<PowerBin>& bins, double rate_hz, const TermSet& terms, const BandOptions& options) {
  Band band = passing_band(bins, rate_hz, terms, options);
  constexpr double kSliver = 1.0 / 256;  ///< of half the rate
  const bool sliver = !band.passes || band.top_hz < kSliver * rate_hz / 2;
  if (sliver && terms[static_cast<std::size_t>(Term::white)]) {
    const Search search{bins, rate_hz, terms, options, std::nullopt};
    if (const auto above = search.above_hump(whole_band(bins, rate_hz))) return *above;
  }
  if (!options.small_shapes || !band.passes || unknowns_of(band) > 0 || count_of(terms) == 0 ||
      members(bins, band).size() < kFewestBins)
    return band;
  TermSet offered = terms;
  offered[kQuantizationTerm] = offered[kQuantizationTerm] || band.quantized;
  offered[kLentTerm] = offered[kLentTerm] || band.tau_s;
  const Band plain = band;
  band.small.seen = !(take_small_shape(bins, rate_hz, offered, band) < options.seen);
  if (!band.small.seen) return band;
  return named_instead(bins, rate_hz, offered, plain, band);
}

}  // namespace libchar
