#pragma once
// The steps of fusion algorithms in C99 (steps/), operation by operation as in the library, so that doubles have the
// same bits: embedded at build time. Words in capitals are replaced by numbers.

#include <string_view>

namespace libchar {

std::string_view mean_in_c();            ///< averages.cpp: Mean
std::string_view weighted_in_c();        ///< weighted_mean.hpp
std::string_view least_squares_in_c();   ///< least_squares.cpp: LearntMean
std::string_view perceptron_in_c();      ///< perceptron.cpp, network_training.hpp
std::string_view virtual_sensor_in_c();  ///< bias_filter.cpp in its steady state
std::string_view tilt_in_c();            ///< tilt_complementary.cpp
std::string_view minque_in_c();          ///< minque.cpp, reweighted_variances.cpp, fault_watch.hpp

}  // namespace libchar
