#pragma once
// The fusion algorithms, one line each in the order of reports (baselines, blind methods, methods that learn from a reference, bounds):
// the line declares `Entry NAME_algorithm()` of algorithms/NAME.cpp and puts it into the table of registry.cpp.

#include "libchar/fusion/registry.hpp"

// clang-format off
#define LIBCHAR_ALGORITHMS(ALGORITHM) \
  ALGORITHM(mean) \
  ALGORITHM(median) \
  ALGORITHM(inverse_variance) \
  ALGORITHM(covariance_intersection) \
  ALGORITHM(minque) \
  ALGORITHM(minque_published) \
  ALGORITHM(random_weighting) \
  ALGORITHM(random_weighting_published) \
  ALGORITHM(kalman_takens) \
  ALGORITHM(kalman_takens_published) \
  ALGORITHM(blind_calibration) \
  ALGORITHM(blind_calibration_published) \
  ALGORITHM(blind_gls) \
  ALGORITHM(virtual_sensor) \
  ALGORITHM(least_squares) \
  ALGORITHM(least_squares_published) \
  ALGORITHM(shrunk_least_squares) \
  ALGORITHM(non_negative_least_squares) \
  ALGORITHM(perceptron) \
  ALGORITHM(kalman_takens_taught) \
  ALGORITHM(tilt_gyroscope) \
  ALGORITHM(tilt_accelerometer) \
  ALGORITHM(tilt_complementary) \
  ALGORITHM(tilt_kalman) \
  ALGORITHM(tilt_complementary_tuned) \
  ALGORITHM(tilt_kalman_tuned) \
  ALGORITHM(best_sensor) \
  ALGORITHM(optimal_weights) \
  ALGORITHM(sectioned_least_squares)
// clang-format on

// A build may bring algorithms of its own, which stand first: -D'LIBCHAR_MORE_ALGORITHMS(ALGORITHM)=ALGORITHM(mine)'.
#ifndef LIBCHAR_MORE_ALGORITHMS
#define LIBCHAR_MORE_ALGORITHMS(ALGORITHM)
#endif

namespace libchar::fusion {

#define LIBCHAR_DECLARE_ALGORITHM(NAME) Entry NAME##_algorithm();
LIBCHAR_MORE_ALGORITHMS(LIBCHAR_DECLARE_ALGORITHM)
LIBCHAR_ALGORITHMS(LIBCHAR_DECLARE_ALGORITHM)
#undef LIBCHAR_DECLARE_ALGORITHM

}  // namespace libchar::fusion
