// Windows A and B of m samples, a and b of them present, each more than m/2; d = the difference of
// their means over what is present; n terms:
//
//   E sum d^2 / (2 n) = sigma^2(m) + c S^2(m),     c = sum (1/a + 1/b - 2/m) / (2 n),
//
// c S^2 being what the missing samples add. For samples missing at random S^2 is the variance
// within a window of m, whatever the noise (simple random sampling, Cochran 1977, theorem 2.2),
// which is a sum over the octaves below m (Haar): S^2 = m/(m-1) sum sigma^2(2^j)/2. For gaps of any
// length each octave counts with the Allan variance A of the indicator "present" there,
//
//   S^2(m) = sum 2^j A(2^j) sigma^2(2^j) / sum A(2^j),     2^j < m:
//
// white noise has 2^j sigma^2(2^j) = its variance at every octave, so it is exact for white noise
// and any gaps; samples missing independently have A ~ 2^-j, which is the sum above. Between
// octaves S^2 is interpolated as a power of m. Third differences: weights 1, -2, 1 of the windows,
// so c = sum (1/a + 4/b + 1/c - 6/m) / (6 n). Modified: d is the mean of the Allan terms at m
// starts in a row, all of which there must be, and c that of theirs times (m^2+1)/(2 m^2), as white
// noise has it.
//
// v = sum d^2 / (2 n) - c S^2 has the scatter of the whole for what is left, and few degrees of
// freedom may leave less than nothing. In white noise sum d^2 / (2 n) / (1 + c m) is as good and
// does neither. So both are weighted: w for the latter, 1 - w for the former, w = 1 / (1 +
// (z/2)^4), z the distance in standard deviations from what white noise of this S^2 would give
// (Wilson & Hilferty 1931). Noise bluer than white (z < -4) of which c S^2 leaves less than two
// standard deviations is hidden, and so it is at longer times.

#include "libchar/allan/detail/kernels/missing_samples.hpp"

#include <algorithm>
#include <cmath>

namespace libchar {

void PresentTerms::operator+=(const PresentTerms& other) {
  squares += other.squares;
  shortfall += other.shortfall;
  imbalance += other.imbalance;
  terms += other.terms;
  starts += other.starts;
}

long double MissingSamples::spread(double m) const {
  if (spread_.empty()) return 0;
  const double at = std::clamp(std::log2(m) - 1, 0.0, static_cast<double>(spread_.size() - 1));
  const auto low = static_cast<std::size_t>(at);
  const double rest = at - static_cast<double>(low);
  if (rest == 0 || !(spread_[low] > 0)) return spread_[low];
  return spread_[low] * std::pow(static_cast<double>(spread_[low + 1] / spread_[low]), rest);
}

namespace {

/// A mean square over its expectation, of so many degrees of freedom, in standard deviations.
double deviate(double ratio, double dof) {
  const double variance = 2 / (9 * dof);
  return (std::cbrt(ratio) - (1 - variance)) / std::sqrt(variance);
}

}  // namespace

MissingSamples::Corrected MissingSamples::corrected(
    double m, const PresentTerms& terms, double divisor, double unit, double dof) const {
  if (terms.terms == 0) return {};
  const long double count =
      static_cast<long double>(divisor) * static_cast<long double>(terms.terms);
  const long double before = terms.squares / count, c = terms.shortfall / count;
  const long double spread_here = spread(m), white = 1 + c / static_cast<long double>(unit);
  const long double less = before - c * spread_here;
  if (c == 0 || before == 0 || !(spread_here > 0)) return {before / white, 1, 0};
  const long double expected = spread_here * white * static_cast<long double>(unit);
  const double z = deviate(static_cast<double>(before / expected), dof);
  constexpr double kBluer = -4, kToldApart = 2;
  const bool bluer = z < kBluer || m > hidden_from_;
  if (bluer && less < kToldApart * std::sqrt(2 / dof) * before) return {};
  const long double w = 1 / (1 + std::pow(z / 2, 4)), rest = less > 0 ? 1 - w : 0;
  const long double variance = w * before / white + rest * less;
  return {variance,
          static_cast<double>((w / white + rest) * before / variance),
          static_cast<double>(c * spread_here)};
}

void MissingSamples::add_octave(double m, const PresentTerms& terms, long double variance) {
  if (variance < 0 && terms.terms > 0) hidden_from_ = std::min(hidden_from_, m);
  if (variance > 0 && terms.starts > 0) {
    const long double mask = terms.imbalance / static_cast<long double>(terms.starts);
    weighted_ += static_cast<long double>(m) * mask * variance;
    weight_ += mask;
  }
  const long double last = spread_.empty() ? 0 : spread_.back();
  spread_.push_back(weight_ > 0 ? weighted_ / weight_ : last);
}

}  // namespace libchar
