// S(f) = 2 sigma² tau / (1 + (2 pi f tau)²), sampled (model/sensor_model.hpp). For a given tau its expected squared
// coefficients are one column more of the linear model, so that the likelihood's maximum over the other unknowns is a
// function of ln tau alone: a scan by octaves, then a parabola through its three lowest points, again and again. The
// column is lent by the ramp, which is a mean and is offered elsewhere (events.hpp).
//   needed:   2 (lnL(terms + process) - lnL(terms)) > kNeeded, with all offered terms in both, so that the terms alone
//             are a special case (sigma = 0, and walk as tau -> infinity): passed by at most 1 % of records of their
//             kind (docs/theory/fit.md)
//   rival:    not needed, but white noise and the process alone are more likely than all offered terms by kRival:
//             passed by 5 % of walks
//   two:      where one is needed or the terms do not describe the whole spectrum, the same scan of a second, faster
//             one around that of the first, in the column of quantization noise; its power is a shape of the rest
// Flicker and walk then stay or go by the same elimination as ever (coefficients.cpp). Intervals: tau by profile
// likelihood; sigma by the union, over the taus in that interval, of its own intervals given tau, each as wide as the
// likelihood has left.
#include "libchar/fit/detail/curve/gauss_markov_fit.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "libchar/core/numeric/dense.hpp"
#include "libchar/core/numeric/whole.hpp"
#include "libchar/core/text/readable.hpp"
#include "libchar/fit/detail/band/bin_likelihood.hpp"
#include "libchar/fit/detail/curve/coefficients.hpp"
#include "libchar/fit/detail/curve/power_law.hpp"
#include "libchar/fit/detail/curve/profile.hpp"
#include "libchar/fit/detail/record/dct_means.hpp"

namespace libchar {
namespace {

constexpr double kNeeded = 10;          ///< of 2 lnL
constexpr double kRival = 2.71;         ///< of 2 lnL
constexpr double kSlowNoise = 4;        ///< of 2 lnL that flicker and walk together must be worth
constexpr double kFewestSamples = 100;  ///< of a correlation time: a faster process may be a filter's affair
constexpr double kFastest = 8;          ///< unless white noise is seen above it, of which a filter leaves nothing
constexpr double kFloor = 1e-3;         ///< least of that over the plateau of the process: less may be rounding
constexpr double kSteep = 4;            ///< of the plateau over that: less may be a filter's shelf
constexpr double kBeside =
    0.2;  ///< of the plateau over flicker and walk at its corner: less is their exponent's affair
constexpr double kLongest = 0.5;  ///< of the record
constexpr double kFarAbove = 8;   ///< of the rate over the fewest samples, which is six of its corner
constexpr double kWidth = 1.9;    ///< of the other band that is worth the process
constexpr double kBadlyKnown = 0.30;
constexpr auto kLent = static_cast<std::size_t>(Term::ramp);
constexpr auto kFaster = static_cast<std::size_t>(Term::quantization);
constexpr auto kColumn = static_cast<Eigen::Index>(Term::ramp);

/// The likelihood of a band's bins as a function of the correlation time.
class AtTau {
 public:
  AtTau(const std::vector<PowerBin>& bins, const Band& band, double rate_hz, TermSet terms)
      : rate_hz_(rate_hz), terms_(terms) {
    terms_[kLent] = true;
    terms_[kFaster] = terms_[kFaster] || band.quantized || band.faster_s;
    faster_s_ = band.faster_s;
    Band without = band;
    without.tau_s = std::nullopt;
    for (std::size_t j = 0; j < bins.size(); ++j)
      if (band.inside[j] != 0) inside_.push_back(bins[j]);
    const std::vector<PowerBin> filtered = bins_of(bins, without, rate_hz);
    problem_ = band_problem(bins, without, rate_hz);
    for (std::size_t j = 0; j < inside_.size(); ++j) gain_.push_back(filtered[j].unit[0] / inside_[j].unit[0]);
  }

  /// A second, faster process, in the column of quantization noise.
  void offer_faster(double tau_s) {
    terms_[kFaster] = true;
    problem_.unit.col(static_cast<Eigen::Index>(kFaster)) = column(tau_s);
  }

  const ScoringResult& operator()(double tau_s) {
    problem_.unit.col(kColumn) = column(tau_s);
    result_ = score(problem_, terms_, warm_ ? &*warm_ : nullptr, 1e-5);
    if (std::isfinite(result_.half_deviance)) warm_ = result_.at;
    return result_;
  }

  ScoringResult without() const {
    TermSet terms = terms_;
    terms[kLent] = false;
    return score(problem_, terms, nullptr, 1e-5);
  }

  /// sd of ln sigma² and of the others' ln theta, and of ln tau (last), at a point: joint, and of ln sigma² given tau.
  struct Spread {
    Mixture log_theta{};
    double log_tau = 0, given_tau = 0;
  };
  Spread spread_at(const ModelPoint& at, double tau_s);

 private:
  Eigen::ArrayXd column(double tau_s) const {
    Eigen::ArrayXd out(problem_.size());
    for (std::size_t j = 0; j < inside_.size(); ++j)
      out[static_cast<Eigen::Index>(j)] = gain_[j] * gauss_markov_unit(inside_[j], tau_s, rate_hz_);
    return out;
  }

  double rate_hz_;
  TermSet terms_;
  std::optional<double> faster_s_;
  std::vector<PowerBin> inside_;
  std::vector<double> gain_;
  BinProblem problem_;
  ScoringResult result_;
  std::optional<ModelPoint> warm_;
};

AtTau::Spread AtTau::spread_at(const ModelPoint& at, double tau_s) {
  constexpr double kStep = 0.01;
  problem_.unit.col(kColumn) = column(tau_s);
  const Eigen::ArrayXd weight = (problem_.dof / 2).sqrt() / mixture_of(problem_, at.theta);
  std::vector<std::size_t> in;
  for (std::size_t i = 0; i < kTerms; ++i)
    if (at.theta[i] > 0) in.push_back(i);
  const auto n = static_cast<Eigen::Index>(in.size());
  Eigen::MatrixXd relative(problem_.size(), n + 1 + (faster_s_ ? 1 : 0));
  for (Eigen::Index i = 0; i < n; ++i)
    relative.col(i) = (weight * at.theta[in[static_cast<std::size_t>(i)]] *
                       problem_.unit.col(static_cast<Eigen::Index>(in[static_cast<std::size_t>(i)])))
                          .matrix();
  // A vector, not Eigen's expression: that would refer to columns which are gone.
  const auto slope = [&](double theta, double time_s) -> Eigen::VectorXd {
    return (weight * theta * (column(time_s * (1 + kStep)) - column(time_s * (1 - kStep))) / (2 * kStep)).matrix();
  };
  relative.col(n) = slope(at.theta[kLent], tau_s);
  if (faster_s_) relative.col(n + 1) = slope(at.theta[kFaster], *faster_s_);
  if (problem_.shapes() > 0) relative = without_columns_of(whitened_shape(problem_), relative);
  const Eigen::MatrixXd information = relative.transpose() * relative;
  const Eigen::MatrixXd joint = cholesky_inverse(information);
  const Eigen::MatrixXd given = cholesky_inverse(information.topLeftCorner(n, n));
  Spread out;
  for (Eigen::Index i = 0; i < n; ++i) {
    const std::size_t term = in[static_cast<std::size_t>(i)];
    out.log_theta[term] = std::sqrt(joint(i, i));
    if (term == kLent) out.given_tau = std::sqrt(given(i, i));
  }
  out.log_tau = std::sqrt(joint(n, n));
  return out;
}

struct Peak {
  double tau_s = 0, half_deviance = std::numeric_limits<double>::infinity();
  ModelPoint at;
  double slower_s = 0;  ///< of two processes, the correlation time of the other
};

/// The correlation time of the greatest likelihood between two; `likelihood` of one is a Peak.
template <typename Likelihood>
Peak most_likely(Likelihood&& likelihood, double low_s, double high_s) {
  std::vector<double> x, value;
  Peak best;
  std::size_t at = 0;
  const auto look = [&](double log_tau) {
    const Peak found = likelihood(std::exp(log_tau));
    if (found.half_deviance < best.half_deviance) best = found;
    return found.half_deviance;
  };
  const double first = std::log(low_s), last = std::log(high_s);
  const int steps = std::max(2, clamped_whole<int>(std::ceil((last - first) / std::log(2.0))));
  for (int i = 0; i <= steps; ++i) {
    x.push_back(first + (last - first) * i / steps);
    value.push_back(look(x.back()));
    if (value.back() < value[at]) at = x.size() - 1;
  }
  if (at == 0 || at + 1 == x.size()) return best;
  std::array<double, 3> place = {x[at - 1], x[at], x[at + 1]};
  std::array<double, 3> depth = {value[at - 1], value[at], value[at + 1]};
  for (int round = 0; round < 4; ++round) {
    const double left = place[1] - place[0], right = place[2] - place[1];
    const double down = (depth[0] - depth[1]) / left, up = (depth[2] - depth[1]) / right;
    const double where = place[1] + 0.5 * (down * right - up * left) / std::max(down + up, 1e-12);
    if (!(where > place[0] && where < place[2]) || std::abs(where - place[1]) < 1e-3) break;
    const double found = look(where);
    const bool better = found<depth[1], above = where> place[1];
    if (better) {
      (above ? place[0] : place[2]) = place[1];
      (above ? depth[0] : depth[2]) = depth[1];
      place[1] = where;
      depth[1] = found;
    } else {
      (above ? place[2] : place[0]) = where;
      (above ? depth[2] : depth[0]) = found;
    }
  }
  return best;
}

Peak most_likely(AtTau& likelihood, double low_s, double high_s) {
  const auto at = [&](double tau_s) {
    const ScoringResult& result = likelihood(tau_s);
    return Peak{tau_s, result.half_deviance, result.at};
  };
  return most_likely(at, low_s, high_s);
}

TermSet without_slow(TermSet terms) {
  terms[static_cast<std::size_t>(Term::flicker)] = false;
  terms[static_cast<std::size_t>(Term::walk)] = false;
  return terms;
}

struct TauSearch {
  Peak peak;
  double ratio = 0;
  double without = 0;  ///< half deviance of the terms alone
};

TauSearch search_tau(const std::vector<PowerBin>& bins, const Band& band, double rate_hz, double duration_s,
                     const TermSet& terms, double fewest_samples = kFewestSamples) {
  AtTau likelihood(bins, band, rate_hz, terms);
  TauSearch out;
  out.without = likelihood.without().half_deviance;
  out.peak = most_likely(likelihood, fewest_samples / rate_hz, kLongest * duration_s);
  constexpr double kNone = 1e-6;  // of the difference of two sums: their rounding, and where the descents ended
  const double ratio = 2 * (out.without - out.peak.half_deviance);
  out.ratio = ratio > kNone ? ratio : 0;
  return out;
}

double process_at(double variance, double tau_s, double frequency_hz) {
  const double turns = 2 * std::numbers::pi * frequency_hz * tau_s;
  return 2 * variance * tau_s / (1 + turns * turns);
}

double process_at(const Peak& peak, double frequency_hz) {
  return process_at(peak.at.theta[kLent], peak.tau_s, frequency_hz);
}

/// A fall from a plateau of at least `steep` times white noise that flicker and walk do not hide at its corner to that.
bool falls_to_white(const std::vector<PowerBin>& bins, const Peak& peak, double steep = kSteep) {
  const double plateau = process_at(peak, 0), corner_hz = 1 / (2 * std::numbers::pi * peak.tau_s);
  const double white = peak.at.theta[0];
  const auto at = std::find_if(bins.begin(), bins.end(), [&](const PowerBin& bin) { return bin.high_hz > corner_hz; });
  if (at == bins.end()) return false;
  double slow = 0;
  for (const Term term : {Term::flicker, Term::walk})
    slow += peak.at.theta[static_cast<std::size_t>(term)] * at->unit[static_cast<std::size_t>(term)];
  return white > kFloor * plateau && plateau > steep * white && plateau > kBeside * slow;
}

/// The whole spectrum with a process has no rival that is as wide: chance may speak against it as it does once in a
/// thousand.
std::optional<Band> describing(std::optional<Band> whole) {
  if (!whole || std::min(whole->goodness.p, whole->top.p) < BandOptions{}.misfit) return std::nullopt;
  whole->passes = true;
  return whole;
}

/// The whole band without a shape, where the terms with a process describe it: the fall to white noise that shapes and
/// a cut band had in its place.
std::optional<Band> unshaped_band(const std::vector<PowerBin>& bins, double rate_hz, double duration_s,
                                  const TermSet& terms) {
  const Peak peak = search_tau(bins, whole_band(bins, rate_hz), rate_hz, duration_s, terms, kFastest).peak;
  if (!falls_to_white(bins, peak)) return std::nullopt;
  BandOptions options;
  options.tau_s = peak.tau_s;
  Band whole = whole_band(bins, rate_hz);
  whole.tau_s = peak.tau_s;
  if (auto described = describing(judged(bins, rate_hz, terms, whole))) return described;
  Band band = find_band(bins, rate_hz, terms, options);
  if (!band.passes || band.orders > 0 || band.top_hz < 0.99 * rate_hz / 2 || band.low_pass) return std::nullopt;
  return band;
}

constexpr double kFewest = 2;  ///< samples of the correlation time of what may be a filter as well

/// A process above white noise as what a filter leaves: a shelf that falls has the same spectrum.
std::optional<Band> as_shelf(const std::vector<PowerBin>& bins, double rate_hz, const TermSet& terms, const Band& band,
                             double tau_s, double plateau_over_white) {
  NamedShape start;
  start.family = NamedShape::Family::shelf;
  start.pole_hz = 1 / (2 * std::numbers::pi * tau_s);
  start.zero_hz = start.pole_hz * std::sqrt(1 + plateau_over_white);
  return describing(with_shelf(bins, rate_hz, terms, band, start));
}

/// The whole spectrum with one process of few samples, where that describes it, as a shelf: of a step that may be small
/// where the shape that takes its place describes the whole spectrum too, less likely, of `rival`, for its unknowns.
std::optional<Band> band_of_fast(const std::vector<PowerBin>& bins, double rate_hz, double duration_s,
                                 const TermSet& terms, std::optional<double> rival) {
  constexpr double kWorth = 3;     ///< of ln L, two of them for the unknowns
  constexpr double kLeast = 0.1;   ///< of white noise
  constexpr double kShortest = 1;  ///< sample of the correlation time
  const Band whole = whole_band(bins, rate_hz);
  const Peak peak = search_tau(bins, whole, rate_hz, duration_s, terms, rival ? kShortest : kFewest).peak;
  if (!(peak.tau_s < kFastest / rate_hz) || !falls_to_white(bins, peak, rival ? kLeast : kSteep)) return std::nullopt;
  if (rival && !(peak.half_deviance + kWorth < *rival)) return std::nullopt;
  return as_shelf(bins, rate_hz, terms, whole, peak.tau_s, process_at(peak, 0) / peak.at.theta[0]);
}

/// Two processes, the faster above white noise: the whole spectrum, where they describe it. A faster one of few samples
/// may be a filter: it is a shelf that falls, which has the same spectrum.
std::optional<Band> band_of_two(const std::vector<PowerBin>& bins, double rate_hz, double duration_s,
                                const TermSet& terms) {
  constexpr double kApart = 4;    ///< of the slower correlation time over the faster
  constexpr double kOverLaw = 6;  ///< of ln L: a power law has four unknowns less
  if (terms[kFaster]) return std::nullopt;
  Band band = whole_band(bins, rate_hz);
  AtTau both(bins, band, rate_hz, terms);
  const auto at = [&](double faster_s) {
    both.offer_faster(faster_s);
    const Peak slower = most_likely(both, kApart * faster_s, kLongest * duration_s);
    return Peak{faster_s, slower.half_deviance, slower.at, slower.tau_s};
  };
  const Peak faster = most_likely(at, kFewest / rate_hz, kLongest / kApart * duration_s);
  const double white = faster.at.theta[0], plateau = process_at(faster.at.theta[kFaster], faster.tau_s, 0);
  if (!(white > kFloor * plateau && plateau > kSteep * white)) return std::nullopt;
  const auto law = choose_power_law(bins, band, rate_hz, terms);
  if (law && law->needed && law->half_deviance < faster.half_deviance + kOverLaw) return std::nullopt;
  band.tau_s = faster.slower_s;
  if (!(faster.tau_s > kFastest / rate_hz)) return as_shelf(bins, rate_hz, terms, band, faster.tau_s, plateau / white);
  band.faster_s = faster.tau_s;
  return describing(judged(bins, rate_hz, terms, band));
}

/// A band that the terms with the process describe: found with the process at its most likely correlation time under
/// any shape, or at that of the cut band.
std::optional<Band> other_band(const std::vector<PowerBin>& bins, const Band& band, double rate_hz, double duration_s,
                               const TermSet& terms, double tau_in_band_s) {
  BandOptions options;
  Band shaped = whole_band(bins, rate_hz);
  shaped.orders = options.most_orders;
  std::optional<Band> best;
  for (const double tau_s : {search_tau(bins, shaped, rate_hz, duration_s, terms).peak.tau_s, tau_in_band_s}) {
    options.tau_s = tau_s;
    Band other = find_band(bins, rate_hz, terms, options);
    if (!other.passes || (band.passes && other.top_hz < kWidth * band.top_hz)) continue;
    if (!best || other.top_hz > 1.01 * best->top_hz) best = std::move(other);
  }
  return best;
}

}  // namespace

std::optional<GaussMarkovChoice> choose_gauss_markov(const std::vector<PowerBin>& bins, const Band& band,
                                                     double rate_hz, double duration_s, const TermSet& terms) {
  const bool cut = !band.passes || band.top_hz < 0.99 * rate_hz / 2;
  // The corner of a process looks like a peak to a spectrum without one: what is left out as a resonance may be that.
  const std::size_t unknowns = unknowns_of(band) + (band.low_pass && !band.hidden.empty() ? 1 : 0);
  const bool shaped = unknowns > 0 && band.named.family != NamedShape::Family::high_pass;
  if (terms[kLent] || duration_s * rate_hz * kLongest < 4 * kFewestSamples) return std::nullopt;
  if (!terms[0] || !terms[static_cast<std::size_t>(Term::walk)]) return std::nullopt;
  AtTau rival(bins, band, rate_hz, without_slow(terms));
  const double no_slow = rival.without().half_deviance;
  const double with_slow = AtTau(bins, band, rate_hz, terms).without().half_deviance;
  if (!cut && !shaped && 2 * (no_slow - with_slow) < kSlowNoise) return std::nullopt;

  // A process that white noise does not take over before the band ends, or a faster one, is noise behind a filter.
  const auto filters = [&](const Band& in, const Peak& peak) {
    return peak.tau_s < 1.01 * kFewestSamples / rate_hz ||
           (in.top_hz < 0.99 * rate_hz / 2 && peak.at.theta[0] < kSteep * process_at(peak, in.top_hz));
  };
  TauSearch here = search_tau(bins, band, rate_hz, duration_s, terms);
  GaussMarkovChoice choice{band, here.peak.tau_s, here.ratio};
  choice.needed = here.ratio > kNeeded && !filters(band, here.peak);
  choice.half_deviance = here.peak.half_deviance;
  const bool doubtful = cut || shaped;
  std::optional<Band> other = doubtful ? unshaped_band(bins, rate_hz, duration_s, terms) : std::nullopt;
  if (doubtful || choice.needed) {
    const auto deviance = [&](const Band& of) {
      return search_tau(bins, of, rate_hz, duration_s, terms, kFastest).peak.half_deviance;
    };
    const double one = other      ? deviance(*other)
                       : doubtful ? std::numeric_limits<double>::infinity()
                                  : here.peak.half_deviance;
    const auto two = band_of_two(bins, rate_hz, duration_s, terms);
    if (two && deviance(*two) + kNeeded / 2 < one) other = two;
  }
  const bool free = other.has_value();  // of a filter's affair
  // Above its corner a process is a walk: a band that ends octaves above the fastest one was not cut by it.
  const bool cut_far_above = band.passes && band.top_hz > kFarAbove * rate_hz / kFewestSamples;
  if (!other && cut && !cut_far_above) other = other_band(bins, band, rate_hz, duration_s, terms, here.peak.tau_s);
  if (other) {
    here = search_tau(bins, *other, rate_hz, duration_s, terms, free ? kFastest : kFewestSamples);
    if (here.ratio > kNeeded && (free || !filters(*other, here.peak)))
      choice = {*other, here.peak.tau_s, here.ratio, true, 0, here.peak.half_deviance};
  }
  if (choice.needed) {
    choice.band.tau_s = choice.tau_s;
    return choice;
  }
  // A free shape and a cut band see the slow side of a fall alone.
  if (cut || (shaped && band.named.family == NamedShape::Family::none)) {
    std::optional<double> as_likely;
    if (!cut) as_likely = here.without + static_cast<double>(unknowns);
    if (const auto fast = band_of_fast(bins, rate_hz, duration_s, terms, as_likely)) choice.band = *fast;
  }
  const Peak alone = most_likely(rival, kFewestSamples / rate_hz, kLongest * duration_s);
  if (alone.tau_s < 0.45 * duration_s && alone.half_deviance < with_slow - kRival / 2) {
    choice.tau_s = alone.tau_s;
    choice.rival_sigma = std::sqrt(alone.at.theta[kLent]);
  }
  return choice;
}

double likeliest_tau(const std::vector<PowerBin>& bins, const Band& band, double rate_hz, const Mixture& theta) {
  AtTau likelihood(bins, band, rate_hz, only_positive(theta));
  return most_likely(likelihood, *band.tau_s / 2, *band.tau_s * 2).tau_s;
}

namespace {

/// Where 2 lnL has fallen by its 95 % point, from tau outward; infinite or zero when it does not within `factor`.
double profile_end(AtTau& likelihood, const Peak& peak, double log_sd, double sign, double factor) {
  const auto excess = [&](double log_tau) {
    return 2 * (likelihood(std::exp(log_tau)).half_deviance - peak.half_deviance) - kTwoSided95;
  };
  double in = std::log(peak.tau_s), out = in;
  double step = std::clamp(2 * log_sd, 0.02, 0.7);
  do {
    in = out;
    out += sign * step;
    if (std::abs(out - std::log(peak.tau_s)) > std::log(factor))
      return sign > 0 ? std::numeric_limits<double>::infinity() : 0;
  } while (excess(out) < 0);
  for (int i = 0; i < 12; ++i) {
    const double middle = 0.5 * (in + out);
    (excess(middle) < 0 ? in : out) = middle;
  }
  return std::exp(0.5 * (in + out));
}

/// Of sigma: the union over tau of its intervals given tau.
Interval sigma_interval(AtTau& likelihood, const Peak& peak, Interval tau_s, double given_tau) {
  constexpr int kPoints = 12;
  const double far = std::min(tau_s.high, 100 * peak.tau_s), near = std::max(tau_s.low, 0.01 * peak.tau_s);
  Interval out = {std::sqrt(peak.at.theta[kLent]), std::sqrt(peak.at.theta[kLent])};
  for (int i = 0; i <= kPoints; ++i) {
    const ScoringResult& there = likelihood(near * std::pow(far / near, static_cast<double>(i) / kPoints));
    const double fallen = 2 * (there.half_deviance - peak.half_deviance);
    const double left = std::sqrt(std::max(0.0, kTwoSided95 - fallen));
    const double sigma = std::sqrt(there.at.theta[kLent]);
    out.low = std::min(out.low, sigma * std::exp(-0.5 * left * given_tau));
    out.high = std::max(out.high, sigma * std::exp(0.5 * left * given_tau));
  }
  return out;
}

/// Bounds of the terms and of the process: what the record's information leaves with tau unknown.
void report_joint_bounds(const Mixture& log_theta, NoiseFit& fit) {
  for (std::size_t i = 0; i < kTerms; ++i) {
    Coefficient& term = fit.term[i];
    if (!term.value || !(log_theta[i] > 0)) continue;
    term.bound = log_theta[i] / 2;
    if (!(*term.bound > kBadlyKnown) || term.status != Status::detected || i == kLent) continue;
    term.status = Status::undetermined;
    fit.findings.push_back(finding(
        "too_short",
        fmt::format("The record is too short for {} next to a Gauss-Markov process: at best it is known to {} (1 sd).",
                    long_name(static_cast<Term>(i)), percent_text(*term.bound))));
  }
}

/// Terms that were dropped but may be there take part in the intervals (coefficients.cpp).
TermSet kept_or_doubtful(const NoiseFit& fit) {
  constexpr double kDoubtful = 1;
  TermSet terms = only_positive(fit.theta);
  for (std::size_t i = 0; i < kTerms; ++i)
    terms[i] = terms[i] || (fit.term[i].status != Status::not_fitted && fit.term[i].likelihood_ratio > kDoubtful);
  return terms;
}

/// A term's place in the fit is empty again.
void empty_column(std::size_t lent, NoiseFit& fit) {
  fit.term[lent] = {};
  fit.theta[lent] = 0;
  for (std::size_t i = 0; i < kTerms; ++i) fit.covariance[i][lent] = fit.covariance[lent][i] = 0;
}

std::string process_text(double sigma, double tau_s) {
  return fmt::format("standard deviation {}, correlation time {}", brief_text(sigma), duration_text(tau_s));
}

/// The second process is part of the shape (band_report.cpp).
void settle_faster(double tau_s, NoiseFit& fit) {
  const double sigma = fit.term[kFaster].value.value_or(0);
  empty_column(kFaster, fit);
  if (!(sigma > 0)) return;
  fit.findings.push_back(finding(
      "gauss_markov",
      fmt::format("The noise holds a second, faster Gauss-Markov process ({}). The model has it in the shape of the "
                  "spectrum.",
                  process_text(sigma, tau_s))));
}

}  // namespace

void settle_gauss_markov(const std::vector<PowerBin>& bins, const GaussMarkovChoice& choice, NoiseFit& fit) {
  if (choice.band.faster_s) settle_faster(*choice.band.faster_s, fit);
  if (!(fit.theta[kLent] > 0)) return empty_column(kLent, fit);
  AtTau likelihood(bins, choice.band, fit.rate_hz, kept_or_doubtful(fit));
  const Peak peak = most_likely(likelihood, choice.tau_s / 2, choice.tau_s * 2);
  const AtTau::Spread spread = likelihood.spread_at(peak.at, peak.tau_s);
  GaussMarkovFit process;
  process.sigma = fit.term[kLent];
  process.sigma.likelihood_ratio = choice.likelihood_ratio;
  process.sigma.seconds_for_10_percent = std::nullopt;
  process.tau_s.status = process.sigma.status;
  process.tau_s.value = choice.tau_s;
  process.tau_s.profile = process.sigma.profile = true;
  process.tau_s.relative_sd = spread.log_tau;
  process.tau_s.bound = spread.log_tau;
  process.tau_s.likelihood_ratio = choice.likelihood_ratio;
  process.tau_s.ci95 = {profile_end(likelihood, peak, spread.log_tau, -1, 1e3),
                        profile_end(likelihood, peak, spread.log_tau, 1, 1e3)};
  if (choice.band.faster_s) {  // the profile holds the other's correlation time
    process.tau_s.ci95.low = std::min(process.tau_s.ci95.low, choice.tau_s * std::exp(-kNormal95 * spread.log_tau));
    process.tau_s.ci95.high = std::max(process.tau_s.ci95.high, choice.tau_s * std::exp(kNormal95 * spread.log_tau));
  }
  // The peak beside terms that were dropped but may be there is elsewhere.
  process.tau_s.ci95.low = std::min(process.tau_s.ci95.low, choice.tau_s);
  process.tau_s.ci95.high = std::max(process.tau_s.ci95.high, choice.tau_s);
  report_joint_bounds(spread.log_theta, fit);
  process.sigma.bound = process.sigma.relative_sd = spread.log_theta[kLent] / 2;
  process.sigma.ci95 = sigma_interval(likelihood, peak, process.tau_s.ci95, spread.given_tau);
  process.sigma.ci95.low = std::min(process.sigma.ci95.low, *process.sigma.value);
  process.sigma.ci95.high = std::max(process.sigma.ci95.high, *process.sigma.value);
  widen_for_joint_parameter(spread.log_theta, fit);
  fit.findings.push_back(finding(
      "gauss_markov",
      fmt::format("Part of the slow noise is a first-order Gauss-Markov process ({}): white noise, flicker and random "
                  "walk alone do not describe the record (2 ln L {:.0f}, above {:.0f} in 1 % of records that they do).",
                  process_text(process.sigma.value.value_or(0), choice.tau_s), choice.likelihood_ratio, kNeeded)));
  empty_column(kLent, fit);
  fit.gauss_markov = process;
}

void report_not_needed(const GaussMarkovChoice& choice, NoiseFit& fit) {
  GaussMarkovFit process;
  process.in_model = false;
  process.sigma.status = process.tau_s.status = Status::not_detected;
  process.sigma.likelihood_ratio = process.tau_s.likelihood_ratio = choice.likelihood_ratio;
  fit.gauss_markov = process;
  if (!(choice.rival_sigma > 0)) return;
  process.sigma.status = process.tau_s.status = Status::undetermined;
  process.sigma.value = choice.rival_sigma;
  process.tau_s.value = choice.tau_s;
  fit.gauss_markov = process;
  fit.findings.push_back(
      finding("gauss_markov_or_terms",
              fmt::format("The record cannot tell its slow noise from a first-order Gauss-Markov process ({}): that "
                          "with white noise alone is as likely. A longer record can tell.",
                          process_text(choice.rival_sigma, choice.tau_s))));
}

}  // namespace libchar
