#include "libchar/fusion/detail/simplex/network_fit.hpp"

#include <algorithm>
#include <cmath>

#include "libchar/fusion/detail/network/network_training.hpp"
#include "libchar/fusion/detail/uniform.hpp"

namespace libchar::fusion {
namespace {

constexpr std::size_t kRowsPerSlice = 32;         // one pass forward each
constexpr std::size_t kProductsPerSlice = 65536;  // where a row has as many as there are pairs of parameters
constexpr std::size_t kColumnsPerSlice = 4;
constexpr int kMostIterations = 25, kPatience = 4;
constexpr double kRidge = 1e-9;            // of the diagonal of the affine part
constexpr double kLeastDecrease = 1e-5;    // of the sum of squares, relative
constexpr double kLeastShare = 1e-3;       // of a promised decrease, for a step to be taken
constexpr double kSmallestRadius = 1e-20;  // of the trust region

/// L of A = L L' column by column, in the lower triangle.
bool factor_column(double* a, std::size_t n, std::size_t j) {
  double d = a[j * n + j];
  for (std::size_t k = 0; k < j; ++k) d -= a[j * n + k] * a[j * n + k];
  if (!(d > 0)) return false;
  const double root = std::sqrt(d);
  a[j * n + j] = root;
  for (std::size_t i = j + 1; i < n; ++i) {
    double s = a[i * n + j];
    for (std::size_t k = 0; k < j; ++k) s -= a[i * n + k] * a[j * n + k];
    a[i * n + j] = s / root;
  }
  return true;
}

void solve_factored_rows(const double* l, double* b, std::size_t n) {
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t k = 0; k < i; ++k) b[i] -= l[i * n + k] * b[k];
    b[i] /= l[i * n + i];
  }
  for (std::size_t i = n; i-- > 0;) {
    for (std::size_t k = i + 1; k < n; ++k) b[i] -= l[k * n + i] * b[k];
    b[i] /= l[i * n + i];
  }
}

}  // namespace

bool solve_in_place(double* a, double* b, std::size_t n, double ridge) {
  for (std::size_t j = 0; j < n; ++j) a[j * n + j] = a[j * n + j] > 0 ? a[j * n + j] * (1 + ridge) : 1;
  for (std::size_t j = 0; j < n; ++j)
    if (!factor_column(a, n, j)) return false;
  solve_factored_rows(a, b, n);
  return true;
}

FittedNetwork::FittedNetwork(const TanhNetwork& shape)
    : network(shape), mean(shape.inputs), scale(shape.inputs), affine(shape.inputs + 1), parameters(shape.size()) {}

double FittedNetwork::output(const double* input, double* scratch) const {
  double out = affine[0];
  for (std::size_t i = 0; i < network.inputs; ++i) {
    scratch[i] = scale[i] > 0 ? (input[i] - mean[i]) / scale[i] : 0;
    out += affine[i + 1] * scratch[i];
  }
  return residual_scale > 0 ? out + residual_scale * network.output(parameters.data(), scratch) : out;
}

NetworkFit::NetworkFit(const TanhNetwork& network, std::size_t most_rows)
    : out_(network),
      rows_(most_rows * (network.inputs + 1)),
      input_(network.inputs),
      square_(network.inputs),
      affine_matrix_((network.inputs + 1) * (network.inputs + 1)),
      affine_side_(network.inputs + 1) {
  const std::size_t size = network.size();
  for (auto* part : {&lm_.p, &lm_.trial, &lm_.step, &lm_.row, &lm_.slope, &lm_.scale}) part->resize(size);
  lm_.a.resize(size * size);
  lm_.factor.resize(size * size);
}

void NetworkFit::begin(const FitRows& rows, std::size_t training, std::size_t held_out, std::uint64_t seed) {
  source_ = &rows;
  training_ = training;
  held_out_ = held_out;
  seed_ = seed;
  out_.held_out_square = -1;
  std::fill(out_.mean.begin(), out_.mean.end(), 0);
  std::fill(square_.begin(), square_.end(), 0);
  next(Phase::moments);
}

void NetworkFit::next(Phase phase) {
  phase_ = phase;
  at_ = 0;
  sum_ = 0;
  if (phase == Phase::affine) {
    std::fill(affine_matrix_.begin(), affine_matrix_.end(), 0);
    std::fill(affine_side_.begin(), affine_side_.end(), 0);
  }
  if (phase == Phase::slopes) {
    std::fill(lm_.a.begin(), lm_.a.end(), 0);
    std::fill(lm_.slope.begin(), lm_.slope.end(), 0);
    lm_.cost = 0;
  }
  if (phase == Phase::factor) lm_.column = 0;
  if (phase == Phase::trial) lm_.trial_cost = 0;
}

std::size_t NetworkFit::phase_rows() const {
  switch (phase_) {
    case Phase::idle:
    case Phase::factor:
      return 0;
    case Phase::residuals:
      return training_ + held_out_;
    case Phase::held_out:
      return held_out_;
    default:
      return training_;
  }
}

bool NetworkFit::advance() {
  if (phase_ == Phase::idle) return false;
  if (phase_ == Phase::factor) {
    if (factor_columns()) take_step();
    return phase_ == Phase::idle;
  }
  std::size_t rows = kRowsPerSlice;
  if (phase_ == Phase::slopes)
    rows = std::clamp<std::size_t>(2 * kProductsPerSlice / (lm_.p.size() * lm_.p.size()), 1, kRowsPerSlice);
  const std::size_t end = std::min(phase_rows(), at_ + rows);
  for (; at_ < end; ++at_) work(at_);
  if (at_ >= phase_rows()) end_of_phase();
  return phase_ == Phase::idle;
}

void NetworkFit::work(std::size_t k) {
  switch (phase_) {
    case Phase::moments:
      return moments(k);
    case Phase::affine:
      return add_affine(k);
    case Phase::residuals:
      return add_residual(k);
    case Phase::slopes:
      return add_slopes(k);
    case Phase::trial:
      return add_trial(k);
    case Phase::held_out:
      return add_held_out(k);
    default:
      return;
  }
}

void NetworkFit::end_of_phase() {
  switch (phase_) {
    case Phase::moments:
      end_moments();
      return next(Phase::affine);
    case Phase::affine:
      return solve_affine() ? next(Phase::residuals) : finish();
    case Phase::residuals:
      return end_residuals();
    case Phase::slopes:
      return damp();
    case Phase::trial:
      return judge_trial();
    case Phase::held_out:
      return judge_held_out();
    default:
      return;
  }
}

// Welford: an offset costs no digits.
void NetworkFit::moments(std::size_t k) {
  source_->row(k, input_.data());
  for (std::size_t i = 0; i < input_.size(); ++i) {
    const double d = input_[i] - out_.mean[i];
    out_.mean[i] += d / static_cast<double>(k + 1);
    square_[i] += d * (input_[i] - out_.mean[i]);
  }
}

void NetworkFit::end_moments() {
  for (std::size_t i = 0; i < input_.size(); ++i) {
    const double deviation = std::sqrt(square_[i] / static_cast<double>(training_));
    // What rounding leaves of a constant is no input.
    out_.scale[i] = deviation > 1e-12 * std::abs(out_.mean[i]) ? deviation : 0;
  }
}

void NetworkFit::add_affine(std::size_t k) {
  const std::size_t n = input_.size() + 1;
  double* const z = row(k);
  z[n - 1] = source_->row(k, input_.data());
  for (std::size_t i = 0; i + 1 < n; ++i) z[i] = out_.scale[i] > 0 ? (input_[i] - out_.mean[i]) / out_.scale[i] : 0;
  const auto value = [&](std::size_t i) { return i == 0 ? 1.0 : z[i - 1]; };
  for (std::size_t i = 0; i < n; ++i) {
    affine_side_[i] += value(i) * z[n - 1];
    for (std::size_t j = 0; j <= i; ++j) affine_matrix_[i * n + j] += value(i) * value(j);
  }
}

bool NetworkFit::solve_affine() {
  if (!solve_in_place(affine_matrix_.data(), affine_side_.data(), affine_side_.size(), kRidge) ||
      !std::all_of(affine_side_.begin(), affine_side_.end(), [](double v) { return std::isfinite(v); }))
    return false;
  out_.affine = affine_side_;
  return true;
}

// The target of a row becomes what the affine part leaves of it.
void NetworkFit::add_residual(std::size_t k) {
  const std::size_t n = input_.size();
  double* const z = row(k);
  if (k >= training_) {
    z[n] = source_->row(k, input_.data());
    for (std::size_t i = 0; i < n; ++i) z[i] = out_.scale[i] > 0 ? (input_[i] - out_.mean[i]) / out_.scale[i] : 0;
  }
  double e = z[n] - out_.affine[0];
  for (std::size_t i = 0; i < n; ++i) e -= out_.affine[i + 1] * z[i];
  z[n] = e;
  if (k < training_)
    sum_ += e * e;
  else
    lm_.trial_cost += e * e;
}

// The affine part alone is the first candidate.
void NetworkFit::end_residuals() {
  out_.residual_scale = 0;
  out_.held_out_square = lm_.trial_cost / static_cast<double>(held_out_);
  lm_.promised = std::sqrt(sum_ / static_cast<double>(training_));
  lm_.trial_cost = 0;
  if (!(lm_.promised > 0) || !std::isfinite(lm_.promised) || !std::isfinite(out_.held_out_square)) return finish();
  for (std::size_t k = 0; k < training_ + held_out_; ++k) row(k)[input_.size()] /= lm_.promised;
  start_parameters();
  next(Phase::slopes);
}

void NetworkFit::start_parameters() {
  Uniform uniform(seed_);
  const TanhNetwork& net = out_.network;
  const double spread = std::sqrt(3.0 / static_cast<double>(net.inputs + 1));
  for (std::size_t i = 0; i < net.v(); ++i) lm_.p[i] = spread * uniform();
  for (std::size_t i = net.v(); i < net.size(); ++i) lm_.p[i] = 0.1 * uniform();
  lm_.radius = 1e2;
  lm_.shrink = 2;
  lm_.iterations = lm_.waited = lm_.invalid = 0;
  lm_.unit = lm_.promised;
}

void NetworkFit::add_slopes(std::size_t k) {
  const std::size_t size = lm_.p.size();
  const double* const z = row(k);
  const double e = out_.network.output(lm_.p.data(), z, lm_.row.data()) - z[out_.network.inputs];
  for (std::size_t i = 0; i < size; ++i) {
    const double r = lm_.row[i];
    lm_.slope[i] += r * e;
    double* const to = lm_.a.data() + i * size;
    for (std::size_t j = 0; j <= i; ++j) to[j] += r * lm_.row[j];
  }
  lm_.cost += e * e;
}

void NetworkFit::damp() {
  const std::size_t size = lm_.p.size();
  if (!std::isfinite(lm_.cost)) return finish();
  std::copy(lm_.a.begin(), lm_.a.end(), lm_.factor.begin());
  for (std::size_t i = 0; i < size; ++i) {
    const double d = lm_.a[i * size + i];
    lm_.factor[i * size + i] = d + (d + 1e-6 * static_cast<double>(training_)) / lm_.radius;
  }
  next(Phase::factor);
}

bool NetworkFit::factor_columns() {
  const std::size_t size = lm_.p.size();
  const std::size_t end = std::min(size, lm_.column + kColumnsPerSlice);
  for (; lm_.column < end; ++lm_.column)
    if (!factor_column(lm_.factor.data(), size, lm_.column)) {
      lm_.radius /= lm_.shrink;
      lm_.shrink *= 2;
      if (++lm_.invalid > kPatience)
        finish();
      else
        damp();
      return false;
    }
  return lm_.column == size;
}

void NetworkFit::take_step() {
  const std::size_t size = lm_.p.size();
  for (std::size_t i = 0; i < size; ++i) lm_.step[i] = -lm_.slope[i];
  solve_factored_rows(lm_.factor.data(), lm_.step.data(), size);
  double along = 0, curved = 0;
  for (std::size_t i = 0; i < size; ++i) {
    along += lm_.step[i] * lm_.slope[i];
    const double* const from = lm_.a.data() + i * size;
    double s = 0;
    for (std::size_t j = 0; j < i; ++j) s += from[j] * lm_.step[j];
    curved += lm_.step[i] * (2 * s + from[i] * lm_.step[i]);
    lm_.trial[i] = lm_.p[i] + lm_.step[i];
  }
  lm_.promised = -(2 * along + curved);
  if (!(lm_.promised > 0) || !std::isfinite(lm_.promised)) return finish();
  next(Phase::trial);
}

void NetworkFit::add_trial(std::size_t k) {
  const double* const z = row(k);
  const double e = out_.network.output(lm_.trial.data(), z) - z[out_.network.inputs];
  lm_.trial_cost += e * e;
}

void NetworkFit::judge_trial() {
  const double share = (lm_.cost - lm_.trial_cost) / lm_.promised;
  if (!(share > kLeastShare)) {
    lm_.radius /= lm_.shrink;
    lm_.shrink *= 2;
    if (lm_.radius < kSmallestRadius || ++lm_.invalid > 3 * kPatience) return finish();
    return damp();
  }
  lm_.radius /= std::max(1. / 3, 1 - std::pow(2 * std::min(share, 2.0) - 1, 3));
  lm_.shrink = 2;
  lm_.invalid = 0;
  std::swap(lm_.p, lm_.trial);
  next(Phase::held_out);
}

void NetworkFit::add_held_out(std::size_t k) {
  const double* const z = row(training_ + k);
  const double e = out_.network.output(lm_.p.data(), z) - z[out_.network.inputs];
  sum_ += e * e;
}

void NetworkFit::judge_held_out() {
  const double scale = lm_.unit;
  const double square = sum_ / static_cast<double>(held_out_) * scale * scale;
  if (square < out_.held_out_square) {
    out_.held_out_square = square;
    out_.residual_scale = scale;
    std::copy(lm_.p.begin(), lm_.p.end(), out_.parameters.begin());
    lm_.waited = 0;
  } else {
    ++lm_.waited;
  }
  const bool over = ++lm_.iterations >= kMostIterations || lm_.waited >= kPatience ||
                    lm_.cost - lm_.trial_cost < kLeastDecrease * lm_.cost;
  if (over) return finish();
  next(Phase::slopes);
}

void NetworkFit::finish() { phase_ = Phase::idle; }

void NetworkFit::finish_at_once(std::size_t starts) {
  while (busy() && phase_ != Phase::slopes) advance();
  if (!busy()) return;
  const Training best = train(out_.network, {rows_.data(), training_}, {row(training_), held_out_},
                              {.starts = starts, .iterations = 100, .seed = seed_});
  const double scale = lm_.unit;
  const double square = best.held_out_square * scale * scale;
  if (!best.parameters.empty() && square < out_.held_out_square) {
    out_.held_out_square = square;
    out_.residual_scale = scale;
    out_.parameters = best.parameters;
  }
  finish();
}

}  // namespace libchar::fusion
