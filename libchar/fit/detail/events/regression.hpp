#pragma once
// Generalised least squares in the cosine domain, where noise is uncorrelated: weights are 1 / E c_k^2.

#include <Eigen/Core>
#include <span>
#include <vector>

#include "libchar/fit/detail/events/shapes.hpp"

namespace libchar {

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
double weighted_product(std::span<const double> weight,
                        std::span<const double> x,
                        std::span<const double> y);

/// The shapes fitted to coefficients[k-1] with the weights.
Regression regress(std::vector<EventShape> shapes,
                   const SeriesGrid& grid,
                   std::span<const double> coefficients,
                   std::span<const double> weight);

/// Score of one more column beside a regression: its size over its standard deviation when it joins.
struct Score {
  double numerator = 0, information = 0;
  double value() const { return information > 0 ? numerator / std::sqrt(information) : 0; }
};
Score score_of(const Regression& beside,
               std::span<const double> column,
               std::span<const double> weight);

}  // namespace libchar
