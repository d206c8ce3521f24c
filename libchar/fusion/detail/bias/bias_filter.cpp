#include "libchar/fusion/detail/bias/bias_filter.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>

#include "libchar/core/numeric/dense.hpp"
#include "libchar/core/refusal.hpp"

namespace libchar::fusion {
namespace {

Eigen::MatrixXd symmetric(const Eigen::MatrixXd& m) { return 0.5 * (m + m.transpose()); }

Eigen::MatrixXd one_plus(Eigen::MatrixXd m) {
  m.diagonal().array() += 1;
  return m;
}

}  // namespace

RiccatiSteps::RiccatiSteps(const Eigen::MatrixXd& transition, const Eigen::MatrixXd& drive,
                           const Eigen::MatrixXd& information)
    : a_(transition.transpose()), g_(information), h_(drive) {}

Eigen::MatrixXd RiccatiSteps::advance(const Eigen::MatrixXd& p) const {
  // P (I + G P)^-1 = ((I + P G)^-1 P), both symmetric.
  const Eigen::MatrixXd updated = symmetric(general_solve(one_plus(p * g_), p));
  return h_ + symmetric(a_.transpose() * updated * a_);
}

void RiccatiSteps::twice() {
  const Eigen::MatrixXd w = one_plus(g_ * h_);
  const Eigen::MatrixXd a = general_solve(w, a_), g = general_solve(w, g_);
  const Eigen::MatrixXd h = symmetric(a_.transpose() * h_ * a);
  g_ += symmetric(a_ * g * a_.transpose());
  h_ += h;
  a_ *= a;
}

const Eigen::MatrixXd& RiccatiSteps::steady() {
  constexpr int kMost = 80;  // 2^80 steps are for ever
  for (int doubling = 0; doubling < kMost; ++doubling) {
    const Eigen::MatrixXd before = h_;
    twice();
    if ((h_ - before).norm() <= 1e-15 * h_.norm()) break;
  }
  return h_;
}

namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kApart = 10;          // ratio of correlation times of neighbours
constexpr double kHidden = 3;          // beyond this ratio of frequencies another noise hides flicker
constexpr double kWalkMemory = 10;     // of a walk, in units of the slowest process of flicker
constexpr double kFastestShare = 0.1;  // of the sampling rate: the fastest corner

struct Process {
  double tau_s, variance, drive_per_s;  // drive_per_s: of a walk
};

std::vector<Process> flicker_processes(const NoiseModel& model, double rate_hz, double slowest_s) {
  const double b = model.flicker;
  if (!(b > 0)) return {};
  const double square = b * b;
  // B^2/(2 pi f) = white density, and = K^2/(2 pi f)^2.
  const double white_hz = square * rate_hz / (2 * kPi * model.white);
  const double walk_hz = (model.walk / b) * (model.walk / b) / (2 * kPi);
  const double fast_s = 1 / (2 * kPi * std::min(kHidden * white_hz, kFastestShare * rate_hz));
  const double slow_s = walk_hz > 0 ? std::min(slowest_s, kHidden / (2 * kPi * walk_hz)) : slowest_s;
  std::vector<Process> out;
  for (double tau = slow_s; tau >= fast_s; tau /= kApart) out.push_back({tau, square * std::log(kApart) / kPi, 0});
  return out;
}

}  // namespace

BiasStates bias_states(const std::vector<NoiseModel>& models, double rate_hz, double slowest_s) {
  std::vector<Process> all;
  BiasStates out;
  for (std::size_t i = 0; i < models.size(); ++i) {
    std::vector<Process> own = flicker_processes(models[i], rate_hz, slowest_s);
    for (const RememberedNoise& noise : models[i].gauss_markov)
      if (noise.sigma > 0 && noise.tau_s > 0) own.push_back({noise.tau_s, noise.sigma * noise.sigma, 0});
    if (models[i].walk > 0) own.push_back({kWalkMemory * slowest_s, 0, models[i].walk * models[i].walk});
    out.channel.insert(out.channel.end(), own.size(), static_cast<Eigen::Index>(i));
    all.insert(all.end(), own.begin(), own.end());
  }
  const auto n = static_cast<Eigen::Index>(all.size());
  out.pole.resize(n);
  out.drive.resize(n);
  out.start.resize(n);
  for (Eigen::Index s = 0; s < n; ++s) {
    const Process& process = all[static_cast<std::size_t>(s)];
    const double step = 1 / (rate_hz * process.tau_s);
    out.pole[s] = std::exp(-step);
    out.drive[s] = process.variance * -std::expm1(-2 * step) + process.drive_per_s / rate_hz;
    out.start[s] = process.variance;
  }
  return out;
}

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr int kAtFirst = 16;          // instants that are each computed
constexpr int kRenewalsAnOctave = 4;  // after them
constexpr double kSteady = 1e-7;      // change of P C' between renewals, relative to S
constexpr std::size_t kSets = 5;      // of channels whose gains are kept

/// C' M C for white noise R alone; `h`: inputs that are not known.
MatrixXd information_of(const MatrixXd& seen, const VectorXd& white, const MatrixXd* h) {
  const VectorXd root = white.cwiseSqrt().cwiseInverse();
  const MatrixXd scaled = root.asDiagonal() * seen;
  const MatrixXd left = h == nullptr ? scaled : without_columns_of(thin_qr(root.asDiagonal() * *h).q, scaled);
  return left.transpose() * left;
}

}  // namespace

BiasFilter::BiasFilter(const Array& array, double slowest_s, Index most_states, const InputModel& input,
                       bool for_smoother)
    : h_(array.h()),
      common_(array.one_common_input() && !(input.deviation > 0)),
      modelled_(input.deviation > 0),
      for_smoother_(for_smoother),
      states_(bias_states(array.noise_models, array.rate_hz, slowest_s)),
      white_(array.channels) {
  const Index n = array.channels, r = h_.cols();
  if (states_.size() > most_states)
    throw usage_error("E0865")
        .says("virtual-sensor would need " + std::to_string(states_.size()) + " states of drift for " +
              std::to_string(n) + " channels")
        .got(std::to_string(most_states))
        .hint("set most_states higher, or slowest_s lower");
  for (Index i = 0; i < n; ++i) white_[i] = array.noise_models[static_cast<std::size_t>(i)].white;
  add_inputs(input, array.rate_hz);
  const Index s = seen_.cols();
  lower_ = MatrixXd::Zero(n, n);
  whitened_ = MatrixXd::Zero(n, r);
  square_ = inverse_ = MatrixXd::Zero(r, r);
  residual_ = column_ = VectorXd::Zero(n);
  bias_ = VectorXd::Zero(s);
  fitted_ = VectorXd::Zero(r);
  used_.reserve(static_cast<std::size_t>(n));
  BiasGain gain{std::vector<char>(static_cast<std::size_t>(n), 0),
                MatrixXd::Zero(r, n),
                MatrixXd::Zero(s, n),
                VectorXd::Zero(r),
                false,
                MatrixXd::Zero(for_smoother_ ? s : 0, n),
                MatrixXd::Zero(r, for_smoother_ ? s : 0)};
  gains_.assign(kSets, gain);
  schedule();
  // The steady gains of all channels say what the inputs' variances come to.
  renew(renewals_.back());
  input_variance_of_steady_ = gains_[0].input_variance;
  renew(renewals_.front());
  next_ = 1;
  now_ = &gains_[0];
}

/// All states together: the biases, then for each input that has a model x and x'/w, whose stationary
/// covariance is the identity times its variance:
///   exp(A dt) = e^-a [1 + a, a; -a, 1 - a], a = w dt.
void BiasFilter::add_inputs(const InputModel& input, double rate_hz) {
  const Index n = white_.size(), b = states_.size();
  const Index s = b + (modelled_ ? 2 * h_.cols() : 0);
  seen_ = MatrixXd::Zero(n, s);
  for (Index k = 0; k < b; ++k) seen_(states_.channel[static_cast<std::size_t>(k)], k) = 1;
  transition_ = drive_ = start_ = MatrixXd::Zero(s, s);
  if (s == 0) return;  // no sensor drifts; an empty matrix has no diagonal to point at
  transition_.diagonal().head(b) = states_.pole;
  drive_.diagonal().head(b) = states_.drive;
  start_.diagonal().head(b) = states_.start;
  if (!modelled_) return;
  const double a = 2 * std::numbers::pi * input.corner_hz / rate_hz;
  Eigen::Matrix2d step;
  step << 1 + a, a, -a, 1 - a;
  step *= std::exp(-a);
  const double variance = input.deviation * input.deviation;
  for (Index j = 0; j < h_.cols(); ++j) {
    const Index k = state_of_input(j);
    seen_.col(k) = h_.col(j);
    transition_.block<2, 2>(k, k) = step;
    start_.block<2, 2>(k, k) = variance * Eigen::Matrix2d::Identity();
    drive_.block<2, 2>(k, k) = variance * (Eigen::Matrix2d::Identity() - step * step.transpose());
  }
}

void BiasFilter::note(double instant, const MatrixXd& p) {
  VectorXd input = VectorXd::Zero(h_.cols());
  for (Index j = 0; modelled_ && j < h_.cols(); ++j) input[j] = p(state_of_input(j), state_of_input(j));
  renewals_.push_back({instant, p * seen_.transpose(), std::move(input)});
  if (for_smoother_) renewals_.back().covariance = p;
}

MatrixXd BiasFilter::information() const { return information_of(seen_, white_, modelled_ ? nullptr : &h_); }

void BiasFilter::schedule() {
  note(0, start_);
  if (seen_.cols() == 0) return;
  RiccatiSteps steps(transition_, drive_, information());
  MatrixXd p = start_;
  double instant = 0, length = 1;
  for (int left = kAtFirst, octave = 0; octave < 64;) {
    p = steps.advance(p);
    instant += length;
    note(instant, p);
    const MatrixXd& before = renewals_[renewals_.size() - 2].cross;
    const double change = (renewals_.back().cross - before).cwiseAbs().maxCoeff();
    if (--left > 0) continue;
    // Steady, as far as differences between channels go; what all share may grow on.
    if (change <= kSteady * white_.minCoeff()) break;
    steps.twice();
    length *= 2;
    left = kRenewalsAnOctave;
    ++octave;
  }
  steady_ = steps.steady();
  note(instant + length, steady_);
}

void BiasFilter::renew(const Renewal& renewal) {
  renewal_ = &renewal;
  // None of the others holds any more: a set without channels determines nothing.
  for (BiasGain& gain : gains_) {
    std::fill(gain.present.begin(), gain.present.end(), char{0});
    gain.determined = false;
  }
  std::fill(gains_[0].present.begin(), gains_[0].present.end(), char{1});
  factor(gains_[0]);
}

/// S = L L' of the channels present, in room made beforehand, as everything below.
void BiasFilter::decompose() {
  const auto covariance = [&](Index a, Index b) {
    double sum = a == b ? white_[a] : 0;
    for (Index s = 0; s < seen_.cols(); ++s) sum += seen_(a, s) * renewal_->cross(s, b);
    return sum;
  };
  const auto m = static_cast<Index>(used_.size());
  for (Index j = 0; j < m; ++j)
    for (Index i = j; i < m; ++i) {
      double left = covariance(used_[static_cast<std::size_t>(i)], used_[static_cast<std::size_t>(j)]);
      for (Index k = 0; k < j; ++k) left -= lower_(i, k) * lower_(j, k);
      lower_(i, j) = i == j ? std::sqrt(left) : left / lower_(j, j);
    }
}

/// L^-1 of what is in `column_`.
void BiasFilter::forward() {
  for (Index i = 0; i < std::ssize(used_); ++i) {
    for (Index k = 0; k < i; ++k) column_[i] -= lower_(i, k) * column_[k];
    column_[i] /= lower_(i, i);
  }
}

/// L'^-1 of it.
void BiasFilter::backward() {
  const auto m = static_cast<Index>(used_.size());
  for (Index i = m - 1; i >= 0; --i) {
    for (Index k = i + 1; k < m; ++k) column_[i] -= lower_(k, i) * column_[k];
    column_[i] /= lower_(i, i);
  }
}

/// (H' S^-1 H)^-1 by Gauss and Jordan without pivots: it is positive definite, at most 8 x 8. False:
/// these channels do not determine the inputs.
bool BiasFilter::invert_information() {
  const auto m = static_cast<Index>(used_.size());
  const Index r = h_.cols();
  for (Index j = 0; j < r; ++j) {
    for (Index k = 0; k < m; ++k) column_[k] = h_(used_[static_cast<std::size_t>(k)], j);
    forward();
    whitened_.col(j).head(m) = column_.head(m);
  }
  for (Index i = 0; i < r; ++i)
    for (Index j = 0; j < r; ++j) {
      square_(i, j) = whitened_.col(i).head(m).dot(whitened_.col(j).head(m));
      inverse_(i, j) = i == j;
    }
  for (Index i = 0; i < r; ++i) {
    const double pivot = square_(i, i);
    if (!(pivot > 1e-12 * whitened_.col(i).head(m).squaredNorm())) return false;
    for (Index j = 0; j < r; ++j) {
      square_(i, j) /= pivot;
      inverse_(i, j) /= pivot;
    }
    for (Index k = 0; k < r; ++k) {
      if (k == i) continue;
      const double times = square_(k, i);
      for (Index j = 0; j < r; ++j) {
        square_(k, j) -= times * square_(i, j);
        inverse_(k, j) -= times * inverse_(i, j);
      }
    }
  }
  return true;
}

/// Source S^-1 (I - H W) for each state, over the channels present; the others stay as they are.
template <class Source>
void BiasFilter::project(const Source& source, const MatrixXd& weights, MatrixXd& into) {
  const auto m = static_cast<Index>(used_.size());
  const auto at = [this](Index k) { return used_[static_cast<std::size_t>(k)]; };
  const Index r = modelled_ ? 0 : h_.cols();
  for (Index s = 0; s < seen_.cols(); ++s) {
    for (Index k = 0; k < m; ++k) column_[k] = source(s, at(k));
    forward();
    backward();
    fitted_.setZero();
    for (Index k = 0; k < m; ++k)
      for (Index j = 0; j < r; ++j) fitted_[j] += column_[k] * h_(at(k), j);
    for (Index k = 0; k < m; ++k) {
      double sum = column_[k];
      for (Index j = 0; j < r; ++j) sum -= fitted_[j] * weights(j, at(k));
      into(s, at(k)) = sum;
    }
  }
}

/// Without a model of the input W C P: its error after the samples is -W (C b + e). With one, the
/// rows of the inputs of -(I - K C) P.
void BiasFilter::couple(BiasGain& out) const {
  if (!modelled_) {
    out.coupling = out.weights * renewal_->cross.transpose();
    return;
  }
  for (Index j = 0; j < h_.cols(); ++j) {
    const Index k = state_of_input(j);
    out.coupling.row(j) = out.gain.row(k) * renewal_->cross.transpose() - renewal_->covariance.row(k);
  }
}

void BiasFilter::factor(BiasGain& out) {
  out.version = ++version_;
  used_.clear();
  for (Index i = 0; i < white_.size(); ++i)
    if (out.present[static_cast<std::size_t>(i)] != 0) used_.push_back(i);
  const auto m = static_cast<Index>(used_.size());
  const auto at = [this](Index k) { return used_[static_cast<std::size_t>(k)]; };
  const Index r = modelled_ ? 0 : h_.cols();
  out.weights.setZero();
  out.gain.setZero();
  out.information.setZero();
  out.coupling.setZero();
  out.determined = false;
  if (m < std::max<Index>(r, 1)) return;
  decompose();
  out.determined = modelled_ || invert_information();
  if (!out.determined) return;
  for (Index j = 0; j < r; ++j) {
    out.input_variance[j] = inverse_(j, j);
    column_.head(m).setZero();
    for (Index i = 0; i < r; ++i) column_.head(m) += inverse_(i, j) * whitened_.col(i).head(m);
    backward();
    for (Index k = 0; k < m; ++k) out.weights(j, at(k)) = column_[k];
  }
  project([&](Index state, Index channel) { return renewal_->cross(state, channel); }, out.weights, out.gain);
  for (Index j = 0; modelled_ && j < h_.cols(); ++j) {
    const Index s = state_of_input(j);
    out.weights.row(j) = out.gain.row(s);
    out.input_variance[j] = renewal_->input[j];
    for (Index k = 0; k < m; ++k) out.input_variance[j] -= out.gain(s, at(k)) * renewal_->cross(s, at(k));
  }
  if (!for_smoother_) return;
  project([this](Index state, Index channel) { return seen_(channel, state); }, out.weights, out.information);
  couple(out);
}

std::size_t BiasFilter::epoch_at(double instant) const {
  const auto after = std::upper_bound(renewals_.begin(), renewals_.end(), instant,
                                      [](double at, const Renewal& r) { return at < r.instant; });
  return static_cast<std::size_t>(after - renewals_.begin()) - 1;
}

const BiasGain& BiasFilter::gain_in(std::size_t epoch, const Sample& y) {
  if (renewal_ != &renewals_[epoch]) renew(renewals_[epoch]);
  return gain_for(y);
}

const BiasGain& BiasFilter::gain_for(const Sample& y) {
  const auto matches = [&](const BiasGain& gain) {
    for (Index i = 0; i < y.size(); ++i)
      if ((gain.present[static_cast<std::size_t>(i)] != 0) != usable(y[i])) return false;
    return true;
  };
  for (const BiasGain& gain : gains_)
    if (matches(gain)) return gain;
  BiasGain& out = gains_[oldest_];
  oldest_ = oldest_ + 1 < gains_.size() ? oldest_ + 1 : 1;
  for (Index i = 0; i < y.size(); ++i) out.present[static_cast<std::size_t>(i)] = usable(y[i]);
  factor(out);
  return out;
}

void BiasFilter::propagate() {
  bias_.head(states_.size()).array() *= states_.pole.array();
  for (Index j = 0; modelled_ && j < h_.cols(); ++j) {
    const Index k = state_of_input(j);
    const double x = bias_[k], slope = bias_[k + 1];
    bias_[k] = transition_(k, k) * x + transition_(k, k + 1) * slope;
    bias_[k + 1] = transition_(k + 1, k) * x + transition_(k + 1, k + 1) * slope;
  }
}

void BiasFilter::pull_back(VectorXd& v) const {
  v.head(states_.size()).array() *= states_.pole.array();
  for (Index j = 0; modelled_ && j < h_.cols(); ++j) {
    const Index k = state_of_input(j);
    const double x = v[k], slope = v[k + 1];
    v[k] = transition_(k, k) * x + transition_(k + 1, k) * slope;
    v[k + 1] = transition_(k, k + 1) * x + transition_(k + 1, k + 1) * slope;
  }
}

Estimate BiasFilter::step(const Sample& y) {
  if (next_ < renewals_.size() && instant_ >= renewals_[next_].instant) renew(renewals_[next_++]);
  instant_ += 1;
  const BiasGain& gain = gain_for(y);
  now_ = &gain;
  Estimate estimate = Estimate::none(h_.cols());
  if (gain.determined) {
    double base = 0;
    for (Index i = 0; common_ && i < y.size(); ++i)
      if (usable(y[i])) {
        base = y[i];
        break;
      }
    for (Index i = 0; i < y.size(); ++i) residual_[i] = usable(y[i]) ? y[i] - base : 0;
    for (Index s = 0; s < states_.size(); ++s) residual_[states_.channel[static_cast<std::size_t>(s)]] -= bias_[s];
    for (Index j = 0; modelled_ && j < h_.cols(); ++j) residual_ -= bias_[state_of_input(j)] * h_.col(j);
    for (Index i = 0; i < y.size(); ++i)
      if (!usable(y[i])) residual_[i] = 0;
    for (Index j = 0; j < h_.cols(); ++j) {
      double sum = modelled_ ? bias_[state_of_input(j)] : base;
      for (Index i = 0; i < y.size(); ++i) sum += gain.weights(j, i) * residual_[i];
      estimate.x[j] = sum;
      estimate.variance[j] = gain.input_variance[j];
    }
    bias_.noalias() += gain.gain * residual_;
  }
  propagate();
  return estimate;
}

Eigen::MatrixXd BiasFilter::weights() const { return now_->weights.transpose(); }

}  // namespace libchar::fusion
