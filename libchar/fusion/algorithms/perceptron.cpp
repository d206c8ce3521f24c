#include "libchar/fusion/algorithms/perceptron.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <string>

#include "libchar/core/refusal.hpp"
#include "libchar/fusion/detail/network/network_training.hpp"

namespace libchar::fusion {

namespace {

/// The neurons that are asked for, or as many as the limit on weights allows.
std::size_t neurons_of(std::size_t inputs, const Settings& settings) {
  const auto most = (static_cast<std::size_t>(settings["most_weights"]) - 1) / (inputs + 2);
  return std::min(static_cast<std::size_t>(settings["neurons"]), std::max<std::size_t>(most, 1));
}

}  // namespace

Perceptron::Perceptron(const Array& array, const Settings& settings)
    : network_{static_cast<std::size_t>(array.channels),
               neurons_of(static_cast<std::size_t>(array.channels), settings)},
      asked_(static_cast<std::size_t>(settings["neurons"])),
      scales_(network_.inputs),
      z_(network_.inputs),
      most_(static_cast<std::size_t>(settings["most_samples"])),
      choice_(~static_cast<std::uint64_t>(settings["seed"])),
      starts_(static_cast<std::size_t>(settings["starts"])),
      iterations_(static_cast<std::size_t>(settings["iterations"])),
      seed_(static_cast<std::uint64_t>(settings["seed"])),
      held_out_(settings["held_out"]) {}

void Perceptron::learn(const Sample& y, const Sample& truth) {
  const auto width = static_cast<std::ptrdiff_t>(network_.inputs) + 1;
  std::size_t place = seen_++;
  if (kept_ < most_) {
    window_.resize(++kept_ * (network_.inputs + 1));
    when_.push_back(0);
  } else {
    place = static_cast<std::size_t>(0.5 * (choice_() + 1) * static_cast<double>(seen_));
    if (place >= most_) return;
  }
  when_[place] = seen_ - 1;
  const auto to = window_.begin() + static_cast<std::ptrdiff_t>(place) * width;
  std::copy(y.begin(), y.end(), to);
  *(to + width - 1) = truth[0];
}

/// By time again: the last ones are held out.
void Perceptron::put_in_order() {
  if (seen_ == kept_) return;
  std::vector<std::size_t> order(kept_);
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(), [this](std::size_t a, std::size_t b) { return when_[a] < when_[b]; });
  const auto width = static_cast<std::ptrdiff_t>(network_.inputs) + 1;
  std::vector<double> sorted;
  sorted.reserve(window_.size());
  for (const std::size_t k : order) {
    const auto row = window_.begin() + static_cast<std::ptrdiff_t>(k) * width;
    sorted.insert(sorted.end(), row, row + width);
  }
  window_ = std::move(sorted);
}

/// A constant drops out for good, also if it moves later: nothing has been learnt about it.
Perceptron::Scale Perceptron::scale_of(const Eigen::Ref<const Eigen::VectorXd>& values) {
  const double first = values[0];
  const double mean = first + (values.array() - first).mean();
  const double deviation =
      (values.array() - mean).matrix().stableNorm() / std::sqrt(static_cast<double>(values.size()));
  return {mean, deviation > 0 ? deviation : std::numeric_limits<double>::infinity()};
}

void Perceptron::standardise() {
  const auto width = static_cast<Eigen::Index>(network_.inputs) + 1;
  Eigen::Map<Eigen::MatrixXd> rows(window_.data(), width, static_cast<Eigen::Index>(kept_));
  for (Eigen::Index i = 0; i < width; ++i) {
    const Scale scale = scale_of(rows.row(i).transpose());
    rows.row(i) = (rows.row(i).array() - scale.mean) / scale.deviation;
    (i + 1 < width ? scales_[static_cast<std::size_t>(i)] : target_) = scale;
  }
}

void Perceptron::finish_learning() {
  const auto held_out = static_cast<std::size_t>(held_out_ * static_cast<double>(kept_));
  const std::size_t training = kept_ - held_out;
  if (training < 2 * network_.size() || held_out == 0)
    throw numeric_error("E0860")
        .says("the learning window holds fewer than two instants for each weight of the perceptron (" +
              std::to_string(network_.size()) + " weights)")
        .got(std::to_string(training))
        .hint("set fewer neurons, or lengthen the learning window");
  put_in_order();
  standardise();
  if (!std::isfinite(target_.deviation))
    throw numeric_error("E0864")
        .says("the reference is constant in the learning window: there is nothing to learn")
        .hint("learn where the input moves");
  const TrainingRows training_rows{window_.data(), training};
  const TrainingRows rest{window_.data() + training * (network_.inputs + 1), held_out};
  Training best = train(network_, training_rows, rest, {.starts = starts_, .iterations = iterations_, .seed = seed_});
  if (best.parameters.empty())
    throw numeric_error("E0861")
        .says("no training of the perceptron gave finite numbers")
        .hint("look for huge values in the learning window");
  parameters_ = std::move(best.parameters);
  variance_ = best.held_out_square * target_.deviation * target_.deviation;
  std::vector<double>().swap(window_);
  std::vector<std::size_t>().swap(when_);
}

/// A channel that stood still has an infinite deviation; handed out as 0.
void Perceptron::exchange(LearntExchange& with) {
  const std::size_t n = scales_.size();
  std::vector<double> means(n), deviations(n);
  for (std::size_t i = 0; i < n; ++i) {
    means[i] = scales_[i].mean;
    deviations[i] = std::isfinite(scales_[i].deviation) ? scales_[i].deviation : 0;
  }
  if (with.taking_in()) parameters_.resize(network_.size());
  with.numbers("parameters", parameters_);
  with.numbers("means", means);
  with.numbers("deviations", deviations);
  with.number("target_mean", target_.mean);
  with.number("target_deviation", target_.deviation);
  with.number("variance", variance_);
  for (std::size_t i = 0; i < n; ++i)
    scales_[i] = {means[i], deviations[i] > 0 ? deviations[i] : std::numeric_limits<double>::infinity()};
}

Estimate Perceptron::step(const Sample& y) {
  if (parameters_.empty()) return Estimate::none(1);
  for (std::size_t i = 0; i < z_.size(); ++i)
    z_[i] = (y[static_cast<Eigen::Index>(i)] - scales_[i].mean) / scales_[i].deviation;
  const double out = network_.output(parameters_.data(), z_.data());
  return Estimate::scalar(target_.mean + target_.deviation * out, variance_);
}

void Perceptron::remarks(Findings& warnings) const {
  if (network_.hidden < asked_)
    warnings.add("perceptron_fewer_neurons", "has " + std::to_string(network_.hidden) + " neurons instead of " +
                                                 std::to_string(asked_) + ": most_weights allows no more for " +
                                                 std::to_string(network_.inputs) + " channels");
}

}  // namespace libchar::fusion
