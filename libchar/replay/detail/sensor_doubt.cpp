#include "libchar/replay/detail/sensor_doubt.hpp"

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
constexpr double kMemoryOfMean = 1.0 / 64;
constexpr double kOnTheLine = 0.5;  // square of a correlation
constexpr double kNear = 0.5;       // of the usual mean square
constexpr std::size_t kLeastNotes = 64;
constexpr double kUsualReach = 4;           // of the usual rms
constexpr double kNormal90Square = 2.7055;  // nine of ten squares of normal values, over their mean

double weight_of(const std::optional<LearntSensor::Reading>& usual) {
  return usual && usual->usual_rms > 0 && usual->gain > -1 ? 1 / (usual->usual_rms * usual->usual_rms) : 0;
}

// What a sensor says of the median of all.
double without(const LearntSensor::Reading& usual, double y) { return (y - usual.offset) / (1 + usual.gain); }

}  // namespace

SensorDoubt::SensorDoubt(Readings learnt, std::optional<LearntAlgorithm::Usual> usual)
    : learnt_(std::move(learnt)),
      usual_(usual),
      held_(learnt_.size()),
      mean_(learnt_.size()),
      square_(learnt_.size()),
      product_(learnt_.size()),
      last_(learnt_.size()),
      beyond_(learnt_.size()) {
  for (std::size_t i = 0; i < learnt_.size(); ++i) {
    all_weights_ += weight_of(learnt_[i]);
    if (learnt_[i]) square_[i] = learnt_[i]->usual_rms * learnt_[i]->usual_rms;
  }
}

void SensorDoubt::remember(std::size_t sensor, double e) {
  mean_[sensor] += kMemory * (e - mean_[sensor]);
  square_[sensor] += kMemory * (e * e - square_[sensor]);
  product_[sensor] += kMemory * (e * last_[sensor] - product_[sensor]);
  last_[sensor] = e;
}

/// Of those that are here the median without the furthest of those in doubt, less than half of them; of all, where
/// fewer than two are not in doubt.
double SensorDoubt::middle(const Eigen::MatrixXd& samples, Eigen::Index at) {
  here_.clear();
  for (std::size_t i = 0; i < learnt_.size(); ++i)
    if (fusion::usable(samples(static_cast<Eigen::Index>(i), at))) here_.push_back(i);
  usable_ = here_.size();
  ++seen_;
  const auto worse = [&](std::size_t a, std::size_t b) {
    return (held_[a] > 0) != (held_[b] > 0) ? held_[a] > 0 : beyond_[a] > beyond_[b];
  };
  const auto sound = std::count_if(here_.begin(), here_.end(), [&](std::size_t i) { return held_[i] == 0; });
  std::size_t most = sound < 2 ? 0 : (here_.size() - 1) / 2;
  while (most-- > 0) {
    const auto worst =
        std::max_element(here_.begin(), here_.end(), [&](std::size_t a, std::size_t b) { return worse(b, a); });
    if (held_[*worst] == 0) break;
    here_.erase(worst);
  }
  if (here_.size() < learnt_.size()) return weighted_middle(samples.col(at));
  sorted_.assign(samples.col(at).begin(), samples.col(at).end());
  return median_in_place(sorted_);
}

/// The scatter about the median of all is known, and that of few about theirs is not: by their usual scatter.
double SensorDoubt::weighted_middle(const Eigen::VectorXd& samples) {
  std::sort(here_.begin(), here_.end(), [&](std::size_t a, std::size_t b) {
    return samples[static_cast<Eigen::Index>(a)] < samples[static_cast<Eigen::Index>(b)];
  });
  double all = 0, below = 0;
  for (const std::size_t i : here_) all += weight_of(learnt_[i]);
  for (const std::size_t i : here_)
    if ((below += weight_of(learnt_[i])) >= all / 2) return samples[static_cast<Eigen::Index>(i)];
  return 0;
}

/// What most sensors are off u: one of them may have moved it.
double SensorDoubt::centre() {
  sorted_.clear();
  for (const std::size_t i : here_)
    if (learnt_[i]) sorted_.push_back(mean_[i]);
  return sorted_.empty() ? 0 : median_in_place(sorted_);
}

void SensorDoubt::judge(std::size_t sensor, double centre) {
  const LearntSensor::Reading& usual = *learnt_[sensor];
  const double mean = mean_[sensor] - centre;
  const double square = std::max(0.0, square_[sensor] - centre * (2 * mean_[sensor] - centre));
  beyond_[sensor] =
      std::max(std::abs(mean) / std::max(kDoubtedMean * usual.usual_rms, kDoubtedUsual * usual.usual_mean),
               std::sqrt(square) / (kDoubtedScatter * usual.usual_rms));
  if (!(beyond_[sensor] > 1)) return;
  held_[sensor] = kHeld;
  if (seen_ * kMemory > 1 && product_[sensor] > kCorrelated * square_[sensor]) moved_ = kHeld;
}

/// What the method has of the sensors that are not in doubt, by what it has of all, and by the means of these and of
/// all: the same share of it, or as much more.
SensorDoubt::Variance SensorDoubt::variance(const Trusted& trusted) const {
  const double of_these = trusted.sensors >= 2 ? 1 / trusted.weights : 0;
  if (!usual_ || trusted.any_is_right) return {of_these, away_, 0};
  const double of_all = 1 / all_weights_, lost = std::max(0.0, of_these - of_all);
  const double own = usual_->sd * usual_->sd, distance = usual_->distance * usual_->distance;
  if (is_mean(trusted)) return {own + distance + lost + away_, 0, 0};
  return {std::min(own * std::max(1.0, of_these / of_all), own + lost), away_, distance};
}

/// The estimate is a mean of the sensors, where it usually is something better: nearer to theirs than usual, or between
/// two of them.
bool SensorDoubt::is_mean(const Trusted& trusted) const {
  if (trusted.sensors == 2 && two_.cross * two_.cross >= kOnTheLine * two_.spread * slowly_away_) return true;
  return slowly_away_ < kNear * usual_->distance * usual_->distance;
}

void SensorDoubt::note_distance(double estimate, double u, const Trusted& trusted) {
  const double away =
      trusted.any_is_right ? trusted.furthest : estimate - (trusted.sensors >= 2 ? trusted.sum / trusted.weights : u);
  if (!std::isfinite(away)) return;
  away_ += kMemoryOfDistance * (away * away - away_);
  slowly_away_ += kMemoryOfMean * (away * away - slowly_away_);
  const double apart = trusted.sensors == 2 ? trusted.apart : 0;
  two_.cross += kMemoryOfMean * (away * apart - two_.cross);
  two_.spread += kMemoryOfMean * (apart * apart - two_.spread);
}

SensorDoubt::Variance SensorDoubt::instant(const Eigen::MatrixXd& samples, Eigen::Index at, double estimate) {
  const bool pair = learnt_.size() == 2;
  const double u = middle(samples, at);
  if (usable_ < (pair ? 2 : 3)) return {};
  const auto sample = [&](std::size_t i) { return samples(static_cast<Eigen::Index>(i), at); };
  for (std::size_t i = 0; i < learnt_.size(); ++i)
    if (learnt_[i] && fusion::usable(sample(i))) remember(i, sample(i) - u - learnt_[i]->offset - learnt_[i]->gain * u);
  const double off = centre();
  bool any = false;
  Trusted trusted;
  for (std::size_t i = 0; i < learnt_.size(); ++i) {
    if (!learnt_[i] || !fusion::usable(sample(i))) continue;
    const LearntSensor::Reading& usual = *learnt_[i];
    const double x = without(usual, sample(i));
    judge(i, off);
    if (usual.gain > -1) trusted.furthest = std::max(trusted.furthest, std::abs(estimate - x));
    const bool doubted = held_[i] > 0;
    held_[i] -= doubted ? 1 : 0;
    any = any || doubted;
    if (!doubted) trusted.add(x, weight_of(usual));
  }
  const bool few = trusted.sensors < 2 || 2 * trusted.sensors <= static_cast<double>(usable_);
  trusted.any_is_right = pair || (few && moved_ > 0);
  moved_ -= moved_ > 0 ? 1 : 0;
  note_distance(estimate, u, trusted);
  return any ? variance(trusted) : Variance{};
}

const std::vector<SensorDoubt::Variance>& SensorDoubt::push(const Eigen::MatrixXd& samples,
                                                            const Eigen::VectorXd& estimates) {
  out_.resize(static_cast<std::size_t>(samples.cols()));
  for (Eigen::Index k = 0; k < samples.cols(); ++k)
    out_[static_cast<std::size_t>(k)] = instant(samples, k, estimates[k]);
  return out_;
}

void UsualEstimates::note(double estimate, double variance) {
  estimates_.push_back(estimate);
  variances_.push_back(variance);
}

namespace {

// Of a value that takes turns, what it is while it is large.
double mean_of_squares(std::vector<double>& squares) {
  double sum = 0;
  for (const double one : squares) sum += one;
  const auto at = squares.begin() + static_cast<std::ptrdiff_t>(squares.size() * 9 / 10);
  std::nth_element(squares.begin(), at, squares.end());
  return std::max(sum / static_cast<double>(squares.size()), *at / kNormal90Square);
}

/// Mean of the sensors; none: one of them does not read as usual.
std::optional<double> usual_mean_of(const Readings& learnt, const Eigen::VectorXd& samples) {
  std::vector<double> sorted(samples.begin(), samples.end());
  if (!samples.allFinite() || std::ssize(learnt) != samples.size()) return {};
  const double u = median_in_place(sorted);
  double sum = 0, weights = 0;
  for (std::size_t i = 0; i < learnt.size(); ++i) {
    const double weight = weight_of(learnt[i]), y = samples[static_cast<Eigen::Index>(i)];
    if (weight == 0) continue;
    if (std::abs(y - u - learnt[i]->offset - learnt[i]->gain * u) > kUsualReach * learnt[i]->usual_rms) return {};
    sum += weight * without(*learnt[i], y);
    weights += weight;
  }
  return weights > 0 ? std::optional(sum / weights) : std::nullopt;
}

}  // namespace

std::optional<LearntAlgorithm::Usual> UsualEstimates::result(const Readings& learnt,
                                                             const std::vector<Eigen::VectorXd>& samples,
                                                             double factor) const {
  std::vector<double> squares, variances;
  for (std::size_t k = 0; k < std::min(samples.size(), estimates_.size()); ++k) {
    const auto m = std::isfinite(estimates_[k]) ? usual_mean_of(learnt, samples[k]) : std::nullopt;
    if (!m) continue;
    squares.push_back((estimates_[k] - *m) * (estimates_[k] - *m));
    if (variances_[k] > 0) variances.push_back(variances_[k]);
  }
  if (squares.size() < kLeastNotes) return {};
  LearntAlgorithm::Usual out{std::sqrt(mean_of_squares(squares)), 0};
  if (variances.size() < kLeastNotes) return out;
  const auto at = variances.begin() + static_cast<std::ptrdiff_t>(variances.size() / 4);
  std::nth_element(variances.begin(), at, variances.end());
  out.sd = factor * std::sqrt(*at);
  return out;
}

}  // namespace libchar::detail
