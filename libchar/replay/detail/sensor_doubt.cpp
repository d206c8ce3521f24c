#include "libchar/replay/detail/sensor_doubt.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "libchar/core/numeric/median.hpp"
#include "libchar/fusion/algorithm.hpp"

namespace libchar::detail {
namespace {

constexpr int kHeld = 4096;  // instants: a turned sensor shows nothing at rest, and weights remember
constexpr double kMemory = 1.0 / 32, kMemoryOfDistance = 1.0 / 8;
// Beyond what is usual of a block of 256 or 64 instants:
constexpr double kDoubtedMean = 1.25;  // of its rms
constexpr double kDoubtedUsual = 2;    // of its mean
constexpr double kDoubtedScatter = 2;  // of its rms
constexpr double kCorrelated = 0.5;    // neighbours, of the mean square: no noise

}  // namespace

SensorDoubt::SensorDoubt(std::vector<std::optional<LearntSensor::Reading>> learnt)
    : learnt_(std::move(learnt)),
      held_(learnt_.size()),
      mean_(learnt_.size()),
      square_(learnt_.size()),
      product_(learnt_.size()),
      last_(learnt_.size()) {
  for (std::size_t i = 0; i < learnt_.size(); ++i)
    if (learnt_[i]) square_[i] = learnt_[i]->usual_rms * learnt_[i]->usual_rms;
}

SensorDoubt::Variance SensorDoubt::instant(const Eigen::MatrixXd& samples, Eigen::Index at, double estimate) {
  sorted_.clear();
  for (const double y : samples.col(at))
    if (fusion::usable(y)) sorted_.push_back(y);
  const bool pair = learnt_.size() == 2;
  if (sorted_.size() < (pair ? 2 : 3)) return {};
  const double u = median_in_place(sorted_);
  bool any = false;
  double sum = 0, weights = 0, trusted = 0, furthest = 0;
  for (std::size_t i = 0; i < learnt_.size(); ++i) {
    const double y = samples(static_cast<Eigen::Index>(i), at);
    if (!learnt_[i] || !fusion::usable(y)) continue;
    const LearntSensor::Reading& usual = *learnt_[i];
    const double e = y - u - usual.offset - usual.gain * u;
    mean_[i] += kMemory * (e - mean_[i]);
    square_[i] += kMemory * (e * e - square_[i]);
    product_[i] += kMemory * (e * last_[i] - product_[i]);
    last_[i] = e;
    if (std::abs(mean_[i]) > std::max(kDoubtedMean * usual.usual_rms, kDoubtedUsual * usual.usual_mean) ||
        std::sqrt(square_[i]) > kDoubtedScatter * usual.usual_rms) {
      held_[i] = kHeld;
      if (product_[i] > kCorrelated * square_[i]) moved_ = kHeld;
    }
    if (usual.gain > -1) furthest = std::max(furthest, std::abs(estimate - (y - usual.offset) / (1 + usual.gain)));
    const bool doubted = held_[i] > 0;
    held_[i] -= doubted ? 1 : 0;
    any = any || doubted;
    if (doubted || !(usual.usual_rms > 0) || !(usual.gain > -1)) continue;
    const double weight = 1 / (usual.usual_rms * usual.usual_rms);
    sum += weight * (y - usual.offset) / (1 + usual.gain);
    weights += weight;
    trusted += 1;
  }
  const double middle = trusted >= 2 ? sum / weights : u;
  const double away = pair || (trusted < 2 && moved_ > 0) ? furthest : estimate - middle;
  moved_ -= moved_ > 0 ? 1 : 0;
  if (std::isfinite(away)) away_ += kMemoryOfDistance * (away * away - away_);
  return any ? Variance{trusted >= 2 ? 1 / weights : 0, away_} : Variance{};
}

const std::vector<SensorDoubt::Variance>& SensorDoubt::push(const Eigen::MatrixXd& samples,
                                                            const Eigen::VectorXd& estimates) {
  out_.resize(static_cast<std::size_t>(samples.cols()));
  for (Eigen::Index k = 0; k < samples.cols(); ++k)
    out_[static_cast<std::size_t>(k)] = instant(samples, k, estimates[k]);
  return out_;
}

}  // namespace libchar::detail
