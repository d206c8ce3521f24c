#include "libchar/fusion/algorithms/best_axes.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "libchar/core/refusal.hpp"

namespace libchar::fusion {
namespace {

using Eigen::Index;
using Square = ChosenAxes::Square;

constexpr double kSingular = 1e-9;  // a pivot relative to its row
constexpr int kMostSweeps = 64;
constexpr double kBetter = 1 - 1e-12;

bool counts(double mean_square) { return mean_square > 0 && std::isfinite(mean_square); }

/// A^-1 by Gauss and Jordan with pivots among the rows; false: singular.
bool inverted(Square a, Square& out) {
  const Index r = a.rows();
  out.setIdentity(r, r);
  for (Index j = 0; j < r; ++j) {
    Index pivot = j;
    for (Index i = j + 1; i < r; ++i)
      if (std::abs(a(i, j)) > std::abs(a(pivot, j))) pivot = i;
    if (!(std::abs(a(pivot, j)) > kSingular)) return false;
    a.row(j).swap(a.row(pivot));
    out.row(j).swap(out.row(pivot));
    const double scale = 1 / a(j, j);
    a.row(j) *= scale;
    out.row(j) *= scale;
    for (Index i = 0; i < r; ++i) {
      if (i == j) continue;
      const double times = a(i, j);
      a.row(i) -= times * a.row(j);
      out.row(i) -= times * out.row(j);
    }
  }
  return true;
}

class Choice {
 public:
  Choice(const Eigen::MatrixXd& h, const Eigen::VectorXd& mean_squares) : h_(h), d_(mean_squares), r_(h.cols()) {}

  ChosenAxes best() {
    ChosenAxes out;
    out.variance.setConstant(r_, std::numeric_limits<double>::quiet_NaN());
    out.inverse.setZero(r_, r_);
    if (!start()) return out;
    double least = trace();
    for (int sweep = 0; sweep < kMostSweeps && exchange(least); ++sweep) {
    }
    out.channels = chosen_;
    out.determined = solve(out.inverse);
    for (Index j = 0; j < r_; ++j) {
      out.variance[j] = 0;
      for (Index k = 0; k < r_; ++k) out.variance[j] += out.inverse(j, k) * out.inverse(j, k) * d_[channel(k)];
    }
    return out;
  }

 private:
  Index channel(Index k) const { return chosen_[static_cast<std::size_t>(k)]; }
  bool is_chosen(Index i, Index count) const {
    return std::find(chosen_.begin(), chosen_.begin() + count, i) != chosen_.begin() + count;
  }

  /// Rows of largest volume, one after the other.
  bool start() {
    Square basis = Square::Zero(r_, r_);  // orthonormal rows
    for (Index k = 0; k < r_; ++k) {
      double most = 0;
      State direction;
      for (Index i = 0; i < h_.rows(); ++i) {
        if (!counts(d_[i]) || is_chosen(i, k)) continue;
        State row = h_.row(i).transpose();
        const double length = row.norm();
        for (Index b = 0; b < k; ++b) row -= basis.row(b).dot(row) * basis.row(b).transpose();
        const double left = row.norm();
        if (!(left > kSingular * length) || !(left / std::sqrt(d_[i]) > most)) continue;
        most = left / std::sqrt(d_[i]);
        direction = row / left;
        chosen_[static_cast<std::size_t>(k)] = i;
      }
      if (!(most > 0)) return false;
      basis.row(k) = direction.transpose();
    }
    return true;
  }

  /// H_S^-1; rows are scaled to length one beforehand.
  bool solve(Square& inverse) const {
    Square rows(r_, r_);
    State lengths(r_);
    for (Index k = 0; k < r_; ++k) {
      lengths[k] = h_.row(channel(k)).norm();
      rows.row(k) = h_.row(channel(k)) / lengths[k];
    }
    if (!inverted(rows, inverse)) return false;
    for (Index k = 0; k < r_; ++k) inverse.col(k) /= lengths[k];
    return true;
  }

  double trace() const {
    Square inverse;
    if (!solve(inverse)) return std::numeric_limits<double>::infinity();
    double sum = 0;
    for (Index k = 0; k < r_; ++k) sum += inverse.col(k).squaredNorm() * d_[channel(k)];
    return sum;
  }

  /// The first exchange that helps, for each place in turn.
  bool exchange(double& least) {
    bool changed = false;
    for (Index k = 0; k < r_; ++k)
      for (Index i = 0; i < h_.rows(); ++i) {
        if (!counts(d_[i]) || is_chosen(i, r_)) continue;
        const Index before = std::exchange(chosen_[static_cast<std::size_t>(k)], i);
        const double now = trace();
        if (now < kBetter * least) {
          least = now;
          changed = true;
        } else {
          chosen_[static_cast<std::size_t>(k)] = before;
        }
      }
    return changed;
  }

  const Eigen::MatrixXd& h_;
  const Eigen::VectorXd& d_;
  Index r_;
  std::array<Index, kMaxStates> chosen_{};
};

}  // namespace

ChosenAxes choose_axes(const Eigen::MatrixXd& h, const Eigen::VectorXd& mean_squares) {
  return Choice(h, mean_squares).best();
}

BestAxes::BestAxes(const Array& array)
    : h_(array.h()),
      squares_(Eigen::VectorXd::Zero(array.channels)),
      counts_(squares_),
      present_squares_(squares_),
      present_(static_cast<std::size_t>(array.channels), 1) {}

void BestAxes::learn(const Sample& y, const Sample& truth) {
  for (Eigen::Index i = 0; i < y.size(); ++i)
    if (usable(y[i])) {
      const double error = y[i] - h_.row(i).dot(truth);
      squares_[i] += error * error;
      counts_[i] += 1;
    }
}

void BestAxes::finish_learning() {
  for (Eigen::Index i = 0; i < squares_.size(); ++i) squares_[i] = counts_[i] > 0 ? squares_[i] / counts_[i] : -1;
  // A channel without any error is as good as one of a thousand millionth of the largest.
  const double least = 1e-18 * squares_.maxCoeff();
  for (double& square : squares_)
    if (square >= 0) square = std::max({square, least, std::numeric_limits<double>::min()});
  choose_all();
  if (!all_.determined)
    throw numeric_error("E0856").says(
        "best-axes: no channels with samples in the learning window determine the inputs");
}

void BestAxes::choose_all() { now_ = all_ = choose_axes(h_, squares_); }

Estimate BestAxes::step(const Sample& y) {
  bool same = true, whole = true;
  for (Eigen::Index i = 0; i < y.size(); ++i) {
    char& before = present_[static_cast<std::size_t>(i)];
    const char now = usable(y[i]) ? 1 : 0;
    same = same && now == before;
    whole = whole && now != 0;
    before = now;
  }
  if (!same && whole) now_ = all_;
  if (!same && !whole) {
    for (Eigen::Index i = 0; i < y.size(); ++i)
      present_squares_[i] = present_[static_cast<std::size_t>(i)] != 0 ? squares_[i] : -1;
    now_ = choose_axes(h_, present_squares_);
  }
  Estimate out = Estimate::none(h_.cols());
  if (!now_.determined) return out;
  for (Eigen::Index j = 0; j < h_.cols(); ++j) {
    double sum = 0;
    for (Eigen::Index k = 0; k < h_.cols(); ++k)
      sum += now_.inverse(j, k) * y[now_.channels[static_cast<std::size_t>(k)]];
    out.x[j] = sum;
  }
  out.variance = now_.variance;
  return out;
}

Eigen::MatrixXd BestAxes::weights() const {
  Eigen::MatrixXd out = Eigen::MatrixXd::Zero(h_.rows(), h_.cols());
  for (Eigen::Index k = 0; now_.determined && k < h_.cols(); ++k)
    out.row(now_.channels[static_cast<std::size_t>(k)]) = now_.inverse.col(k).transpose();
  return out;
}

void BestAxes::exchange(LearntExchange& with) {
  with.numbers("mean_square_errors", span_of(squares_));
  if (with.taking_in()) choose_all();
}

}  // namespace libchar::fusion
