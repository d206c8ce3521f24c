#include "libchar/fusion/detail/bias/bias_smoother.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "libchar/core/numeric/dense.hpp"
#include "libchar/core/numeric/whole.hpp"
#include "libchar/core/refusal.hpp"
#include "libchar/fusion/detail/bias/bias_filter.hpp"

namespace libchar::fusion {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr Index kKeptTogether = 4096;
constexpr int kLookedAtEach = 16;  // as often as the filter's own covariance
constexpr int kLooksAnOctave = 4;
constexpr double kNothingNew = 1e-7;

/// A' L A: how uncertain v is.
MatrixXd future_variance(const BiasFilter& filter, const MatrixXd& p, const MatrixXd& information) {
  MatrixXd mixed = information * p;
  mixed.diagonal().array() += 1;
  const MatrixXd l = general_solve(mixed, information);
  const MatrixXd back = filter.transition().transpose() * l * filter.transition();
  return 0.5 * (back + back.transpose());
}

}  // namespace

BiasSmoother::BiasSmoother(std::unique_ptr<BiasFilter> filter, Index channels, Index inputs, double most_bytes)
    : filter_(std::move(filter)), channels_(channels), inputs_(inputs), most_bytes_(most_bytes) {}

Eigen::Ref<VectorXd> BiasSmoother::kept(std::int64_t instant) {
  return kept_[static_cast<std::size_t>(instant / kKeptTogether)].col(static_cast<Index>(instant % kKeptTogether));
}

void BiasSmoother::look(const Sample& y) {
  const auto bytes = static_cast<double>((channels_ + inputs_) * 8);
  if (count_ % kKeptTogether == 0) {
    if (static_cast<double>(count_ + kKeptTogether) * bytes > most_bytes_)
      throw numeric_error("E0868")
          .says("virtual-sensor with smoothed=1 keeps " + std::to_string(clamped_whole<long>(std::round(bytes))) +
                " bytes per instant, and this run has more than fit into most_mb")
          .got(std::to_string(clamped_whole<std::int64_t>(std::round(most_bytes_ / 1e6))) + " MB")
          .hint("set most_mb higher, or evaluate a shorter part");
    kept_.emplace_back(channels_ + inputs_, kKeptTogether);
  }
  const Estimate estimate = filter_->step(y);
  auto column = kept(count_++);
  for (Index i = 0; i < channels_; ++i)
    column[i] = usable(y[i]) ? filter_->residual()[i] : std::numeric_limits<double>::quiet_NaN();
  column.tail(inputs_) = estimate.x;
}

std::vector<BiasSmoother::Later> BiasSmoother::later() const {
  const MatrixXd information = filter_->information();
  std::vector<Later> out{{0, MatrixXd::Zero(information.rows(), information.cols())}};
  RiccatiSteps steps(filter_->transition().transpose(), information, filter_->drive());
  double length = 1;
  for (int left = kLookedAtEach; out.back().instants < static_cast<double>(count_);) {
    MatrixXd next = steps.advance(out.back().information);
    const double change = (next - out.back().information).cwiseAbs().maxCoeff();
    const bool same = change <= kNothingNew * next.cwiseAbs().maxCoeff();
    out.push_back({out.back().instants + length, std::move(next)});
    if (--left > 0) continue;
    if (same) break;
    steps.twice();
    length *= 2;
    left = kLooksAnOctave;
  }
  return out;
}

/// `other`: A' L A is not that of the instant before.
void BiasSmoother::smooth(std::int64_t instant, bool other) {
  auto column = kept(instant);
  const Sample y(column.data(), channels_);
  const BiasGain& gain = filter_->gain_in(filter_->epoch_at(static_cast<double>(instant)), y);
  if (other || gain.version != version_) {
    version_ = gain.version;
    for (Index j = 0; j < inputs_; ++j) {
      const VectorXd row = gain.coupling.row(j);
      gained_variance_[j] = row.dot(variance_ * row);
    }
  }
  for (Index i = 0; i < channels_; ++i) residual_[i] = usable(y[i]) ? y[i] : 0;
  for (Index j = 0; j < inputs_; ++j) {
    const double none = std::numeric_limits<double>::quiet_NaN();
    column[channels_ + j] -= gain.coupling.row(j).dot(future_);
    column[j] = gain.determined ? std::max(gain.input_variance[j] - gained_variance_[j], 0.0) : none;
  }
  residual_seen_.noalias() = gain.gain.transpose() * future_;
  back_ = future_;
  back_.noalias() += gain.information * residual_;
  back_.noalias() -= filter_->seen().transpose() * residual_seen_;
  filter_->pull_back(back_);
  future_.swap(back_);
}

void BiasSmoother::finish() {
  const std::vector<Later> told = later();
  future_ = back_ = VectorXd::Zero(filter_->transition().rows());
  residual_ = residual_seen_ = VectorXd::Zero(channels_);
  gained_variance_ = VectorXd::Zero(inputs_);
  std::size_t epoch = 0, place = 0;
  for (std::int64_t instant = count_ - 1; instant >= 0; --instant) {
    const auto left = static_cast<double>(count_ - 1 - instant);
    const std::size_t now = filter_->epoch_at(static_cast<double>(instant + 1));
    bool other = instant + 1 == count_ || now != epoch;
    epoch = now;
    for (; place + 1 < told.size() && told[place + 1].instants <= left; ++place) other = true;
    if (other) variance_ = future_variance(*filter_, filter_->covariance(now), told[place].information);
    smooth(instant, other);
  }
}

Estimate BiasSmoother::step() {
  if (count_ == 0) return Estimate::none(inputs_);
  if (next_ == count_) next_ = 0;
  const auto column = kept(next_++);
  return {column.tail(inputs_), column.head(inputs_)};
}

}  // namespace libchar::fusion
