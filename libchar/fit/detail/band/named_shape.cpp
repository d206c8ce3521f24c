// The power gain of a digital filter of low order is a ratio of polynomials in s = sin²(pi f /
// rate), exactly. Beside a polynomial of ln |H|² over the whole band it has the few parameters that
// such a filter has, and leaves the slow end of the spectrum to the terms. Its unknowns p are found
// by Fisher scoring of terms and shape together: the shape is a straight line in p at each step,
//   ln |H(p + d)|² ~ ln |H(p)|² + d' (d ln |H|² / dp),
// with the step halved until the likelihood rises.
#include "libchar/fit/detail/band/named_shape.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "libchar/core/numeric/dense.hpp"
#include "libchar/core/text/readable.hpp"
#include "libchar/core/text/shown.hpp"
#include "libchar/fit/detail/band/bin_likelihood.hpp"

namespace libchar {
namespace {

double square_at(double frequency_hz, double rate_hz) {
  const double sine = std::sin(std::numbers::pi * std::min(frequency_hz / rate_hz, 0.5));
  return sine * sine;
}

/// s of a corner: beyond the rate's reach it goes on as f².
double square_of_corner(double corner_hz, double rate_hz) {
  const double x = std::numbers::pi * corner_hz / rate_hz;
  return x < 1 ? std::sin(x) * std::sin(x) : std::sin(1.0) * std::sin(1.0) * x * x;
}
double corner_of_square(double square, double rate_hz) {
  const double sine = std::sqrt(square);
  const double x = sine < std::sin(1.0) ? std::asin(sine) : sine / std::sin(1.0);
  return x * rate_hz / std::numbers::pi;
}

struct Unknowns {
  NamedShape::Family family = NamedShape::Family::none;
  std::array<double, 4> x{};  ///< ln s_p, ln zeta, ln s_z or ln s_r, tilt; artanh g of an echo
  int lag = 0;
};

Unknowns unknowns(const NamedShape& shape, double rate_hz) {
  if (shape.family == NamedShape::Family::echo) return {shape.family, {std::atanh(shape.echo)}, shape.lag};
  const double third_hz = std::max(shape.zero_hz, shape.real_pole_hz);
  return {shape.family,
          {std::log(square_of_corner(shape.pole_hz, rate_hz)), std::log(shape.damping),
           third_hz > 0 ? std::log(square_of_corner(third_hz, rate_hz)) : 0, shape.tilt},
          0};
}
NamedShape shape_of(const Unknowns& u, double rate_hz) {
  if (u.family == NamedShape::Family::echo) return echo_shape(std::tanh(u.x[0]), u.lag, rate_hz);
  NamedShape shape;
  shape.family = u.family;
  shape.pole_hz = corner_of_square(std::exp(u.x[0]), rate_hz);
  using Family = NamedShape::Family;
  const bool pair = u.family == Family::second_order || u.family == Family::third_order || u.family == Family::loop;
  shape.damping = pair ? std::exp(u.x[1]) : 1;
  const double third_hz = u.family == Family::second_order ? 0 : corner_of_square(std::exp(u.x[2]), rate_hz);
  (u.family == Family::third_order ? shape.real_pole_hz : shape.zero_hz) = third_hz;
  shape.tilt = u.x[3];
  return shape;
}

struct LogGain {
  double value = 0;
  std::array<double, 4> slope{};
};

/// Where in a bin the gain is taken: s and ln(1 - s), or the mean cosine of an echo.
struct Nodes {
  static constexpr std::size_t kCount = 3;
  std::array<double, kCount> s{}, nyquist{};
  double cosine = 0;
};

Nodes nodes_of(const PowerBin& bin, double rate_hz, int lag) {
  Nodes out;
  if (lag > 0) out.cosine = mean_cosine(bin, lag, rate_hz);
  for (std::size_t i = 0; i < Nodes::kCount; ++i) {
    const double share = (static_cast<double>(i) + 0.5) / Nodes::kCount;
    out.s[i] = square_at(bin.low_hz + (bin.high_hz - bin.low_hz) * share, rate_hz);
    out.nyquist[i] = std::log1p(-std::min(out.s[i], 1 - 1e-9));
  }
  return out;
}

/// A shape whose constants are computed.
class Gain {
 public:
  explicit Gain(const Unknowns& u)
      : family_(u.family),
        pole_(std::exp(u.x[0])),
        damped_(4 * std::exp(2 * u.x[1])),
        zero_(std::exp(u.x[2])),
        tilt_(u.x[3]),
        echo_(std::tanh(u.x[0])) {}

  /// Of the mean gain over the bin.
  LogGain operator()(const Nodes& nodes) const {
    LogGain out;
    if (family_ == NamedShape::Family::echo) return of_echo(nodes.cosine);
    double sum = 0;
    for (std::size_t i = 0; i < Nodes::kCount; ++i) {
      LogGain node;
      const double gain = at(nodes.s[i], nodes.nyquist[i], node);
      sum += gain;
      for (std::size_t k = 0; k < out.slope.size(); ++k) out.slope[k] += gain * node.slope[k];
    }
    out.value = std::log(sum / Nodes::kCount);
    for (double& slope : out.slope) slope /= sum;
    return out;
  }

 private:
  LogGain of_echo(double cosine) const {
    const double above = 1 + echo_ * (echo_ + 2 * cosine);
    const double slope = 2 * (echo_ + cosine) / above - 2 / (1 + echo_);
    return {std::log(above) - 2 * std::log1p(echo_), {slope * (1 - echo_ * echo_)}};
  }
  double at(double s, double nyquist, LogGain& out) const {
    const double x = s / pole_;
    double below = 1 + x;
    if (family_ == NamedShape::Family::high_pass) {
      out.slope[0] -= 1 / below;
      return x / below;
    }
    if (family_ == NamedShape::Family::shelf) {
      out.slope[0] += x / below;
    } else {
      below = (1 - x) * (1 - x) + damped_ * x;
      out.slope[0] += x * (damped_ - 2 * (1 - x)) / below;
      out.slope[1] -= 2 * damped_ * x / below;
    }
    double gain = 1 / below;
    if (family_ != NamedShape::Family::second_order) {
      const double z = s / zero_;
      const bool pole = family_ == NamedShape::Family::third_order;
      gain = pole ? gain / (1 + z) : gain * (1 + z);
      out.slope[2] += (pole ? 1 : -1) * z / (1 + z);
    }
    // Filters made by the bilinear transform have zeros at half the rate: |H|² ~ (1 - s)^c, c = 1, 2.
    out.slope[3] += nyquist;
    return tilt_ == 0 ? gain : gain * std::exp(tilt_ * nyquist);
  }

  NamedShape::Family family_;
  double pole_, damped_, zero_, tilt_, echo_;
};

LogGain log_gain_of(const Unknowns& u, const PowerBin& bin, double rate_hz) {
  return Gain(u)(nodes_of(bin, rate_hz, u.lag));
}

/// Which of the three unknowns a family has.
std::vector<std::size_t> free_of(NamedShape::Family family) {
  if (family == NamedShape::Family::shelf) return {0, 2, 3};
  if (family == NamedShape::Family::second_order) return {0, 1, 3};
  if (family == NamedShape::Family::high_pass || family == NamedShape::Family::echo) return {0};
  return {0, 1, 2, 3};
}

class Fit {
 public:
  Fit(const std::vector<PowerBin>& inside, double rate_hz, const TermSet& terms, int lag)
      : plain_(bin_problem(inside)), terms_(terms) {
    for (const PowerBin& bin : inside) nodes_.push_back(nodes_of(bin, rate_hz, lag));
  }

  /// Where the terms are likeliest beside a shape; `near`: those beside a shape close to it.
  ScoringResult at(const Unknowns& u, const Mixture* near = nullptr) const {
    const ModelPoint start{near != nullptr ? *near : Mixture{}, {}};
    return score(problem(u), terms_, near != nullptr ? &start : nullptr, kCoarse);
  }

  /// A straight line in the unknowns, to its maximum; false where the likelihood does not rise.
  bool step(Unknowns& u, ScoringResult& now) const {
    const std::vector<std::size_t> free = free_of(u.family);
    BinProblem line = problem(u);
    const Eigen::ArrayXd root = (line.dof / 2).sqrt();
    Eigen::MatrixXd slopes(line.size(), static_cast<Eigen::Index>(free.size()));
    const Gain gain_at(u);
    for (Eigen::Index j = 0; j < line.size(); ++j) {
      const LogGain at = gain_at(nodes_[static_cast<std::size_t>(j)]);
      for (std::size_t k = 0; k < free.size(); ++k)
        slopes(j, static_cast<Eigen::Index>(k)) = root[j] * at.slope[free[k]];
    }
    line.shape = thin_qr(slopes).q.array().colwise() / root;
    const ModelPoint start{now.at.theta, {}};
    const ScoringResult best = score(line, terms_, &start, kCoarse);
    Eigen::VectorXd gain = Eigen::VectorXd::Zero(line.size());
    for (Eigen::Index k = 0; k < line.shapes(); ++k)
      gain += best.at.shape[static_cast<std::size_t>(k)] * (line.shape.col(k) * root).matrix();
    const Eigen::VectorXd change = pivoted_least_squares(slopes, gain).x;
    if (!change.allFinite()) return false;
    double length = std::min(1.0, kLongest / std::max(change.cwiseAbs().maxCoeff(), 1e-300));
    for (int half = 0; half < kHalvings; ++half, length /= 2) {
      Unknowns next = u;
      for (std::size_t k = 0; k < free.size(); ++k) next.x[free[k]] += length * change[static_cast<Eigen::Index>(k)];
      const ScoringResult there = at(next, &best.at.theta);
      if (!(there.half_deviance < now.half_deviance)) continue;
      const bool goes_on = now.half_deviance - there.half_deviance > kEnough;
      u = next;
      now = there;
      return goes_on;
    }
    return false;
  }

 private:
  static constexpr double kCoarse = 1e-7, kEnough = 0.02, kLongest = 0.7;
  static constexpr int kHalvings = 4;

  BinProblem problem(const Unknowns& u) const {
    BinProblem out = plain_;
    const Gain gain(u);
    for (Eigen::Index j = 0; j < out.size(); ++j)
      out.unit.row(j) *= std::exp(gain(nodes_[static_cast<std::size_t>(j)]).value);
    return out;
  }

  BinProblem plain_;
  std::vector<Nodes> nodes_;
  const TermSet& terms_;
};

/// Corners a factor of two apart, two dampings, zeros on both sides of the pole.
std::vector<Unknowns> grid(NamedShape::Family family, const std::vector<PowerBin>& inside, double rate_hz) {
  constexpr double kWidest = 128, kApart = 4;
  std::vector<Unknowns> out;
  double top = 0;
  for (const PowerBin& bin : inside) top = std::max(top, square_at(bin.high_hz, rate_hz));
  const std::vector<double> dampings =
      family == NamedShape::Family::shelf ? std::vector<double>{1} : std::vector<double>{0.4, 1};
  const std::vector<double> zeros = family == NamedShape::Family::second_order ? std::vector<double>{1}
                                    : family == NamedShape::Family::shelf      ? std::vector<double>{0.6, 1.7}
                                                                               : std::vector<double>{0.2, 2};
  for (double square = top; square > top / (kWidest * kWidest); square /= kApart)
    for (const double damping : dampings)
      for (const double zero : zeros)
        out.push_back({family, {std::log(square), std::log(damping), std::log(square * zero), 0}, 0});
  return out;
}

/// A pair of poles less damped, and a real pole about it: Butterworth's three look like one pair, well damped.
std::vector<Unknowns> of_third_order(const Unknowns& second) {
  std::vector<Unknowns> out;
  for (const double real : {0.7, 2.0, 8.0})
    out.push_back({NamedShape::Family::third_order,
                   {second.x[0], second.x[1] + std::log(0.7), second.x[0] + std::log(real), 0},
                   0});
  return out;
}

}  // namespace

NamedShape echo_shape(double echo, int lag, double rate_hz) {
  NamedShape out;
  out.family = NamedShape::Family::echo;
  out.pole_hz = out.zero_hz = rate_hz / (2 * lag);
  out.echo = echo;
  out.lag = lag;
  return out;
}

double mean_cosine(const PowerBin& bin, int lag, double rate_hz) {
  const double angle = 2 * std::numbers::pi * lag / rate_hz;
  const double from = angle * bin.low_hz, to = angle * std::min(bin.high_hz, rate_hz / 2);
  return to - from > 1e-6 ? (std::sin(to) - std::sin(from)) / (to - from) : std::cos(from);
}

std::size_t unknowns_of(NamedShape::Family family) {
  return family == NamedShape::Family::none ? 0 : free_of(family).size();
}

double named_log_gain(const NamedShape& shape, const PowerBin& bin, double rate_hz) {
  if (shape.family == NamedShape::Family::none) return 0;
  return log_gain_of(unknowns(shape, rate_hz), bin, rate_hz).value;
}

std::array<double, 4> named_log_slopes(const NamedShape& shape, const PowerBin& bin, double rate_hz) {
  const LogGain at = log_gain_of(unknowns(shape, rate_hz), bin, rate_hz);
  std::array<double, 4> out{};
  const std::vector<std::size_t> free = free_of(shape.family);
  for (std::size_t k = 0; k < free.size(); ++k) out[k] = at.slope[free[k]];
  return out;
}

std::optional<NamedShape> fit_named_shape(const std::vector<PowerBin>& inside, double rate_hz, const TermSet& terms,
                                          NamedShape::Family family, const std::optional<NamedShape>& start,
                                          double hopeless) {
  const bool goes_on = start && start->family == family;
  // In the next, narrower band few steps are left; the start of a high-pass or an echo is one of a grid.
  const bool one = unknowns_of(family) == 1;
  const int steps = goes_on && !one ? 4 : 12;
  const Fit fit(inside, rate_hz, terms, start ? start->lag : 0);
  Unknowns best;
  ScoringResult now;
  now.half_deviance = std::numeric_limits<double>::infinity();
  const std::vector<Unknowns> starts = goes_on ? std::vector<Unknowns>{unknowns(*start, rate_hz)}
                                       : start ? of_third_order(unknowns(*start, rate_hz))
                                               : grid(family, inside, rate_hz);
  for (const Unknowns& at : starts) {
    ScoringResult there = fit.at(at);
    if (!(there.half_deviance < now.half_deviance)) continue;
    now = std::move(there);
    best = at;
  }
  if (!(now.half_deviance < hopeless)) return std::nullopt;
  for (int i = 0; i < steps && fit.step(best, now); ++i) {
  }
  const NamedShape shape = shape_of(best, rate_hz);
  if (!std::isfinite(shape.pole_hz) || !std::isfinite(shape.damping) || !std::isfinite(shape.zero_hz) ||
      !std::isfinite(shape.real_pole_hz))
    return std::nullopt;
  return shape;
}

std::vector<NamedShape> high_pass_starts(double rate_hz, double duration_s) {
  constexpr double kFewest = 4,
                   kHighest = 40;  ///< periods of the corner in the record; corners below the rate
  std::vector<NamedShape> out;
  for (double corner = kFewest / duration_s; corner < rate_hz / kHighest; corner *= 2)
    out.push_back({NamedShape::Family::high_pass, corner, 0, 1, 0});
  return out;
}

std::string named_shape_text(const NamedShape& shape) {
  if (shape.family == NamedShape::Family::high_pass)
    return fmt::format("a high-pass at {}", detail::frequency_text(shape.pole_hz, 3));
  if (shape.family == NamedShape::Family::shelf)
    return fmt::format("a shelf, {} times between {} and {}", brief_text(shape.pole_hz / shape.zero_hz, 3),
                       detail::frequency_text(std::min(shape.pole_hz, shape.zero_hz), 3),
                       detail::frequency_text(std::max(shape.pole_hz, shape.zero_hz), 3));
  if (shape.family == NamedShape::Family::echo)
    return fmt::format("an echo: {} of each sample again {} samples later", brief_text(shape.echo, 2), shape.lag);
  const bool third = shape.family == NamedShape::Family::third_order;
  std::string text = fmt::format("a {}-order low-pass at {}, damping {}", third ? "third" : "second",
                                 detail::frequency_text(shape.pole_hz, 3), brief_text(shape.damping, 2));
  if (third) text += fmt::format(", and at {}", detail::frequency_text(shape.real_pole_hz, 3));
  if (shape.family == NamedShape::Family::loop)
    text += fmt::format(", with a zero at {}", detail::frequency_text(shape.zero_hz, 3));
  return text;
}

}  // namespace libchar
