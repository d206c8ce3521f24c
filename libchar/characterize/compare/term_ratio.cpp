// Ratio of two independent coefficients, each with a 95 % interval [l, u] about its value c: in logarithms the
// interval of the difference from the distances to the ends that face each other (MOVER: Zou & Donner, Stat.
// Med. 27 (2008) 1693),
//   ln r -+ ...,   r = b / a:  lower  ln r - sqrt((ln b - ln l_b)² + (ln u_a - ln a)²),
//                              upper  ln r + sqrt((ln u_b - ln b)² + (ln a - ln l_a)²),
// and p from the distance to the end that faces r = 1, as if it were 1.96 standard deviations. An interval that reaches
// zero makes that distance infinite, and p 1: nothing is claimed. A value against an upper limit differs when the whole
// interval is above the limit. The mean of n squares V_i with intervals l_i..u_i has by the same method the interval
//   V - sqrt(sum (V_i - l_i)²) / n  ..  V + sqrt(sum (u_i - V_i)²) / n.
#include <algorithm>
#include <cmath>

#include "libchar/characterize/compare/characterization_comparison.hpp"

namespace libchar::detail {
namespace {

/// Distance in ln from the value to an end of its interval.
double below(const Coefficient& c) { return std::log(*c.value) - std::log(c.ci95.low); }
double above(const Coefficient& c) { return std::log(c.ci95.high) - std::log(*c.value); }

/// What it may be at most as an estimate: its value, or its limit.
std::optional<double> size_of(const Coefficient& c) { return c.value ? c.value : c.upper95; }

double square(double x) { return x * x; }

}  // namespace

bool relied_on(const Coefficient& c) {
  return c.status == Status::detected || c.status == Status::given || c.status == Status::not_detected;
}

Coefficient scaled(Coefficient c, double factor) {
  if (c.value) *c.value *= factor;
  if (c.upper95) *c.upper95 *= factor;
  c.ci95.low *= factor;
  c.ci95.high *= factor;
  return c;
}

TermRatio ratio_of(const Coefficient& b, const Coefficient& a) {
  TermRatio out;
  if (!a.value || !b.value || !(*a.value > 0) || !(*b.value > 0)) return out;
  const double log_ratio = std::log(*b.value / *a.value);
  const double down = std::hypot(below(b), above(a)), up = std::hypot(above(b), below(a));
  out.ratio = std::exp(log_ratio);
  out.ci95 = {std::exp(log_ratio - down), std::exp(log_ratio + up)};
  const double facing = log_ratio > 0 ? down : up;
  // Two that are stated without an interval differ when their numbers do.
  const double z = log_ratio == 0 ? 0 : kNormal95 * std::abs(log_ratio) / facing;
  out.p = std::erfc(z / std::sqrt(2.0));
  return out;
}

TermDifference difference_of(const Coefficient& b, const Coefficient& a, double share) {
  if (a.status == Status::not_fitted || b.status == Status::not_fitted) return TermDifference::only_one;
  if (!relied_on(a) || !relied_on(b)) return TermDifference::not_judged;
  if (const TermRatio r = ratio_of(b, a); r.p) {
    if (!(*r.p < share)) return TermDifference::not_resolved;
    return *r.ratio > 1 ? TermDifference::larger : TermDifference::smaller;
  }
  if (a.value && b.upper95) return a.ci95.low > *b.upper95 ? TermDifference::smaller : TermDifference::not_resolved;
  if (b.value && a.upper95) return b.ci95.low > *a.upper95 ? TermDifference::larger : TermDifference::not_resolved;
  return TermDifference::not_judged;
}

Coefficient root_mean_square(const std::vector<Coefficient>& all) {
  Coefficient out = all[0];
  const double n = static_cast<double>(all.size());
  double mean = 0, down = 0, up = 0;
  bool any = false;
  for (const Coefficient& c : all) {
    if (c.status == Status::not_fitted) return Coefficient{};
    if (!relied_on(c) || !relied_on(out)) out.status = relied_on(out) ? c.status : out.status;
    const double value = c.value.value_or(0);
    any = any || c.value;
    mean += square(value) / n;
    down += square((square(value) - square(c.value ? c.ci95.low : 0)) / n);
    up += square((square(c.value ? c.ci95.high : c.upper95.value_or(0)) - square(value)) / n);
  }
  const double high = std::sqrt(mean + std::sqrt(up));
  out.value = any ? std::optional(std::sqrt(mean)) : std::nullopt;
  out.upper95 = any ? std::nullopt : std::optional(high);
  out.ci95 = {std::sqrt(std::max(0.0, mean - std::sqrt(down))), high};
  if (any && out.status == Status::not_detected) out.status = Status::detected;
  out.relative_sd = any ? std::log(high / *out.value) / kNormal95 : 0;
  return out;
}

Lowest lowest_of(const std::vector<Coefficient>& all, const std::vector<bool>& takes_part, double share) {
  Lowest out;
  const auto counts = [&](std::size_t i) { return takes_part[i] && relied_on(all[i]) && size_of(all[i]); };
  for (std::size_t i = 0; i < all.size(); ++i)
    if (counts(i) && (!out.best || *size_of(all[i]) < *size_of(all[*out.best]))) out.best = i;
  for (std::size_t i = 0; i < all.size(); ++i)
    if (counts(i) && i != *out.best && difference_of(all[i], all[*out.best], share) != TermDifference::larger)
      out.not_apart.push_back(i);
  return out;
}

}  // namespace libchar::detail
