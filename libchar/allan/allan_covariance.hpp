#pragma once
// Covariance between the points of an Allan curve, prepared once and evaluated for any mixture.

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <vector>

#include "libchar/allan/allan_deviation.hpp"
#include "libchar/core/noise_terms.hpp"

namespace libchar {

/// Samples between the terms of a point: m without overlap, m/4 for a curve of AllanPyramid, else 1.
std::uint64_t stride_of(const AllanCurve& curve, const AllanPoint& point);

/// The costly part (tens of milliseconds, whatever the record's length) depends on m, terms and
/// strides only; `at` is then a quadratic form in theta (microseconds), as reweighted fits need.
/// Throws Error(usage) unless the type is adev or oadev.
class AllanCovariance {
 public:
  explicit AllanCovariance(const AllanCurve& curve);
  /// Covariance of the Allan variances (not deviations) at the points of the curve.
  Eigen::MatrixXd at(const Mixture& theta) const;

  /// Ten products of two unit covariances and, for the ramp, the four covariances, summed over pairs.
  struct Products : std::array<double, 14> {
    Products() : std::array<double, 14>{} {}
    void operator+=(const Products& o) {
      for (std::size_t i = 0; i < size(); ++i) (*this)[i] += o[i];
    }
    Products operator*(double w) const {
      Products p;
      for (std::size_t i = 0; i < size(); ++i) p[i] = (*this)[i] * w;
      return p;
    }
  };

 private:
  std::size_t size_ = 0;
  double dt_s_;
  std::vector<double> tau_;
  std::vector<Products> products_;  ///< of the lower triangle, row by row
};

/// Exact covariance of overlapping Allan variances at the points of `curve` (their m, terms,
/// stride) for the mixture; cost independent of the record length (docs/theory/allan.md).
Eigen::MatrixXd allan_covariance(const AllanCurve& curve, const Mixture& theta);

/// Remembers what was prepared: the channels of one log have the same points and share it. May be
/// used from several threads.
class AllanCovarianceCache {
 public:
  std::shared_ptr<const AllanCovariance> of(const AllanCurve& curve);

 private:
  struct Entry {
    std::vector<std::uint64_t> key;  ///< type, stride divisor, then m, terms and inflation of each point
    double dt_s = 0;
    std::shared_ptr<const AllanCovariance> covariance;
  };
  std::mutex mutex_;
  std::vector<Entry> entries_;
};

}  // namespace libchar
