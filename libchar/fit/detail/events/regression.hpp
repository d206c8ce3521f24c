#pragma once
// Generalised least squares in the cosine domain, where noise is uncorrelated: weights are 1 / E c_k^2.

#include <Eigen/Core>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <span>
#include <vector>

#include "libchar/fit/signs/event.hpp"

namespace libchar {

/// sin and cos of k a for k = 1, 2, …: a turn from one to the next, set right every 256.
class Turning {
 public:
  explicit Turning(double angle) : angle_(angle), c1_(std::cos(angle)), s1_(std::sin(angle)) {}
  void next() {
    ++k_;
    if (k_ % 256 == 0) {
      const double at = std::fmod(angle_ * static_cast<double>(k_), 2 * std::numbers::pi);
      cosine = std::cos(at);
      sine = std::sin(at);
      return;
    }
    const double c = cosine * c1_ - sine * s1_;
    sine = sine * c1_ + cosine * s1_;
    cosine = c;
  }
  double cosine = 1, sine = 0;

 private:
  double angle_, c1_, s1_;
  std::uint64_t k_ = 0;
};

// The cosine transforms of steps, warm-ups and ramps, in closed form.

/// What a regressor is, in points of a series: of unit size (EventSeries: step 1, warm-up 1 at the first sample, ramp 1
/// from the first sample to the last).
struct EventShape {
  EventKind kind = EventKind::step;
  /// cycle: half periods in the series; step: the first point after it; 10.3 is a step within point 10, which has seven
  /// tenths of it
  double at = 0;
  double bridged = 0;  ///< step: it was while this many points were missing, bridged from `at` on by a line
  double tau = 0;      ///< warm-up: time constant; cycle: phase at the beginning of the first point
};

/// Where a series stands: n points of `per_point` samples.
struct SeriesGrid {
  std::size_t points = 0, per_point = 1;
};

/// Coefficients k = 1.. of the orthonormal DCT-II at [k-1], as many as `column` has room for.
void fill_column(const EventShape& shape, const SeriesGrid& grid, std::vector<double>& column);

struct Regression {
  std::vector<EventShape> shape;
  std::vector<std::vector<double>> column;  ///< of each shape
  Eigen::VectorXd size;                     ///< of each shape
  Eigen::MatrixXd covariance;               ///< of the sizes
  std::vector<double> rest;                 ///< coefficients less what the shapes explain
  double sd(std::size_t i) const {
    const auto j = static_cast<Eigen::Index>(i);
    return std::sqrt(covariance(j, j));
  }
};

/// sum_k w_k x_k y_k over the length of x.
double weighted_product(std::span<const double> weight, std::span<const double> x, std::span<const double> y);

/// The shapes fitted to coefficients[k-1] with the weights.
Regression regress(std::vector<EventShape> shapes, const SeriesGrid& grid, std::span<const double> coefficients,
                   std::span<const double> weight);

/// The share of each coefficient that columns explain whatever it is, the diagonal of X (X'WX)^-1 X'W: so much of a
/// degree of freedom is missing in the rest.
std::vector<double> leverage_of(const std::vector<std::vector<double>>& columns, const Eigen::MatrixXd& covariance,
                                std::span<const double> weight);

/// Score of one more column beside a regression: its size over its standard deviation when it joins.
struct Score {
  double numerator = 0, information = 0;
  double value() const { return information > 0 ? numerator / std::sqrt(information) : 0; }
};
Score score_of(const Regression& beside, std::span<const double> column, std::span<const double> weight);

}  // namespace libchar
