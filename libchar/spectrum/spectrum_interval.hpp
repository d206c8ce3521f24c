#pragma once
// How well a bin of a spectrum is known.

#include <cstddef>
#include <optional>
#include <unordered_map>
#include <utility>
#include <vector>

#include "libchar/core/numeric/interval.hpp"
#include "libchar/spectrum/spectrum.hpp"

namespace libchar {

/// Chi-square interval of an average of powers with `dof` degrees of freedom, as multiples of the
/// average.
std::pair<double, double> interval_factors(double dof, double confidence);

/// The same for one confidence, each number of degrees of freedom computed once: bins and channels
/// share most of them, and a quantile costs more than anything else that is written of a bin.
class IntervalFactors {
 public:
  explicit IntervalFactors(double confidence) : confidence_(confidence) {}
  std::pair<double, double> of(double dof);
  /// Interval of bin i of a density (for lsd, ls: of the root).
  std::pair<double, double> interval(const Spectrum& spectrum, std::size_t i);

 private:
  double confidence_;
  std::unordered_map<double, std::pair<double, double>> known_;
};

/// That of every bin; none where its degrees of freedom are not known.
std::vector<std::optional<Interval>> spectrum_intervals(const Spectrum& spectrum,
                                                        IntervalFactors& factors);
std::vector<std::optional<Interval>> spectrum_intervals(const Spectrum& spectrum,
                                                        double confidence);

}  // namespace libchar
