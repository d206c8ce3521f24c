#include "libchar/fit/detail/curve/solver_settings.hpp"

#include <limits>

namespace libchar {

ceres::Solver::Options exact_solver_options(int most_iterations) {
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_QR;
  options.num_threads = 1;  // more give other bits
  options.logging_type = ceres::SILENT;
  options.minimizer_progress_to_stdout = false;
  options.max_num_iterations = most_iterations;
  options.function_tolerance = options.gradient_tolerance = options.parameter_tolerance =
      std::numeric_limits<double>::epsilon();
  return options;
}

ceres::Covariance::Options exact_covariance_options() {
  ceres::Covariance::Options options;
  options.algorithm_type = ceres::DENSE_SVD;
  options.null_space_rank = -1;
  options.num_threads = 1;
  return options;
}

}  // namespace libchar
