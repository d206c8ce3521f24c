// Expected squares of the law between two terms: those of white noise, flicker and walk go as f^0,
// f^-1, f^-2, ends of the record included, and their geometric means as the powers between,
//   A_alpha = A_white^(1 - alpha) A_flicker^alpha (alpha < 1),  A_flicker^(2 - alpha) A_walk^(alpha - 1) (alpha > 1).
// A scan of alpha, then a parabola through the least deviance; its curvature is the information on alpha.
#include "libchar/fit/detail/curve/power_law.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <numbers>

#include "libchar/core/numeric/dense.hpp"
#include "libchar/fit/detail/band/bin_likelihood.hpp"

namespace libchar {
namespace {

constexpr auto kWhiteColumn = static_cast<Eigen::Index>(Term::white);
constexpr auto kFlickerColumn = static_cast<Eigen::Index>(Term::flicker);
constexpr auto kWalkColumn = static_cast<Eigen::Index>(Term::walk);
constexpr auto kQuantizationColumn = static_cast<Eigen::Index>(Term::quantization);
constexpr auto kLawColumn = static_cast<Eigen::Index>(Term::ramp);
constexpr double kLawNeeded = 8, kLawNeededBehind = 16;      ///< of 2 lnL, and the same with a free shape
constexpr double kLawPossible = 1;                           ///< from which on N is not known without it
constexpr double kLeastExponent = 0.3, kMostExponent = 1.9;  ///< of the exponent
constexpr double kFromTerms = 3;                             ///< standard deviations from 1 and from 2

Eigen::ArrayXd law_column(const BinProblem& problem, double exponent) {
  const Eigen::ArrayXd flicker = problem.unit.col(kFlickerColumn).log();
  if (exponent < 1) return ((1 - exponent) * problem.unit.col(kWhiteColumn).log() + exponent * flicker).exp();
  return ((2 - exponent) * flicker + (exponent - 1) * problem.unit.col(kWalkColumn).log()).exp();
}

class AtExponent {
 public:
  explicit AtExponent(BinProblem problem) : problem_(std::move(problem)) {
    terms_[kWhiteColumn] = terms_[kLawColumn] = true;
  }
  ScoringResult operator()(double exponent) {
    problem_.unit.col(kLawColumn) = law_column(problem_, exponent);
    return score(problem_, terms_, nullptr, 1e-6);
  }
  /// sd of ln Q² at a point, h and alpha unknown.
  double white_log_sd(const ModelPoint& at, double exponent) {
    constexpr double kStep = 0.01;
    const Eigen::ArrayXd weight = (problem_.dof / 2).sqrt() / mixture_of(problem_, at.theta);
    Eigen::MatrixXd slopes(problem_.size(), 3);
    slopes.col(0) = (weight * at.theta[kWhiteColumn] * problem_.unit.col(kWhiteColumn)).matrix();
    slopes.col(1) = (weight * at.theta[kLawColumn] * law_column(problem_, exponent)).matrix();
    slopes.col(2) = (weight * at.theta[kLawColumn] *
                     (law_column(problem_, exponent + kStep) - law_column(problem_, exponent - kStep)) / (2 * kStep))
                        .matrix();
    if (problem_.shapes() > 0) slopes = without_columns_of(whitened_shape(problem_), slopes);
    return std::sqrt(cholesky_inverse(slopes.transpose() * slopes)(0, 0));
  }

 private:
  BinProblem problem_;
  TermSet terms_{};
};

}  // namespace

namespace {

/// The band's law describes the whole spectrum.
bool describes(const Band& whole, const std::vector<PowerBin>& bins, double rate_hz) {
  const auto judgement = judged(with_law(bins, *whole.law), rate_hz, {true, false, false, false, true}, whole);
  return judgement && std::min(judgement->goodness.p, judgement->top.p) > BandOptions{}.misfit;
}

/// The terms are those of samples, folded at half the rate; a law that was band-limited before it was sampled is lower
/// there, by (sin x / x)^alpha, x = pi f / rate: what that is of white noise's power.
double folded_share(const std::vector<PowerBin>& bins, const ModelPoint& at, double exponent, double rate_hz) {
  double share = 0, dof = 0;
  for (const PowerBin& bin : with_law(bins, {exponent})) {
    const double x = std::numbers::pi * bin.frequency_hz / rate_hz;
    const double white = at.theta[kWhiteColumn] * bin.unit[kWhiteColumn];
    share += bin.dof * at.theta[kLawColumn] * bin.unit[kLawColumn] * (1 - std::pow(std::sin(x) / x, exponent)) / white;
    dof += bin.dof;
  }
  return share / dof;
}

/// The terms in a band of the whole spectrum, each unknown of its shape worth one of ln L.
bool terms_are_likelier(const Band& band, const std::vector<PowerBin>& bins, double rate_hz, TermSet terms,
                        const PowerLawChoice& law) {
  if (!band.passes || band.inside != law.band.inside) return false;
  terms[kQuantizationColumn] = terms[kQuantizationColumn] || band.quantized;
  const int unknowns = band.orders + (band.low_pass ? 1 : 0) + (band.quantized ? 1 : 0);
  return score(band_problem(bins, band, rate_hz), terms).half_deviance + unknowns < law.half_deviance;
}

std::optional<PowerLawChoice> law_in(const std::vector<PowerBin>& bins, const Band& band, double rate_hz,
                                     const TermSet& terms) {
  constexpr int kSteps = 8;
  // Quantization noise bends the terms towards another exponent, so that it is among what the law must beat.
  TermSet offered = terms;
  offered[kQuantizationColumn] = offered[kQuantizationColumn] || band.quantized;
  const BinProblem problem = band_problem(bins, band, rate_hz);
  const double terms_alone = score(problem, offered).half_deviance;
  AtExponent law(problem);
  std::array<double, kSteps + 1> value{};
  std::size_t least = 0;
  const double step = (kMostExponent - kLeastExponent) / kSteps;
  for (std::size_t i = 0; i < value.size(); ++i) {
    value[i] = law(kLeastExponent + step * static_cast<double>(i)).half_deviance;
    if (value[i] < value[least]) least = i;
  }
  if (least == 0 || least == kSteps || !std::isfinite(terms_alone)) return std::nullopt;
  const double bend = value[least - 1] - 2 * value[least] + value[least + 1];
  if (!(bend > 0)) return std::nullopt;
  PowerLawChoice out;
  out.exponent =
      kLeastExponent + step * (static_cast<double>(least) + 0.5 * (value[least - 1] - value[least + 1]) / bend);
  out.exponent_sd = step / std::sqrt(bend);
  const ScoringResult best = law(out.exponent);
  out.half_deviance = best.half_deviance;
  out.likelihood_ratio = 2 * (terms_alone - best.half_deviance);
  if (!(out.likelihood_ratio > kLawPossible) || !(best.at.theta[kWhiteColumn] > 0) || !(best.at.theta[kLawColumn] > 0))
    return std::nullopt;
  out.needed = out.likelihood_ratio > (band.orders > 0 ? kLawNeededBehind : kLawNeeded);
  for (const double whole : {1.0, 2.0})
    out.needed = out.needed && !(std::abs(out.exponent - whole) < kFromTerms * out.exponent_sd);
  out.band = band;
  if (band.orders == 0) out.band.law = {out.exponent, best.at.theta[kWhiteColumn], best.at.theta[kLawColumn]};
  out.white = std::sqrt(best.at.theta[kWhiteColumn]);
  out.white_log_sd =
      std::hypot(law.white_log_sd(best.at, out.exponent), folded_share(bins, best.at, out.exponent, rate_hz));
  return out;
}

}  // namespace

std::vector<PowerBin> with_law(std::vector<PowerBin> bins, const SlowLaw& law) {
  const Eigen::ArrayXd units = law_column(bin_problem(bins), law.exponent);
  for (std::size_t j = 0; j < bins.size(); ++j) bins[j].unit[kLawColumn] = units[static_cast<Eigen::Index>(j)];
  return bins;
}

std::optional<PowerLawChoice> choose_power_law(const std::vector<PowerBin>& bins, const Band& band, double rate_hz,
                                               const TermSet& terms) {
  if (!terms[kWhiteColumn] || !terms[kFlickerColumn] || !terms[kWalkColumn] || terms[kLawColumn]) return std::nullopt;
  if (band.orders > 0 || band.low_pass || band.quantized || band.top_hz < 0.99 * rate_hz / 2) {
    const auto law = law_in(bins, whole_band(bins, rate_hz), rate_hz, terms);
    if (law && law->needed && describes(law->band, bins, rate_hz) &&
        !terms_are_likelier(band, bins, rate_hz, terms, *law))
      return law;
  }
  return band.passes ? law_in(bins, band, rate_hz, terms) : std::nullopt;
}

void reach_to_law(const PowerLawChoice& law, NoiseFit& fit) {
  Coefficient& white = fit.term[kWhiteColumn];
  if (!white.value) return;
  const double spread = std::exp(kNormal95 * law.white_log_sd / 2);
  white.ci95 = {std::min(white.ci95.low, law.white / spread), std::max(white.ci95.high, law.white * spread)};
}

void answer_power_law(const PowerLawChoice& law, NoiseFit& fit) {
  Coefficient& white = fit.term[kWhiteColumn];
  if (white.value) {
    white.value = law.white;
    white.relative_sd = law.white_log_sd / 2;
    const double spread = std::exp(kNormal95 * white.relative_sd);
    white.ci95 = {law.white / spread, law.white * spread};
  }
  if (law.band.law && fit.theta[0] > 0) fit.theta[0] = law.band.law->white;
  for (const auto slow : {kFlickerColumn, kWalkColumn, kQuantizationColumn})
    if (fit.term[static_cast<std::size_t>(slow)].value)
      fit.term[static_cast<std::size_t>(slow)].status = Status::misfit;
  fit.findings.push_back(finding(
      "power_law",
      fmt::format(
          "The slow noise follows 1/f^{:.2f} (95 % interval {:.2f} to {:.2f}), which is neither flicker nor a random "
          "walk (2 ln L {:.0f}): B and K replace it within this recording and mean nothing beyond it.",
          law.exponent, law.exponent - kNormal95 * law.exponent_sd, law.exponent + kNormal95 * law.exponent_sd,
          law.likelihood_ratio),
      fmt::format("the slow noise follows 1/f^{:.2f}, neither flicker nor walk", law.exponent)));
}

}  // namespace libchar
