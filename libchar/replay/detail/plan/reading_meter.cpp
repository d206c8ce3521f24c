#include "libchar/replay/detail/plan/reading_meter.hpp"

#include <algorithm>
#include <cmath>

#include "libchar/core/numeric/distributions.hpp"
#include "libchar/core/numeric/interval.hpp"
#include "libchar/core/numeric/median.hpp"
#include "libchar/core/numeric/standing_apart.hpp"
#include "libchar/core/numeric/whole.hpp"
#include "libchar/fusion/algorithm.hpp"

namespace libchar::detail {
namespace {

constexpr std::int64_t kLongBlock = 256, kShortBlock = 64, kManyInstants = 5120;
constexpr std::size_t kMostBlocks = 2048, kLeastBlocks = 8;
constexpr double kLeastInBlock = 16;      // samples
constexpr std::size_t kLeastSensors = 3;  // of more than two: the median of fewer is another one
constexpr double kUsual = 0.9;            // of the blocks are within what counts as usual
constexpr double kOfHalf = 2.44;          // the same over the median, of means that are normal
constexpr double kOfHalfRms = 1.1;        // of rms
constexpr double kBeyondUsual = 4;        // times the usual mean of a block
constexpr double kBeyondNoise = 0.5;      // of the noise: a smaller change of the mean is not worth a word
constexpr double kLouder = 2.5;           // times the usual rms of a block
constexpr double kQuietest = 0.5;         // of the usual rms of the middle sensor: less is no scatter of its own

constexpr double kShifted = 0.5;      // of the mean square of a block
constexpr double kFarOff = 3;         // times the noise, and what is beyond the usual mean of a block
constexpr double kOutlier = 5;        // times the rms of the steps of its block, and of the usual rms
constexpr std::size_t kFewClean = 4;  // of so many blocks one without outliers tells the scatter
constexpr double kMostOfOutlier = 3;  // times a mean of outliers alone, at least, is the rms

constexpr double kLeastDrift = 0.05;   // of a gain
constexpr double kLeastSignal = 10;    // times the noise, of the squares that show a gain
constexpr double kLeastBetween = 300;  // the same, of the means of blocks
constexpr double kOtherSign = -1.25;   // beyond one, of a gain: noise alone gives none below -1
constexpr double kOffsetsCount = 0.2;  // of the mean square of differences
constexpr double kResolved = 5;        // standard errors of an offset, or of a delay
constexpr double kLeastOfDelay = 0.2;  // of the mean square of a block

double quantile(std::vector<double> values, double share) {
  const auto at = static_cast<std::size_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(at), values.end());
  return values[at];
}

/// Of values with weights: half of the weight is on either side.
double weighted_median(std::vector<std::pair<double, double>> values) {
  std::sort(values.begin(), values.end());
  double all = 0, below = 0;
  for (const auto& [value, weight] : values) all += weight;
  for (const auto& [value, weight] : values)
    if ((below += weight) >= 0.5 * all) return value;
  return 0;
}

/// Of two scatters over the usual one that which is further from it.
double less_usual(double a, double b) { return std::max(b, 1 / b) > std::max(a, 1 / a) ? b : a; }

/// One sensor that is far off moves the median by as much as the others scatter: what moves no further than
/// that is its doing.
std::vector<ReadingMeter::Change> own_changes(std::vector<ReadingMeter::Change> changes,
                                              const std::vector<std::optional<LearntSensor::Reading>>& learnt) {
  if (changes.size() < 2) return changes;
  std::vector<double> noise;
  for (const auto& one : learnt)
    if (one) noise.push_back(one->usual_rms);
  const double usual = median_in_place(noise);
  double furthest = 0;
  for (const auto& change : changes) furthest = std::max(furthest, std::abs(change.offset));
  std::erase_if(changes, [&](const ReadingMeter::Change& change) {
    return change.scatter <= kLouder && change.scatter * kLouder >= 1 && std::abs(change.offset) < furthest &&
           std::abs(change.offset) <= usual;
  });
  return changes;
}

}  // namespace

ReadingMeter::ReadingMeter(Eigen::Index sensors, std::int64_t instants)
    : n_(static_cast<std::size_t>(sensors)),
      block_(instants >= kManyInstants ? kLongBlock : kShortBlock),
      now_(n_),
      neighbours_(n_),
      usual_(n_) {}

void ReadingMeter::expect(const Readings& learnt) {
  for (std::size_t i = 0; i < n_; ++i)
    if (learnt[i]) usual_[i] = {learnt[i]->offset, learnt[i]->gain};
  whole_ = std::max(whole_, static_cast<double>(block_));
}

// Median of all, of what each is beside it where some are missing.
double ReadingMeter::middle(const Eigen::MatrixXd& samples, Eigen::Index at, bool& enough, bool& whole) {
  sorted_.clear();
  for (const double y : samples.col(at))
    if (fusion::usable(y)) sorted_.push_back(y);
  enough = sorted_.size() >= std::min(kLeastSensors, n_);
  whole = sorted_.size() == n_;
  double u = enough ? median_in_place(sorted_) : 0;
  if (enough && !whole && whole_ >= static_cast<double>(block_)) {
    sorted_.clear();
    for (std::size_t i = 0; i < n_; ++i)
      if (const double y = samples(static_cast<Eigen::Index>(i), at); fusion::usable(y))
        sorted_.push_back(y - usual_[i].offset - usual_[i].gain * u);
    u = median_in_place(sorted_);
  }
  whole_ += whole ? 1 : 0;
  return u;
}

void ReadingMeter::push(const Eigen::MatrixXd& samples) {
  bool enough = false, whole = false;
  for (Eigen::Index k = 0; k < samples.cols(); ++k) {
    const double u = middle(samples, k, enough, whole);
    if (enough) take(samples, k, u, whole);
    if (++seen_ % block_ == 0) close();
  }
}

void ReadingMeter::push(const Eigen::MatrixXd& samples, const Eigen::RowVectorXd& truth) {
  truth_ = true;
  for (Eigen::Index k = 0; k < samples.cols(); ++k) {
    if (fusion::usable(truth[k])) take(samples, k, truth[k], false);
    if (++seen_ % block_ == 0) close();
  }
}

void ReadingMeter::take(const Eigen::MatrixXd& samples, Eigen::Index at, double u, bool whole) {
  for (std::size_t i = 0; i < n_; ++i) {
    const double y = samples(static_cast<Eigen::Index>(i), at);
    if (!fusion::usable(y)) continue;
    if (whole) usual_[i].offset += (y - u - usual_[i].offset - usual_[i].gain * u) / whole_;
    Sums& s = now_[i];
    if (s.n == 0) {
      s.u0 = u;
      s.r0 = y - u;
    }
    const double du = u - s.u0, dr = y - u - s.r0;
    if (s.last >= 0 && s.last + 1 == seen_) {
      const double step_u = du - s.last_u, step_r = dr - s.last_r;
      s.steps += 1;
      s.suu += step_u * step_u;
      s.sur += step_u * step_r;
      s.srr += step_r * step_r;
      s.largest = std::max(s.largest, step_r * step_r);
      if (s.motion.at >= 0 && s.motion.at + 2 == seen_) {
        const double m = 0.5 * (du - s.motion.u);
        s.motion.n += 1;
        s.motion.m += m;
        s.motion.mm += m * m;
        s.motion.mu += m * s.last_u;
        s.motion.mr += m * s.last_r;
      }
      s.motion.u = s.last_u;
      s.motion.at = s.last;
      neighbours_[i].all += 1;
      neighbours_[i].same += y == neighbours_[i].last ? 1 : 0;
    }
    neighbours_[i].last = y;
    s.last_u = du;
    s.last_r = dr;
    s.last = seen_;
    s.n += 1;
    s.u += du;
    s.r += dr;
    s.uu += du * du;
    s.ur += du * dr;
    s.rr += dr * dr;
  }
}

void ReadingMeter::close() {
  if (closed_ % stride_ == 0) blocks_.push_back(now_);
  ++closed_;
  std::fill(now_.begin(), now_.end(), Sums{});
  if (blocks_.size() < kMostBlocks) return;
  for (std::size_t k = 1; 2 * k < blocks_.size(); ++k) blocks_[k] = std::move(blocks_[2 * k]);
  blocks_.resize((blocks_.size() + 1) / 2);
  stride_ *= 2;
}

ReadingMeter::Fit ReadingMeter::fit(const Sums& s, double a, double b) {
  // e = r - a - b u with u = u0 + du, r = r0 + dr.
  const double first = s.r0 - a - b * s.u0, mean = (s.r - b * s.u) / s.n;
  const double square = (s.rr - 2 * b * s.ur + b * b * s.uu) / s.n;
  return {first + mean, std::sqrt(std::max(0.0, square + 2 * first * mean + first * first))};
}

bool ReadingMeter::outlying(const Sums& s, double usual_rms) {
  const double least = kOutlier * std::max(std::sqrt(s.srr / std::max(1.0, s.steps)), usual_rms);
  return s.largest > least * least;
}

// Variance of the median's own noise, and mean square of what moves in the blocks.
double ReadingMeter::median_noise(double& moves) const {
  std::vector<double> noise;
  double n = 0;
  moves = 0;
  for (std::size_t i = 0; i < n_; ++i) {
    double uu = 0, ur = 0, rr = 0, all = 0;
    for (const auto& block : blocks_) {
      const Sums& s = block[i];
      if (s.n < kLeastInBlock) continue;
      uu += s.uu - s.u * s.u / s.n;
      ur += s.ur - s.u * s.r / s.n;
      rr += s.rr - s.r * s.r / s.n;
      all += s.n;
    }
    if (!(all > 0)) continue;
    noise.push_back((rr - (uu > 0 ? ur * ur / uu : 0)) / all);
    moves += uu;
    n += all;
  }
  if (noise.empty()) return 0;
  moves /= n;
  if (truth_) return 0;
  return kMedianError * kMedianError * median_in_place(noise) / static_cast<double>(noise.size());
}

// What moves is the input: the median's own noise would be taken for gains, of a noisier sensor above one.
bool ReadingMeter::tells_gains() const {
  double moves = 0;
  const double noise = median_noise(moves);
  return moves > kLeastSignal * noise;
}

std::vector<ReadingMeter::Squares> ReadingMeter::squares_within(std::size_t sensor, std::size_t from,
                                                                std::size_t to) const {
  std::vector<Squares> out;
  for (std::size_t k = from; k < to; ++k) {
    const Sums& s = blocks_[k][sensor];
    if (s.n >= kLeastInBlock) out.push_back({s.uu - s.u * s.u / s.n, s.ur - s.u * s.r / s.n, s.rr - s.r * s.r / s.n});
  }
  return out;
}

// Of the means of neighbours, with the noise of a sample: of an input that hardly moves within a block.
std::vector<ReadingMeter::Squares> ReadingMeter::squares_between(std::size_t sensor, std::size_t from,
                                                                 std::size_t to) const {
  std::vector<Squares> out;
  const Sums* before = nullptr;
  for (std::size_t k = from; k < to; ++k) {
    const Sums& s = blocks_[k][sensor];
    if (s.n < kLeastInBlock) continue;
    if (before != nullptr) {
      const double u = s.u0 + s.u / s.n - before->u0 - before->u / before->n;
      const double r = s.r0 + s.r / s.n - before->r0 - before->r / before->n;
      const double weight = 0.5 * std::min(s.n, before->n);
      out.push_back({weight * u * u, weight * u * r, weight * r * r});
    }
    before = &s;
  }
  return out;
}

ReadingMeter::Slopes ReadingMeter::slopes_of(const std::vector<Squares>& squares) {
  Slopes out;
  for (const Squares& one : squares)
    if (one.uu > 0) out.emplace_back(one.ur / one.uu, one.uu);
  return out;
}

ReadingMeter::Readings ReadingMeter::readings(double share, double mean_factor, double rms_factor) const {
  Readings out(n_);
  const bool gains = tells_gains();
  for (std::size_t i = 0; i < n_; ++i) {
    Slopes slopes = slopes_of(squares_within(i, 0, blocks_.size()));
    std::vector<double> left, means, scatter, clean;
    if (slopes.size() < kLeastBlocks) continue;
    LearntSensor::Reading reading;
    const double gain = weighted_median(std::move(slopes));
    if (gains || gain < kOtherSign) reading.gain = gain;
    for (const auto& block : blocks_)
      if (block[i].n >= kLeastInBlock) left.push_back(fit(block[i], 0, reading.gain).mean);
    reading.offset = median_in_place(left);
    for (const auto& block : blocks_) {
      if (block[i].n < kLeastInBlock) continue;
      const Fit one = fit(block[i], reading.offset, reading.gain);
      means.push_back(std::abs(one.mean));
      scatter.push_back(one.rms);
      if (!outlying(block[i], 0)) clean.push_back(one.rms);
    }
    if (kFewClean * clean.size() >= scatter.size() && clean.size() >= kLeastBlocks) scatter = std::move(clean);
    reading.usual_mean = mean_factor * quantile(std::move(means), share);
    reading.usual_rms = rms_factor * quantile(std::move(scatter), share);
    if (std::isfinite(reading.usual_rms) && std::isfinite(reading.gain)) out[i] = reading;
  }
  return out;
}

ReadingMeter::Readings ReadingMeter::result() const { return readings(kUsual, 1, 1); }

ReadingMeter::Readings ReadingMeter::steady() const { return readings(0.5, kOfHalf, kOfHalfRms); }

ReadingMeter::Readings ReadingMeter::learnt() const {
  Readings out = result();
  const Readings usual = steady();
  for (const Change& change : changes(usual, true)) {
    if (pair()) return usual;
    out[change.sensor] = usual[change.sensor];
  }
  return out;
}

std::vector<double> ReadingMeter::with_outliers(const Readings& readings) const {
  std::vector<double> out;
  const double least = limits(readings, false).least;
  for (std::size_t i = 0; i < n_; ++i) {
    double all = 0, with = 0;
    for (const auto& block : blocks_) {
      all += readings[i] ? 1 : 0;
      with += readings[i] && outlying(block[i], std::max(readings[i]->usual_rms, least)) ? 1 : 0;
    }
    out.push_back(with / std::max(1.0, all));
  }
  return out;
}

struct ReadingMeter::Place {
  double offset = 0, noise = 0, error = 0;  // standard error of the offset
  double weight(bool alike) const { return alike || !(noise > 0) ? 1 : 1 / (noise * noise); }
};

namespace {

/// Deviation of the weighted mean of offsets, widened to hold 95 % as normal errors do: of those that are draws of one
/// kind, and all of what those weigh that stand apart from them.
template <class Place>
double level_deviation(const std::vector<Place>& near, const std::vector<Place>& apart, bool alike) {
  const auto n = static_cast<double>(near.size());
  double mean = 0, squares = 0, w = 0, ww = 0, off = 0;
  for (const Place& one : near) mean += one.offset / n;
  for (const Place& one : near) {
    const double weight = one.weight(alike);
    squares += (one.offset - mean) * (one.offset - mean);
    w += weight;
    ww += weight * weight;
  }
  for (const Place& one : apart) {
    w += one.weight(alike);
    off += one.weight(alike) * std::abs(one.offset - mean);
  }
  return std::hypot(std::sqrt(squares / (n - 1) * ww) * student_quantile(0.975, n - 1) / kNormal95, off) / w;
}

}  // namespace

// As of the level, of the gains of the sensors where what moves tells them: those that stand apart are said, and not
// fused alike. What the slopes scatter is no difference between sensors.
double ReadingMeter::common_gain_sd(const std::vector<Place>& places, const std::vector<TakenOut>& taken_out) const {
  double moves = 0, errors = 0;
  const double noise = median_noise(moves);
  std::vector<double> gains;
  for (std::size_t i = 0; i < n_; ++i) {
    Slopes all = moves > kLeastSignal * noise ? slopes_of(squares_within(i, 0, blocks_.size())) : Slopes{};
    double weights = 0, squares = 0, between = 0;
    const Slopes slow = slopes_of(squares_between(i, 0, blocks_.size()));
    for (const auto& [slope, weight] : slow) between += weight;
    if (between > kLeastSignal * noise * static_cast<double>(slow.size()))
      all.insert(all.end(), slow.begin(), slow.end());
    if (all.size() < kLeastBlocks) return 0;
    gains.push_back(weighted_median(all));
    for (const auto& [slope, weight] : all) {
      weights += weight;
      squares += weight * weight * (slope - gains.back()) * (slope - gains.back());
    }
    errors += squares / weights / weights / static_cast<double>(n_);
    gains.back() += taken_out[i].gain;
  }
  const std::vector<bool> apart = standing_apart(gains);
  std::vector<Place> near;
  for (std::size_t i = 0; i < n_; ++i)
    if (!apart[i]) near.push_back({gains[i], places[i].noise, 0});
  double mean = 0, squares = 0;
  for (const Place& one : near) mean += one.offset / static_cast<double>(near.size());
  for (const Place& one : near) squares += (one.offset - mean) * (one.offset - mean);
  const double variance = squares / static_cast<double>(near.size() - 1);
  return level_deviation(near, {}, false) * std::sqrt(variance > 0 ? std::max(0.0, 1 - errors / variance) : 0);
}

std::optional<ReadingMeter::Level> ReadingMeter::level(const std::vector<TakenOut>& taken_out) const {
  if (n_ < kLeastSensors) return std::nullopt;
  std::vector<double> inputs;
  for (const auto& block : blocks_)
    if (block[0].n >= kLeastInBlock) inputs.push_back(block[0].u0 + block[0].u / block[0].n);
  const double input = inputs.empty() ? 0 : median_in_place(inputs);
  std::vector<Place> places;
  std::vector<double> scatter, away, offsets;
  for (std::size_t i = 0; i < n_; ++i) {
    std::vector<double> means, rms, off;
    for (const auto& block : blocks_)
      if (block[i].n >= kLeastInBlock) means.push_back(fit(block[i], 0, 0).mean);
    if (means.size() < kLeastBlocks) return std::nullopt;
    const double middle = median_in_place(means);
    for (const auto& block : blocks_)
      if (block[i].n >= kLeastInBlock) rms.push_back(fit(block[i], middle, 0).rms);
    for (const double mean : means) off.push_back(std::abs(mean - middle));
    scatter.push_back(median_in_place(rms));
    const double error = kMadToSd * median_in_place(off) / std::sqrt(static_cast<double>(means.size()));
    places.push_back({middle + taken_out[i].offset + taken_out[i].gain * input, scatter.back(), error});
    offsets.push_back(places.back().offset);
  }
  const std::vector<bool> apart = standing_apart(offsets);
  double mean = 0, near = 0;
  for (std::size_t i = 0; i < n_; ++i)
    if (!apart[i]) near += 1, mean += (offsets[i] - mean) / near;
  std::vector<double> sorted = offsets;
  const double median = median_in_place(sorted), noise = median_in_place(scatter);
  for (const double offset : offsets) away.push_back(std::abs(offset - median));
  const double usual = median_in_place(away);
  const bool all = usual * usual > kOffsetsCount * (usual * usual + noise * noise);
  Level out;
  std::vector<Place> alike, others;
  for (std::size_t i = 0; i < n_; ++i) {
    const double offset = offsets[i] - mean;
    const bool taken = apart[i] && std::abs(offset) > kResolved * places[i].error;
    out.offsets.push_back(all || taken ? offset : 0);
    out.matters = out.matters || out.offsets.back() != 0;
    if (!apart[i]) alike.push_back(places[i]);
    if (apart[i] && !taken && !all) others.push_back(places[i]);
  }
  out.common.level_sd = level_deviation(alike, others, all);
  if (const double sd = common_gain_sd(places, taken_out); sd > 0) {
    out.common.gain_sd = sd;
    out.common.gain_about = input;
  }
  return out;
}

std::vector<double> ReadingMeter::repeated() const {
  std::vector<double> out;
  for (const Neighbours& one : neighbours_) out.push_back(one.same / std::max(1.0, one.all));
  return out;
}

std::vector<std::optional<double>> ReadingMeter::slow_scatter(const Readings& readings) const {
  std::vector<std::optional<double>> out(n_);
  for (std::size_t i = 0; i < n_; ++i) {
    if (!readings[i]) continue;
    const double b = readings[i]->gain;
    std::vector<double> rms, steps;
    for (const auto& block : blocks_) {
      const Sums& s = block[i];
      if (s.steps < kLeastInBlock) continue;
      rms.push_back(fit(s, readings[i]->offset, b).rms);
      steps.push_back(std::sqrt(std::max(0.0, (s.srr - 2 * b * s.sur + b * b * s.suu) / (2 * s.steps))));
    }
    if (rms.size() < kLeastBlocks) continue;
    const double step = median_in_place(steps), all = median_in_place(rms);
    if (step > 0 && all > 0) out[i] = all / step;
  }
  return out;
}

// In each block c = cov(m, e) and v = var(m): d = -sum(c) / sum(v), its error by what c + d v scatters.
std::vector<ReadingMeter::Delay> ReadingMeter::delays() const {
  const Readings usual = steady();
  std::vector<Delay> out;
  for (std::size_t i = 0; i < n_; ++i) {
    if (!usual[i]) continue;
    const double b = usual[i]->gain;
    std::vector<std::pair<double, double>> blocks;
    std::vector<double> shares;
    double v = 0, c = 0, scatter = 0;
    for (const auto& block : blocks_) {
      const Sums& s = block[i];
      if (s.motion.n < kLeastInBlock) continue;
      const double mean = s.motion.m / s.motion.n, motion = s.motion.mm - mean * s.motion.m;
      const double with = s.motion.mr - mean * s.r - b * (s.motion.mu - mean * s.u);
      const double square =
          s.rr - s.r * s.r / s.n - 2 * b * (s.ur - s.u * s.r / s.n) + b * b * (s.uu - s.u * s.u / s.n);
      blocks.emplace_back(motion, with);
      if (motion > 0 && square > 0) shares.push_back(with * with / motion / square);
      v += motion;
      c += with;
    }
    if (shares.size() < kLeastBlocks || !(v > 0)) continue;
    const double delay = -c / v;
    for (const auto& [motion, with] : blocks) scatter += (with + delay * motion) * (with + delay * motion);
    std::nth_element(shares.begin(), shares.begin() + static_cast<std::ptrdiff_t>(shares.size() / 2), shares.end());
    const double share = shares[shares.size() / 2];
    if (share > kLeastOfDelay && std::abs(delay) * v > kResolved * std::sqrt(scatter)) out.push_back({i, delay, share});
  }
  return out;
}

namespace {

constexpr std::size_t kParts = 8, kLeastParts = 6;

struct PartGain {
  double weight = 0, gain = 0, at = 0;  ///< of 0 to 1 in the log
  double variance = 0;                  ///< of the gain, by what those of its blocks scatter
};

}  // namespace

// Weighted least squares of the parts' gains b_p, weights W_p = sum (u - mean u)^2, on their places in the log, or on
// being behind one of their ends: the one that is furthest beyond its error.
std::optional<ReadingMeter::Line> ReadingMeter::gain_line(std::size_t sensor) const {
  std::vector<PartGain> parts;
  for (std::size_t part = 0; part < kParts; ++part) {
    const std::size_t from = part * blocks_.size() / kParts, to = (part + 1) * blocks_.size() / kParts;
    std::vector<Squares> all;
    for (const bool between : {false, true}) {
      const std::vector<Squares> some = between ? squares_between(sensor, from, to) : squares_within(sensor, from, to);
      Squares sum;
      for (const Squares& one : some) sum.uu += one.uu, sum.ur += one.ur, sum.rr += one.rr;
      // The median's noise would be the gain's, and that of few differences between blocks is hardly known.
      const double least = between ? kLeastBetween : kLeastSignal;
      if (between && some.size() < kLeastBlocks) continue;
      if (sum.uu > 0 && sum.uu > least * (sum.rr - sum.ur * sum.ur / sum.uu))
        all.insert(all.end(), some.begin(), some.end());
    }
    if (all.empty()) continue;
    double uu = 0, ur = 0, scatter = 0;
    for (const Squares& one : all) uu += one.uu, ur += one.ur;
    const double gain = ur / uu;
    for (const Squares& one : all) scatter += (one.ur - gain * one.uu) * (one.ur - gain * one.uu);
    parts.push_back({uu, gain, (static_cast<double>(part) + 0.5) / kParts, scatter / uu / uu});
  }
  if (parts.size() < kLeastParts) return std::nullopt;
  std::optional<Line> out;
  for (std::size_t end = 0; end < parts.size(); ++end) {
    const auto place = [&](const PartGain& one) { return end == 0 ? one.at : one.at < parts[end].at ? 0.0 : 1.0; };
    double w = 0, x = 0, y = 0, xx = 0, xy = 0, variance = 0;
    for (const PartGain& one : parts) {
      w += one.weight;
      x += one.weight * place(one);
      y += one.weight * one.gain;
    }
    x /= w;
    y /= w;
    for (const PartGain& one : parts) {
      const double by = one.weight * (place(one) - x);
      xx += by * (place(one) - x);
      xy += by * one.gain;
      variance += by * by * one.variance;
    }
    const Line line{y - xy / xx * x, y + xy / xx * (1 - x), std::sqrt(variance) / xx};
    if (!out || line.change() * out->error > out->change() * line.error) out = line;
  }
  return out;
}

std::vector<ReadingMeter::GainDrift> ReadingMeter::gain_drifts(double false_alarm, const Readings* learnt) const {
  std::vector<std::optional<Line>> lines;
  for (std::size_t i = 0; i < n_; ++i)
    lines.push_back(learnt != nullptr && !(*learnt)[i] ? std::nullopt : gain_line(i));
  const auto moved = [&](std::size_t i) {
    return learnt == nullptr ? lines[i]->change() : std::max(lines[i]->change(), lines[i]->away((*learnt)[i]->gain));
  };
  std::vector<GainDrift> out;
  for (std::size_t i = 0; i < n_; ++i) {
    std::vector<double> others;
    for (std::size_t j = 0; j < n_; ++j)
      if (j != i && lines[j]) others.push_back(moved(j));
    if (!lines[i] || others.size() < 2) continue;
    const double rare = false_alarm / (2 * static_cast<double>(n_ * kParts));
    const double chance = student_quantile(1 - rare, static_cast<double>(blocks_.size())) * lines[i]->error;
    if (moved(i) > std::max({kLeastDrift, kBeyondUsual * median_in_place(others), chance}))
      out.push_back({i, lines[i]->from, lines[i]->to});
  }
  return out;
}

bool ReadingMeter::beyond(const Sums& s, const LearntSensor::Reading& usual, const Limits& limits, double motion) {
  const Fit block = fit(s, usual.offset, usual.gain);
  if (s.n < kLeastInBlock ||
      (outlying(s, std::max(usual.usual_rms, limits.least)) && kMostOfOutlier * std::abs(block.mean) < block.rms))
    return false;
  const double more = std::max(1.0, motion), rms = more * std::max(usual.usual_rms, limits.least);
  return std::abs(block.mean) > std::max(kBeyondUsual * more * usual.usual_mean, kBeyondNoise * rms) ||
         block.rms > kLouder * rms ||
         (limits.quieter && block.rms * kLouder < std::min(1.0, motion) * usual.usual_rms &&
          block.rms > kQuietest * limits.least);
}

// A sensor in the middle is the median itself, and its scatter nothing, for as long as the signal holds it there:
// what scatters less than the middle sensor is taken to scatter as much. Two are off their mean alike.
ReadingMeter::Limits ReadingMeter::limits(const Readings& learnt, bool quieter) const {
  if (truth_ || learnt.size() == 2) return {0, quieter};
  std::vector<double> rms;
  for (const auto& one : learnt)
    if (one) rms.push_back(one->usual_rms);
  return {median_in_place(rms), quieter};
}

// Delays and other axes scatter with the motion m, the mean square step of the median: rms^2 = v + c m, v the median of
// the calmer half of the blocks, c that of the other half. The mean of two has as much noise as its distance from each.
std::vector<double> ReadingMeter::motion_factors(std::size_t sensor, const LearntSensor::Reading& usual) const {
  struct Block {
    double motion = 0, square = 0;
    std::size_t at = 0;
  };
  std::vector<double> out(blocks_.size(), 1.0);
  std::vector<Block> all;
  for (std::size_t k = 0; k < blocks_.size(); ++k) {
    const Sums& s = blocks_[k][sensor];
    if (s.n < kLeastInBlock || s.steps < kLeastInBlock) continue;
    const double rms = fit(s, usual.offset, usual.gain).rms;
    all.push_back({std::max(0.0, s.suu - (pair() ? s.srr : 0)) / s.steps, rms * rms, k});
  }
  if (all.size() < kLeastBlocks) return out;
  std::sort(all.begin(), all.end(), [](const Block& a, const Block& b) { return a.motion < b.motion; });
  const std::size_t half = all.size() / 2;
  std::vector<double> calm, slopes;
  for (std::size_t k = 0; k < half; ++k) calm.push_back(all[k].square);
  const double v = median_in_place(calm);
  for (std::size_t k = half; k < all.size(); ++k)
    if (all[k].motion > 0) slopes.push_back(std::max(0.0, all[k].square - v) / all[k].motion);
  const double c = slopes.empty() ? 0 : median_in_place(slopes), middle = v + c * all[half].motion;
  for (const Block& block : all)
    if (middle > 0) out[block.at] = std::sqrt((v + c * block.motion) / middle);
  return out;
}

/// As independent noise is, and no error of the motion.
bool ReadingMeter::noisy(const Sums& s, const LearntSensor::Reading& usual) {
  const Fit here = fit(s, usual.offset, usual.gain);
  const double steps = s.srr - 2 * usual.gain * s.sur + usual.gain * usual.gain * s.suu;
  return s.steps > 0 && steps / (2 * s.steps) > kShifted * (here.rms * here.rms - here.mean * here.mean);
}

/// So far off that one block says it.
bool ReadingMeter::far_off(const Sums& s, const LearntSensor::Reading& usual, const Limits& limits, double motion) {
  const double more = kFarOff * std::max(1.0, motion);
  return std::abs(fit(s, usual.offset, usual.gain).mean) >
         more * std::max({kBeyondUsual * usual.usual_mean, usual.usual_rms, limits.least});
}

/// Its offset or its gain is another: more than half of the scatter.
bool ReadingMeter::shifted(const Sums& s, const LearntSensor::Reading& usual) {
  const Fit here = fit(s, usual.offset, usual.gain);
  const double uu = s.uu - s.u * s.u / s.n, ue = s.ur - s.u * s.r / s.n - usual.gain * uu;
  const double by_gain = uu > 0 ? ue * ue / uu / s.n : 0;
  return here.mean * here.mean + by_gain > kShifted * here.rms * here.rms;
}

// Of each sensor its blocks that are beyond, but for those where it is one further off that moves the median.
std::vector<ReadingMeter::Blocks> ReadingMeter::blocks_beyond(const Readings& learnt, const Limits& limits) const {
  std::vector<Blocks> out(std::min(n_, learnt.size()));
  for (std::size_t i = 0; i < out.size(); ++i) {
    out[i].beyond.assign(blocks_.size(), 0);
    if (!learnt[i]) continue;
    out[i].motion = motion_factors(i, *learnt[i]);
    for (std::size_t k = 0; k < blocks_.size(); ++k)
      out[i].beyond[k] = beyond(blocks_[k][i], *learnt[i], limits, out[i].motion[k]) ? 1 : 0;
  }
  for (std::size_t k = 0; k < blocks_.size(); ++k) {
    double furthest = 0;
    for (std::size_t i = 0; i < out.size(); ++i)
      if (out[i].beyond[k] != 0)
        furthest = std::max(furthest, std::abs(fit(blocks_[k][i], learnt[i]->offset, learnt[i]->gain).mean));
    for (std::size_t i = 0; i < out.size(); ++i) {
      if (out[i].beyond[k] == 0) continue;
      const Fit here = fit(blocks_[k][i], learnt[i]->offset, learnt[i]->gain);
      if (std::abs(here.mean) < furthest && std::abs(here.mean) <= limits.least &&
          here.rms <= kLouder * learnt[i]->usual_rms)
        out[i].beyond[k] = 0;
    }
  }
  return out;
}

// What all sensors do now and then puts single blocks of any beyond: so many in a row are more than those of the middle
// sensor do by chance, in all sensors together. A run beside its own usual state has more of its own (other axes that
// move now and then), but for blocks in which its offset or gain is another. Of independent blocks as many as begin a
// row, of those behind one that is not beyond, are so by chance: `lasts` where more than that follow one that is
// (binomial).
std::vector<ReadingMeter::LeastRow> ReadingMeter::least_in_a_row(const std::vector<Blocks>& sensors,
                                                                 const Limits& limits) const {
  constexpr double kByChance = 1e-3, kLasts = 0.01;
  std::vector<double> begun, own(sensors.size(), 0.0), by_chance(sensors.size(), 1.0);
  for (std::size_t i = 0; i < sensors.size(); ++i) {
    if (sensors[i].motion.empty()) continue;
    double times = 0, free = 0, follow = 0, behind = 0;
    bool before = false;
    for (const char one : sensors[i].beyond) {
      const bool now = one != 0;
      times += now && !before ? 1 : 0;
      free += before ? 0 : 1;
      behind += before ? 1 : 0;
      follow += now && before ? 1 : 0;
      before = now;
    }
    begun.push_back(times);
    if (!limits.quieter || !(free > 0)) continue;
    own[i] = (times - 1) / free;
    if (follow > 0) by_chance[i] = binomial_tail(follow - 1, behind, std::min(times / free, 1.0));
  }
  const double blocks = static_cast<double>(blocks_.size());
  const double common = begun.empty() ? 0 : (median_in_place(begun) - 1) / blocks;
  const auto row = [&](double chance) {
    if (!(chance > 0)) return std::int64_t{2};
    const double least = std::log(kByChance / (blocks * static_cast<double>(n_))) / std::log(std::min(chance, 0.99));
    return std::max<std::int64_t>(2, clamped_whole<std::int64_t>(std::ceil(least)));
  };
  std::vector<LeastRow> out;
  for (std::size_t i = 0; i < sensors.size(); ++i)
    out.push_back({row(std::max(common, own[i])), row(common), by_chance[i] < kLasts, !(common > 0)});
  return out;
}

std::vector<ReadingMeter::Change> ReadingMeter::changes(const Readings& learnt, bool quieter) const {
  const Limits limits = ReadingMeter::limits(learnt, quieter);
  const std::vector<Blocks> sensors = blocks_beyond(learnt, limits);
  const std::vector<LeastRow> least = least_in_a_row(sensors, limits);
  std::vector<Change> out;
  for (std::size_t i = 0; i < sensors.size(); ++i) {
    if (!learnt[i]) continue;
    const LearntSensor::Reading& usual = *learnt[i];
    Change one{i, 0, 1, 0, 0, false}, row = one;  // of those in a row
    std::int64_t in_a_row = 0, shifts = 0, changed = 0, first = -1, last = 0;
    for (std::size_t k = 0; k < blocks_.size(); ++k) {
      const Sums& s = blocks_[k][i];
      if (s.n < kLeastInBlock) continue;
      if (sensors[i].beyond[k] == 0) {
        in_a_row = shifts = 0;
        continue;
      }
      shifts = shifted(s, usual) || (least[i].lasts && noisy(s, usual)) ? shifts + 1 : 0;
      const Fit here = fit(s, usual.offset, usual.gain);
      if (in_a_row++ == 0) row = {i, 0, 1, static_cast<std::int64_t>(k), 0, false};
      if (std::abs(here.mean) > std::abs(row.offset)) row.offset = here.mean;
      if (usual.usual_rms > 0) row.scatter = less_usual(row.scatter, here.rms / usual.usual_rms);
      const bool alone = least[i].alone && far_off(s, usual, limits, sensors[i].motion[k]);
      if (in_a_row < least[i].any && shifts < least[i].shifted && !alone) continue;
      if (first < 0) first = row.from;
      last = static_cast<std::int64_t>(k);
      ++changed;
      if (std::abs(row.offset) > std::abs(one.offset)) one.offset = row.offset;
      one.scatter = less_usual(one.scatter, row.scatter);
    }
    if (changed == 0) continue;
    one.from = first * block_ * stride_;
    one.to = std::min((last + 1) * block_ * stride_, seen_);
    one.to_end = last + 1 == static_cast<std::int64_t>(blocks_.size());
    out.push_back(one);
  }
  if (pair()) {
    out.resize(std::min<std::size_t>(out.size(), 1));
    return out;
  }
  if (!truth_) out = own_changes(std::move(out), learnt);
  // Where most change it is what they see that does: motion, and how the sensors differ in it.
  if (quieter && 2 * out.size() > learnt.size()) out.clear();
  return out;
}

}  // namespace libchar::detail
