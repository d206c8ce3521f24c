#include "libchar/fusion/detail/network_training.hpp"

#include <ceres/ceres.h>

#include <cmath>
#include <limits>

#include "libchar/core/dense.hpp"
#include "libchar/core/silent_glog.hpp"
#include "libchar/fusion/detail/uniform.hpp"

namespace libchar::fusion {
namespace {

class Residuals final : public ceres::CostFunction {
 public:
  Residuals(const TanhNetwork& network, const TrainingRows& rows) : network_(network), rows_(rows) {
    set_num_residuals(static_cast<int>(rows.count));
    mutable_parameter_block_sizes()->push_back(static_cast<int>(network.size()));
  }
  bool Evaluate(const double* const* parameters,
                double* residuals,
                double** jacobians) const override {
    const double* const p = parameters[0];
    double* row = jacobians ? jacobians[0] : nullptr;
    for (std::size_t k = 0; k < rows_.count; ++k) {
      const double* const z = rows_.rows + k * (network_.inputs + 1);
      residuals[k] =
          (row ? network_.output(p, z, row) : network_.output(p, z)) - z[network_.inputs];
      if (!std::isfinite(residuals[k])) return false;
      if (row) row += network_.size();
    }
    return true;
  }

 private:
  const TanhNetwork& network_;
  const TrainingRows& rows_;
};

double mean_square(const TanhNetwork& network, const TrainingRows& rows, const double* p) {
  double sum = 0;
  for (std::size_t k = 0; k < rows.count; ++k) {
    const double* const z = rows.rows + k * (network.inputs + 1);
    const double off = network.output(p, z) - z[network.inputs];
    sum += off * off;
  }
  return sum / static_cast<double>(rows.count);
}

/// Watches the held-out rows: keeps the best parameters, ends the training when they stay worse.
class EarlyStop final : public ceres::IterationCallback {
 public:
  EarlyStop(const TanhNetwork& network,
            const TrainingRows& held_out,
            const std::vector<double>& parameters,
            int patience)
      : network_(network), held_out_(held_out), parameters_(parameters), patience_(patience) {}
  ceres::CallbackReturnType operator()(const ceres::IterationSummary& summary) override {
    iterations = summary.iteration;
    const double square = mean_square(network_, held_out_, parameters_.data());
    if (square < best_square) {
      best_square = square;
      best = parameters_;
      waited_ = 0;
    } else if (summary.step_is_successful && ++waited_ >= patience_) {
      return ceres::SOLVER_TERMINATE_SUCCESSFULLY;
    }
    return ceres::SOLVER_CONTINUE;
  }
  std::vector<double> best;
  double best_square = std::numeric_limits<double>::infinity();
  int iterations = 0;

 private:
  const TanhNetwork& network_;
  const TrainingRows& held_out_;
  const std::vector<double>& parameters_;
  int patience_, waited_ = 0;
};

/// Hidden weights at random, so that sums have a deviation of about one half (tanh bends but does
/// not saturate); the layer above by linear least squares for them, on at most a thousand rows.
std::vector<double> start_of(const TanhNetwork& network, const TrainingRows& rows, Uniform& draw) {
  std::vector<double> p(network.size(), 0);
  const double reach = 0.5 * std::sqrt(3 / static_cast<double>(network.inputs));
  for (std::size_t i = 0; i < network.b(); ++i) p[i] = reach * draw();
  for (std::size_t i = network.b(); i < network.v(); ++i) p[i] = draw();
  const std::size_t stride = 1 + rows.count / 1000, used = (rows.count - 1) / stride + 1;
  const auto columns = static_cast<Eigen::Index>(network.hidden) + 1;
  Eigen::MatrixXd hidden(static_cast<Eigen::Index>(used), columns);
  Eigen::VectorXd target(hidden.rows());
  for (Eigen::Index k = 0; k < hidden.rows(); ++k) {
    const double* const z = rows.rows + static_cast<std::size_t>(k) * stride * (network.inputs + 1);
    for (Eigen::Index j = 0; j + 1 < columns; ++j)
      hidden(k, j) = network.activation(p.data(), static_cast<std::size_t>(j), z);
    hidden(k, columns - 1) = 1;
    target[k] = z[network.inputs];
  }
  const Eigen::VectorXd above = pivoted_least_squares(hidden, target).x;
  std::copy(above.begin(), above.end(), p.begin() + static_cast<std::ptrdiff_t>(network.v()));
  return p;
}

ceres::Solver::Options options_of(const TrainingPlan& plan, EarlyStop& watch) {
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_QR;
  // Eigen's own: LAPACK's threads would change the bits.
  options.dense_linear_algebra_library_type = ceres::EIGEN;
  options.num_threads = 1;
  options.logging_type = ceres::SILENT;
  options.max_num_iterations = static_cast<int>(plan.iterations);
  options.function_tolerance = plan.relative_decrease;
  options.gradient_tolerance = 0;
  options.parameter_tolerance = 1e-12;
  options.update_state_every_iteration = true;
  options.callbacks.push_back(&watch);
  return options;
}

}  // namespace

Training train(const TanhNetwork& network,
               const TrainingRows& rows,
               const TrainingRows& held_out,
               const TrainingPlan& plan) {
  const SilentGlog silent;
  Training training;
  training.held_out_square = std::numeric_limits<double>::infinity();
  Uniform draw(plan.seed);
  for (std::size_t start = 0; start < plan.starts; ++start) {
    std::vector<double> p = start_of(network, rows, draw);
    ceres::Problem problem;
    problem.AddResidualBlock(new Residuals(network, rows), nullptr, p.data());
    EarlyStop watch(network, held_out, p, plan.patience);
    ceres::Solver::Summary summary;
    ceres::Solve(options_of(plan, watch), &problem, &summary);
    training.iterations += watch.iterations;
    if (!(watch.best_square < training.held_out_square)) continue;
    training.held_out_square = watch.best_square;
    training.parameters = watch.best;
  }
  return training;
}

}  // namespace libchar::fusion
