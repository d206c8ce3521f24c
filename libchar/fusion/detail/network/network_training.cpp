#include "libchar/fusion/detail/network/network_training.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "libchar/core/numeric/dense.hpp"
#include "libchar/core/numeric/lanes.hpp"
#include "libchar/core/parallel/parallel.hpp"
#include "libchar/core/process/work.hpp"
#include "libchar/fusion/detail/uniform.hpp"

namespace libchar::fusion {

namespace {

constexpr std::size_t kPanel = 512;             // rows at once: half a megabyte with 140 parameters
constexpr std::size_t kAtOnce = 64;             // rows that are not worth sharing out
constexpr std::size_t kRows = 4, kColumns = 8;  // of the matrix that are summed in registers

/// Four rows of the sums, from row i on, and their columns on and right of the diagonal.
LIBCHAR_LANES void add_rows_lanes(const double* panel, std::size_t rows, std::size_t width, std::size_t i,
                                  double* sums) {
  for (std::size_t j = i / kColumns * kColumns; j < width; j += kColumns) {
    double* const to = sums + i * width + j;
    Four a0 = LIBCHAR_FOUR(to), a1 = LIBCHAR_FOUR(to + 4);
    Four b0 = LIBCHAR_FOUR(to + width), b1 = LIBCHAR_FOUR(to + width + 4);
    Four c0 = LIBCHAR_FOUR(to + 2 * width), c1 = LIBCHAR_FOUR(to + 2 * width + 4);
    Four d0 = LIBCHAR_FOUR(to + 3 * width), d1 = LIBCHAR_FOUR(to + 3 * width + 4);
    for (const double* row = panel; row != panel + rows * width; row += width) {
      const Four right0 = LIBCHAR_FOUR(row + j), right1 = LIBCHAR_FOUR(row + j + 4);
      a0 += row[i] * right0;
      a1 += row[i] * right1;
      b0 += row[i + 1] * right0;
      b1 += row[i + 1] * right1;
      c0 += row[i + 2] * right0;
      c1 += row[i + 2] * right1;
      d0 += row[i + 3] * right0;
      d1 += row[i + 3] * right1;
    }
    LIBCHAR_FOUR_TO(to) = a0;
    LIBCHAR_FOUR_TO(to + 4) = a1;
    LIBCHAR_FOUR_TO(to + width) = b0;
    LIBCHAR_FOUR_TO(to + width + 4) = b1;
    LIBCHAR_FOUR_TO(to + 2 * width) = c0;
    LIBCHAR_FOUR_TO(to + 2 * width + 4) = c1;
    LIBCHAR_FOUR_TO(to + 3 * width) = d0;
    LIBCHAR_FOUR_TO(to + 3 * width + 4) = d1;
  }
}
constexpr InLanes<add_rows_lanes> add_rows;

void on_all_cores(std::size_t count, std::size_t grain, const auto& work) {
  parallel::over_ranges(0, count, grain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k != end; ++k) work(k);
  });
}

}  // namespace

NetworkNormals::NetworkNormals(const TanhNetwork& network)
    : network_(network),
      width_((network.size() + 1 + kColumns - 1) / kColumns * kColumns),
      panel_(kPanel * width_),
      sums_(width_ * width_) {}

double NetworkNormals::squares(const TrainingRows& rows, const double* parameters) {
  errors_.resize(rows.count);
  on_all_cores(rows.count, kAtOnce, [&](std::size_t k) {
    const double* const z = rows.rows + k * (network_.inputs + 1);
    errors_[k] = network_.output(parameters, z) - z[network_.inputs];
  });
  double sum = 0;
  for (const double e : errors_) sum += e * e;
  return std::isfinite(sum) ? sum : std::numeric_limits<double>::infinity();
}

void NetworkNormals::fill(const TrainingRows& rows, std::size_t first, const double* parameters) {
  on_all_cores(std::min(kPanel, rows.count - first), kAtOnce, [&](std::size_t k) {
    const double* const z = rows.rows + (first + k) * (network_.inputs + 1);
    double* const row = panel_.data() + k * width_;
    row[network_.size()] = network_.output(parameters, z, row) - z[network_.inputs];
  });
}

bool NetworkNormals::linearise(const TrainingRows& rows, const double* parameters) {
  std::fill(sums_.begin(), sums_.end(), 0.0);
  for (std::size_t first = 0; first < rows.count; first += kPanel) {
    fill(rows, first, parameters);
    const std::size_t count = std::min(kPanel, rows.count - first);
    on_all_cores(width_ / kRows, 1,
                 [&](std::size_t i) { add_rows(panel_.data(), count, width_, i * kRows, sums_.data()); });
  }
  // A square that is no number stands on the diagonal: it marks whatever was none.
  for (std::size_t i = 0; i <= network_.size(); ++i)
    if (!std::isfinite(sums_[i * width_ + i])) return false;
  return true;
}

double NetworkNormals::curvature(Eigen::Index i, Eigen::Index j) const {
  return sums_[static_cast<std::size_t>(std::min(i, j)) * width_ + static_cast<std::size_t>(std::max(i, j))];
}

Eigen::VectorXd NetworkNormals::slope() const {
  Eigen::VectorXd out(static_cast<Eigen::Index>(network_.size()));
  for (Eigen::Index i = 0; i < out.size(); ++i) out[i] = curvature(i, static_cast<Eigen::Index>(network_.size()));
  return out;
}

namespace {

/// Watches the held-out rows: keeps the best parameters, says when they stay worse.
class EarlyStop {
 public:
  EarlyStop(NetworkNormals& normals, const TrainingRows& held_out, int patience)
      : normals_(normals), held_out_(held_out), patience_(patience) {}
  /// True: no gain for too long.
  bool worse(const std::vector<double>& parameters, bool moved) {
    const double square = normals_.squares(held_out_, parameters.data()) / static_cast<double>(held_out_.count);
    if (square < best_square) {
      best_square = square;
      best = parameters;
      waited_ = 0;
      return false;
    }
    return moved && ++waited_ >= patience_;
  }
  std::vector<double> best;
  double best_square = std::numeric_limits<double>::infinity();

 private:
  NetworkNormals& normals_;
  const TrainingRows& held_out_;
  int patience_, waited_ = 0;
};

/// The scaled system of one linearisation.
struct ScaledSystem {
  Eigen::MatrixXd a;  // S J'J S
  Eigen::VectorXd g;  // S J'e
};

ScaledSystem scaled(const NetworkNormals& normals, const Eigen::VectorXd& scale) {
  ScaledSystem out{Eigen::MatrixXd(scale.size(), scale.size()), scale.cwiseProduct(normals.slope())};
  for (Eigen::Index j = 0; j < scale.size(); ++j)
    for (Eigen::Index i = 0; i < scale.size(); ++i) out.a(i, j) = scale[i] * scale[j] * normals.curvature(i, j);
  return out;
}

struct TrustRegion {
  double radius = 1e4, shrink = 2;
  static constexpr double kLargest = 1e16, kSmallest = 1e-32;
  void accept(double share) {  // of the promised decrease
    radius = std::min(kLargest, radius / std::max(1. / 3, 1 - std::pow(2 * share - 1, 3)));
    shrink = 2;
  }
  void reject() {
    radius /= shrink;
    shrink *= 2;
  }
};

/// y, and the decrease of half the sum of squares that it promises; none where the system has no
/// solution or promises nothing.
struct ScaledStep {
  Eigen::VectorXd y;
  double promised;
};
std::optional<ScaledStep> damped_step(const ScaledSystem& system, double radius) {
  Eigen::MatrixXd damped = system.a;
  damped.diagonal() += (system.a.diagonal().cwiseMax(1e-6).cwiseMin(1e32) / radius).eval();
  const auto factor = cholesky_factor(damped);
  if (!factor) return {};
  const Eigen::VectorXd y = -solve_factored(*factor, system.g);
  const double promised = -(y.dot(system.g) + 0.5 * y.dot(system.a * y));
  if (!y.allFinite() || !(promised > 0)) return {};
  return ScaledStep{y, promised};
}

constexpr double kLeastShare = 1e-3;    // of the promise, for a step to be taken
constexpr double kLeastChange = 1e-12;  // of the parameters
constexpr int kMostInvalid = 5;         // systems in a row without a step

/// Descends from p until it is over; returns the iterations.
int descend(NetworkNormals& normals, const TrainingRows& rows, const TrainingPlan& plan, std::vector<double> p,
            EarlyStop& watch) {
  if (!normals.linearise(rows, p.data())) return 0;
  const auto size = static_cast<Eigen::Index>(p.size());
  Eigen::VectorXd scale(size);
  for (Eigen::Index i = 0; i < size; ++i) scale[i] = 1 / (1 + std::sqrt(normals.curvature(i, i)));
  ScaledSystem system = scaled(normals, scale);
  TrustRegion region;
  double cost = 0.5 * normals.squares(rows, p.data());
  watch.worse(p, false);
  int invalid = 0;
  bool taken = false;
  for (int iteration = 1; iteration <= static_cast<int>(plan.iterations); ++iteration) {
    count_work(WorkKind::training_steps, 1);
    const auto step = damped_step(system, region.radius);
    if (!step) {
      if (++invalid > kMostInvalid || region.radius < TrustRegion::kSmallest) return iteration - 1;
      region.radius /= 2;
      continue;
    }
    invalid = 0;
    std::vector<double> next = p;
    Eigen::Map<Eigen::VectorXd> x(next.data(), size);
    const Eigen::VectorXd moved = scale.cwiseProduct(step->y);
    const double length = x.norm();
    x += moved;
    if (taken && moved.norm() <= kLeastChange * (length + kLeastChange)) return iteration - 1;
    const double next_cost = 0.5 * normals.squares(rows, next.data());
    if (std::abs(cost - next_cost) <= plan.relative_decrease * cost) return iteration - 1;
    const double share = (cost - next_cost) / step->promised;
    const bool good = share > kLeastShare && normals.linearise(rows, next.data());
    if (good) {
      p = next;
      cost = next_cost;
      system = scaled(normals, scale);
      region.accept(share);
      taken = true;
    } else {
      region.reject();
    }
    if (watch.worse(p, good) || region.radius < TrustRegion::kSmallest) return iteration;
  }
  return static_cast<int>(plan.iterations);
}

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

}  // namespace

Training train(const TanhNetwork& network, const TrainingRows& rows, const TrainingRows& held_out,
               const TrainingPlan& plan) {
  Training training;
  training.held_out_square = std::numeric_limits<double>::infinity();
  Uniform draw(plan.seed);
  NetworkNormals normals(network);
  for (std::size_t start = 0; start < plan.starts; ++start) {
    EarlyStop watch(normals, held_out, plan.patience);
    training.iterations += descend(normals, rows, plan, start_of(network, rows, draw), watch);
    if (!(watch.best_square < training.held_out_square)) continue;
    training.held_out_square = watch.best_square;
    training.parameters = watch.best;
  }
  return training;
}

}  // namespace libchar::fusion
