#pragma once
// Arrays of sensors that break what is careless with numbers.

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "libchar/fusion/array.hpp"

namespace libchar {

struct StressArray {
  std::string name;
  fusion::Array array;
  Eigen::MatrixXd learning, learning_truth;  ///< n and r rows, a column an instant
  Eigen::MatrixXd y, truth;
  /// A relation to the plain array, which the estimates must have too: moved by `shift`, in units
  /// 2^power smaller, channels from last to first.
  double shift = 0;
  int power = 0;
  bool reversed = false;
  bool related() const { return shift != 0 || power != 0 || reversed; }
  /// of the errors' least-squares problem: weights are held against long double
  bool exact_weights = false;
};

/// The plain one first.
std::vector<StressArray> stress_arrays(std::uint64_t seed);

}  // namespace libchar
