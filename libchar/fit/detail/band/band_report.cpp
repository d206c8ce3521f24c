#include "libchar/fit/detail/band/band_report.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "libchar/core/text/readable.hpp"
#include "libchar/core/text/shown.hpp"
#include "libchar/fit/detail/band/goodness.hpp"
#include "libchar/fit/detail/curve/coefficients.hpp"
#include "libchar/fit/detail/record/dct_means.hpp"

namespace libchar {
namespace {

constexpr double kVisible = 0.01;  ///< of a gain's distance from one

std::vector<Interval> stretches_left_out(const std::vector<PowerBin>& bins, const Band& band) {
  std::vector<Interval> out;
  for (std::size_t j = 0; j < bins.size(); ++j) {
    if (band.inside[j] != 0 || bins[j].high_hz > band.top_hz * (1 + 1e-9)) continue;
    if (!out.empty() && out.back().high >= bins[j].low_hz * (1 - 1e-9) && out.back().low <= bins[j].low_hz)
      out.back().high = bins[j].high_hz;
    else
      out.push_back({bins[j].low_hz, bins[j].high_hz});
  }
  return out;
}

/// A density over that of the noise terms, at a frequency.
struct ShapePoint {
  double frequency_hz = 0;
  double ratio = 1;
  double dof = 0;  ///< of the bin it comes from
};

/// Bins of the last, short block stand among those of all blocks together and scatter more: where a better known one is
/// near they describe nothing. Sorted by frequency.
std::vector<ShapePoint> best_known(std::vector<ShapePoint> points) {
  constexpr double kNear = 1.1, kWorse = 0.2;
  std::sort(points.begin(), points.end(),
            [](const ShapePoint& a, const ShapePoint& b) { return a.frequency_hz < b.frequency_hz; });
  std::vector<ShapePoint> kept;
  std::size_t first = 0;
  for (const ShapePoint& point : points) {
    while (points[first].frequency_hz * kNear < point.frequency_hz) ++first;
    double most = 0;
    for (std::size_t i = first; i < points.size() && points[i].frequency_hz < point.frequency_hz * kNear; ++i)
      most = std::max(most, points[i].dof);
    if (point.dof >= kWorse * most) kept.push_back(point);
  }
  return kept;
}

/// Where the shape begins to differ from one, every bin from there on.
NoiseShape measured_shape(std::vector<ShapePoint> points) {
  NoiseShape shape;
  points = best_known(std::move(points));
  const auto first = std::find_if(points.begin(), points.end(),
                                  [](const ShapePoint& point) { return std::abs(point.ratio - 1) > kVisible; });
  for (auto point = first; point != points.end(); ++point) {
    if (!shape.frequency_hz.empty() && !(point->frequency_hz > shape.frequency_hz.back())) continue;
    shape.frequency_hz.push_back(point->frequency_hz);
    shape.ratio.push_back(point->ratio);
  }
  if (!shape.ratio.empty()) shape.kind = NoiseShape::Kind::measured;
  return shape;
}

auto slowest_bin(const std::vector<PowerBin>& bins) {
  return std::min_element(bins.begin(), bins.end(),
                          [](const PowerBin& a, const PowerBin& b) { return a.frequency_hz < b.frequency_hz; });
}

/// A law goes on below the slowest coefficient, where flicker and walk leave it: long averages hold what is there.
void add_slower(const std::vector<PowerBin>& bins, const SlowLaw& law, const Mixture& rest,
                std::vector<ShapePoint>& points) {
  constexpr int kSteps = 24;  ///< of a quarter of an octave
  const auto slowest = std::min_element(
      bins.begin(), bins.end(), [](const PowerBin& a, const PowerBin& b) { return a.frequency_hz < b.frequency_hz; });
  const PowerBin with = with_law({*slowest}, law)[0];
  for (int i = 1; i <= kSteps; ++i) {
    const double slower = std::exp2(0.25 * i);
    PowerBin below = *slowest, of_law = with;
    for (PowerBin* bin : {&below, &of_law}) {
      bin->unit[static_cast<std::size_t>(Term::flicker)] *= slower;
      bin->unit[static_cast<std::size_t>(Term::walk)] *= slower * slower;
    }
    of_law.unit[static_cast<std::size_t>(Term::ramp)] *= std::pow(slower, law.exponent);
    points.push_back(
        {slowest->frequency_hz / slower, expected_energy(of_law, law.theta()) / expected_energy(below, rest), 1});
  }
}

}  // namespace

void describe_band(const std::vector<PowerBin>& bins, const Band& band, const BinProblem& problem,
                   const ModelPoint& best, double rate_hz, NoiseFit& fit) {
  fit.band.top_hz = band.top_hz;
  fit.band.orders = band.orders;
  fit.band.whole = std::all_of(band.inside.begin(), band.inside.end(), [](char in) { return in != 0; });
  fit.band.left_out_hz = stretches_left_out(bins, band);
  Band everywhere = band;
  everywhere.inside.assign(bins.size(), 1);
  const std::vector<PowerBin> all = bins_of(bins, everywhere, rate_hz);
  const Eigen::ArrayXd gain = shape_of(problem, best.shape);
  // A second process is a shape of the rest, and so is what a power law differs by from the terms.
  Mixture rest = best.theta;
  if (band.faster_s) rest[static_cast<std::size_t>(Term::quantization)] = 0;
  std::vector<double> described;
  for (const PowerBin& bin : band.law ? with_law(all, *band.law) : all)
    described.push_back(expected_energy(bin, band.law ? band.law->theta() : best.theta));
  if (band.law) rest[0] = band.law->white;
  fit.residuals = residuals_of(all, rest, rate_hz);
  Band shown = band;
  if (!shown.small.seen) shown.small = {};
  std::vector<ShapePoint> points;
  Eigen::Index inside = 0;
  for (std::size_t j = 0; j < bins.size(); ++j) {
    FitResidual& residual = fit.residuals[j];
    residual.inside = band.inside[j] != 0;
    const bool slow = bins[j].high_hz <= band.top_hz && !residual.inside && bins[j].dof <= 1;
    if (residual.inside) {
      const double ratio = gain[inside++] * described[j] / expected_energy(all[j], rest);
      const double known = std::exp(band_log_gain(shown, bins[j], rate_hz));
      points.push_back({residual.frequency_hz, ratio * known, residual.dof});
      residual.model *= ratio;
      residual.z = normal_deviate(residual.measured / residual.model, residual.dof);
    } else if (!slow) {
      const double known = std::exp(band_log_gain(shown, bins[j], rate_hz));
      points.push_back({residual.frequency_hz, known * residual.measured / residual.model, residual.dof});
    }
  }
  if (band.law) add_slower(all, *band.law, rest, points);
  fit.shape = band.filter.kind != NoiseShape::Kind::none ? band.filter : measured_shape(std::move(points));
  if (!band.low_pass) return;
  fit.bandwidth_hz = band.low_pass->corner_hz;
  const double spread = std::exp(kNormal95 * band.low_pass->log_sd);
  fit.bandwidth_ci95 = Interval{band.low_pass->corner_hz / spread, band.low_pass->corner_hz * spread};
  widen_for_joint_parameter(band.low_pass->log_theta_sd, fit);
}

void add_lines(const std::vector<PowerBin>& clipped, const std::vector<PowerBin>& full, NoiseFit& fit) {
  constexpr double kCounts = 1.02;  ///< power of a bin with its lines over that without, beyond which they count
  const auto without_lines = [&](const PowerBin& bin) {
    for (const PowerBin& other : clipped)
      if (other.low_hz == bin.low_hz && other.high_hz == bin.high_hz) return other.energy;
    return 0.0;
  };
  std::vector<ShapePoint> points;
  for (std::size_t k = 0; k < fit.shape.ratio.size() && fit.shape.frequency_hz[k] < slowest_bin(full)->frequency_hz;
       ++k)
    points.push_back({fit.shape.frequency_hz[k], fit.shape.ratio[k], 1});
  bool any = false;
  const bool flicker_phase = fit.flicker_phase && fit.flicker_phase->value;
  const std::vector<double> phase_units =
      flicker_phase ? flicker_phase_units(full, fit.rate_hz) : std::vector<double>{};
  for (const PowerBin& bin : full) {
    double terms = expected_energy(bin, fit.theta);
    if (flicker_phase)
      terms += *fit.flicker_phase->value * *fit.flicker_phase->value *
               phase_units[static_cast<std::size_t>(&bin - full.data())];
    if (fit.gauss_markov && fit.gauss_markov->in_model)
      terms += *fit.gauss_markov->sigma.value * *fit.gauss_markov->sigma.value *
               gauss_markov_unit(bin, *fit.gauss_markov->tau_s.value, fit.rate_hz);
    if (fit.bandwidth_hz) terms *= low_pass_gain(bin, *fit.bandwidth_hz, fit.rate_hz).gain;
    const bool counts = bin.dof > 4 && bin.energy > kCounts * without_lines(bin);
    any = any || counts;
    points.push_back({bin.frequency_hz,
                      counts ? bin.energy / terms : shape_ratio(fit.shape, bin.frequency_hz, fit.rate_hz), bin.dof});
  }
  if (any) fit.shape = measured_shape(std::move(points));
}

namespace {

Finding resonance_finding(const std::vector<Resonance>& resonances) {
  const bool one = resonances.size() == 1;
  std::vector<std::string> frequencies;
  for (const Resonance& resonance : resonances) frequencies.push_back(detail::frequency_text(resonance.top_hz, 2));
  Finding found = finding(
      "resonance",
      fmt::format(
          "{} at about {} {} above the noise (a vibration, or a structure that swings): {} left out of the fit, "
          "and {} in the Allan curve.",
          one ? "A resonance" : "Resonances", fmt::join(frequencies, ", "), one ? "rises" : "rise",
          one ? "it was" : "they were", one ? "is" : "are"),
      one ? "a resonance was left out" : "resonances were left out");
  for (const Resonance& resonance : resonances)
    found.where.frequency_hz.push_back({resonance.top_hz, resonance.top_hz});
  return found;
}

}  // namespace

void report_band(const Band& band, const std::vector<PowerBin>& bins, NoiseFit& fit) {
  const std::string alarm = "the noise terms alone do not describe the whole spectrum";
  if (band.quantized) fit.remedies.push_back({"quantization", alarm, "quantization noise added to the model", 1});
  if (band.low_pass)
    fit.remedies.push_back({"bandwidth", alarm,
                            fmt::format("first-order low-pass with corner {} added to the model",
                                        detail::frequency_text(band.low_pass->corner_hz, 4)),
                            1});
  if (band.filter.kind != NoiseShape::Kind::none)
    fit.remedies.push_back(
        {"shape", alarm,
         fmt::format("the spectrum is that of a {} of {} samples",
                     band.filter.kind == NoiseShape::Kind::boxcar ? "moving average (or values repeated)"
                                                                  : "triangular average",
                     band.filter.taps),
         1});
  if (band.named.family != NamedShape::Family::none)
    fit.remedies.push_back({"shape", alarm, fmt::format("the spectrum is that of {}", named_shape_text(band.named)),
                            static_cast<std::uint64_t>(band.orders)});
  else if (band.orders > 0)
    fit.remedies.push_back({"shape", alarm,
                            fmt::format("a filter's shape of {} coefficient{} fitted with the terms", band.orders,
                                        band.orders == 1 ? "" : "s"),
                            static_cast<std::uint64_t>(band.orders)});
  if (!band.resonances.empty()) fit.findings.push_back(resonance_finding(band.resonances));
  const auto left_out = static_cast<std::uint64_t>(std::count(band.inside.begin(), band.inside.end(), 0));
  // At the zeros of a filter known by name there is nothing to fit.
  if (left_out > 0 && band.filter.kind == NoiseShape::Kind::none)
    fit.remedies.push_back(
        {"band", alarm,
         fmt::format("coefficients from {} {}, {} of {} bins left out", band.bottom_hz > 0 ? "above" : "below",
                     detail::frequency_text(band.bottom_hz > 0 ? band.bottom_hz : band.top_hz, 4), left_out,
                     bins.size()),
         left_out});
}

namespace {

/// White noise whose level falls from a slow one to a fast one, and white noise beside a Gauss-Markov process, have
/// the same spectrum: which of the levels is N the record does not say.
void report_two_levels(const NamedShape& shape, NoiseFit& fit) {
  Coefficient& white = fit.term[static_cast<std::size_t>(Term::white)];
  if (shape.family != NamedShape::Family::shelf || !(shape.pole_hz < shape.zero_hz) || !white.value) return;
  const auto square = [&](double corner_hz) {
    return std::pow(std::sin(std::numbers::pi * std::min(corner_hz / fit.rate_hz, 0.5)), 2);
  };
  const double fast = std::sqrt((1 + 1 / square(shape.zero_hz)) / (1 + 1 / square(shape.pole_hz)));
  white.status = Status::undetermined;
  white.ci95.low *= fast;
  Finding both = finding("undetermined",
                         fmt::format("The spectrum is that of {}: a filter behind white noise, or white noise of {} "
                                     "and a process of a correlation time of {}. N is the level of the slow side.",
                                     named_shape_text(shape), brief_text(*white.value * fast),
                                     duration_text(1 / (2 * std::numbers::pi * shape.pole_hz))),
                         "N is undetermined: its spectrum has two levels");
  both.severity = Severity::caution;
  fit.findings.push_back(std::move(both));
}

/// Mean density between two shares of half the rate.
double density_between(const NoiseFit& fit, double from, double to) {
  double sum = 0, dof = 0;
  for (const FitResidual& residual : fit.residuals) {
    const double share = 2 * residual.frequency_hz / fit.rate_hz;
    if (share < from || share > to) continue;
    sum += residual.dof * residual.measured;
    dof += residual.dof;
  }
  return dof > 0 ? sum / dof : 0;
}

/// A free shape that falls to a level that the top octave keeps: the same two levels. A filter goes on falling, or its
/// stop band is far lower.
void report_floor(const Band& band, NoiseFit& fit) {
  constexpr double kLevel = 0.1, kHighest = 0.7, kLowest = 1.0 / 32;
  Coefficient& white = fit.term[static_cast<std::size_t>(Term::white)];
  if (band.named.family != NamedShape::Family::none || band.orders < kMany || !white.value ||
      white.status != Status::detected)
    return;
  const double below = density_between(fit, 0.5, 0.7), top = density_between(fit, 0.7, 1);
  const double share = top / (*white.value * *white.value);
  if (!(std::abs(top / below - 1) < kLevel && share > kLowest && share < kHighest)) return;
  white.status = Status::undetermined;
  white.ci95.low = std::min(white.ci95.low, std::sqrt(std::min(top, below)));
  Finding both =
      finding("undetermined",
              fmt::format("The spectrum falls to a level of {} and keeps it: a filter behind white noise and "
                          "other noise added to it, or white noise of that level and a process. N is the "
                          "level of the slow side.",
                          brief_text(std::sqrt(top))),
              "N is undetermined: its spectrum has two levels");
  both.severity = Severity::caution;
  fit.findings.push_back(std::move(both));
}

}  // namespace

void report_corner(const Band& band, NoiseFit& fit) {
  report_two_levels(band.named, fit);
  report_floor(band, fit);
  if (band.named.family != NamedShape::Family::high_pass) return;
  fit.findings.push_back(
      finding("high_passed",
              fmt::format("The slow end of the spectrum falls like that of {}: AC coupling, an output "
                          "without its mean, or a clock that is steered. B and K are those before "
                          "the high-pass.",
                          named_shape_text(band.named)),
              "the slow end of the spectrum falls as after a high-pass"));
}

void report_doubtful_end(NoiseFit& fit) {
  for (const Term slow : {Term::flicker, Term::walk}) {
    Coefficient& term = fit.term[static_cast<std::size_t>(slow)];
    if (term.status == Status::detected) term.status = Status::undetermined;
  }
  Finding found =
      finding("undetermined",
              "The slow end of the spectrum is lower than bias instability and random walk give: there is a "
              "high-pass, or a process takes their place. Their values and limits hold above it alone.",
              "B and K are undetermined: the slow end is lower than they give");
  found.severity = Severity::caution;
  fit.findings.push_back(std::move(found));
}

std::vector<FitResidual> inside_of(const std::vector<FitResidual>& residuals) {
  std::vector<FitResidual> inside;
  for (const FitResidual& residual : residuals)
    if (residual.inside) inside.push_back(residual);
  return inside;
}

}  // namespace libchar
