#include "libchar/replay/detail/plan/reading_meter.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "libchar/core/numeric/distributions.hpp"
#include "libchar/core/numeric/interval.hpp"
#include "libchar/core/numeric/median.hpp"
#include "libchar/core/numeric/whole.hpp"
#include "libchar/core/text/readable.hpp"
#include "libchar/core/text/text.hpp"
#include "libchar/fusion/algorithm.hpp"

namespace libchar::detail {
namespace {

constexpr std::int64_t kLongBlock = 256, kShortBlock = 64, kManyInstants = 5120;
constexpr std::size_t kMostBlocks = 2048, kLeastBlocks = 8;
constexpr double kLeastInBlock = 16;  // samples
constexpr double kUsual = 0.9;        // of the blocks are within what counts as usual
constexpr double kOfHalf = 2.44;      // the same over the median, of means that are normal
constexpr double kOfHalfRms = 1.1;    // of rms
constexpr double kBeyondUsual = 4;    // times the usual mean of a block
constexpr double kBeyondNoise = 0.5;  // of the noise: a smaller change of the mean is not worth a word
constexpr double kLouder = 2.5;       // times the usual rms of a block

// Of a sensor that stands apart from the others, at least:
constexpr double kLeastOffset = 3;  // times the noise
constexpr double kLeastGain = 0.05;
constexpr double kLeastLouder = 1;  // of the logarithm of the noise
// Scatter of sound sensors of one kind.
constexpr double kUsualGain = 0.03, kUsualLevel = 0.3;
constexpr double kOffsetsCount = 0.2;  // of the mean square of differences
constexpr double kOfNormal = 1.4826;   // deviation over the median distance
constexpr double kNear = 3;            // such deviations from the median: they make the level
constexpr double kFalseAlarm = 0.003;  // of each of the three in a sound array

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
    : n_(static_cast<std::size_t>(sensors)), block_(instants >= kManyInstants ? kLongBlock : kShortBlock), now_(n_) {}

void ReadingMeter::push(const Eigen::MatrixXd& samples) {
  for (Eigen::Index k = 0; k < samples.cols(); ++k) {
    sorted_.clear();
    for (const double y : samples.col(k))
      if (fusion::usable(y)) sorted_.push_back(y);
    const double u = sorted_.size() >= 3 ? median_in_place(sorted_) : 0;
    for (std::size_t i = 0; sorted_.size() >= 3 && i < n_; ++i) {
      const double y = samples(static_cast<Eigen::Index>(i), k);
      if (!fusion::usable(y)) continue;
      Sums& s = now_[i];
      if (s.n == 0) {
        s.u0 = u;
        s.r0 = y - u;
      }
      const double du = u - s.u0, dr = y - u - s.r0;
      s.n += 1;
      s.u += du;
      s.r += dr;
      s.uu += du * du;
      s.ur += du * dr;
      s.rr += dr * dr;
    }
    if (++seen_ % block_ == 0) close();
  }
}

void ReadingMeter::close() {
  if (closed_ % stride_ == 0) blocks_.push_back(now_);
  ++closed_;
  std::fill(now_.begin(), now_.end(), Sums{});
  if (blocks_.size() < kMostBlocks) return;
  for (std::size_t k = 0; 2 * k < blocks_.size(); ++k) blocks_[k] = std::move(blocks_[2 * k]);
  blocks_.resize((blocks_.size() + 1) / 2);
  stride_ *= 2;
}

ReadingMeter::Fit ReadingMeter::fit(const Sums& s, double a, double b) {
  // e = r - a - b u with u = u0 + du, r = r0 + dr.
  const double first = s.r0 - a - b * s.u0, mean = (s.r - b * s.u) / s.n;
  const double square = (s.rr - 2 * b * s.ur + b * b * s.uu) / s.n;
  return {first + mean, std::sqrt(std::max(0.0, square + 2 * first * mean + first * first))};
}

ReadingMeter::Readings ReadingMeter::readings(double share, double mean_factor, double rms_factor) const {
  Readings out(n_);
  for (std::size_t i = 0; i < n_; ++i) {
    std::vector<std::pair<double, double>> slopes;
    std::vector<double> left, means, scatter;
    for (const auto& block : blocks_) {
      const Sums& s = block[i];
      const double variance = s.uu - s.u * s.u / std::max(1.0, s.n);
      if (s.n >= kLeastInBlock && variance > 0) slopes.emplace_back((s.ur - s.u * s.r / s.n) / variance, variance);
    }
    if (slopes.size() < kLeastBlocks) continue;
    LearntSensor::Reading reading;
    reading.gain = weighted_median(std::move(slopes));
    for (const auto& block : blocks_)
      if (block[i].n >= kLeastInBlock) left.push_back(fit(block[i], 0, reading.gain).mean);
    reading.offset = median_in_place(left);
    for (const auto& block : blocks_) {
      if (block[i].n < kLeastInBlock) continue;
      const Fit one = fit(block[i], reading.offset, reading.gain);
      means.push_back(std::abs(one.mean));
      scatter.push_back(one.rms);
    }
    reading.usual_mean = mean_factor * quantile(std::move(means), share);
    reading.usual_rms = rms_factor * quantile(std::move(scatter), share);
    if (std::isfinite(reading.usual_rms) && std::isfinite(reading.gain)) out[i] = reading;
  }
  return out;
}

ReadingMeter::Readings ReadingMeter::result() const { return readings(kUsual, 1, 1); }

ReadingMeter::Readings ReadingMeter::steady() const { return readings(0.5, kOfHalf, kOfHalfRms); }

std::optional<ReadingMeter::Level> ReadingMeter::level() const {
  Level out;
  std::vector<double> scatter, away;
  for (std::size_t i = 0; i < n_; ++i) {
    std::vector<double> means, rms;
    for (const auto& block : blocks_)
      if (block[i].n >= kLeastInBlock) means.push_back(fit(block[i], 0, 0).mean);
    if (means.size() < kLeastBlocks) return std::nullopt;
    out.offsets.push_back(median_in_place(means));
    for (const auto& block : blocks_)
      if (block[i].n >= kLeastInBlock) rms.push_back(fit(block[i], out.offsets[i], 0).rms);
    scatter.push_back(median_in_place(rms));
  }
  std::vector<double> middle = out.offsets, near;
  const double median = median_in_place(middle);
  for (const double offset : out.offsets) away.push_back(std::abs(offset - median));
  const double away_all = median_in_place(away), noise = median_in_place(scatter);
  if (!(away_all * away_all > kOffsetsCount * (away_all * away_all + noise * noise))) return std::nullopt;
  for (const double offset : out.offsets)
    if (std::abs(offset - median) <= kNear * kOfNormal * away_all) near.push_back(offset);
  const auto n = static_cast<double>(near.size());
  double mean = 0, squares = 0;
  for (const double offset : near) mean += offset / n;
  for (const double offset : near) squares += (offset - mean) * (offset - mean);
  for (double& offset : out.offsets) offset -= mean;
  out.sd = std::sqrt(squares / (n * (n - 1))) * student_quantile(0.975, n - 1) / kNormal95;
  return out;
}

bool ReadingMeter::beyond(const Fit& block, const LearntSensor::Reading& usual, bool quieter) {
  return std::abs(block.mean) > std::max(kBeyondUsual * usual.usual_mean, kBeyondNoise * usual.usual_rms) ||
         block.rms > kLouder * usual.usual_rms || (quieter && block.rms * kLouder < usual.usual_rms);
}

// Outliers put single blocks of any sensor beyond: so many in a row are more than those of the middle sensor do by
// chance, in all sensors together.
std::int64_t ReadingMeter::least_in_a_row(const Readings& learnt, bool quieter) const {
  constexpr double kByChance = 1e-3;
  std::vector<double> begun;
  for (std::size_t i = 0; i < std::min(n_, learnt.size()); ++i) {
    if (!learnt[i]) continue;
    double times = 0;
    bool before = false;
    for (const auto& block : blocks_) {
      const Sums& s = block[i];
      const bool now = s.n >= kLeastInBlock && beyond(fit(s, learnt[i]->offset, learnt[i]->gain), *learnt[i], quieter);
      times += now && !before ? 1 : 0;
      before = now;
    }
    begun.push_back(times);
  }
  const double blocks = static_cast<double>(blocks_.size());
  const double chance = begun.empty() ? 0 : (median_in_place(begun) - 1) / blocks;
  if (!(chance > 0)) return 2;
  const double row = std::log(kByChance / (blocks * static_cast<double>(n_))) / std::log(chance);
  return std::max<std::int64_t>(2, clamped_whole<std::int64_t>(std::ceil(row)));
}

std::vector<ReadingMeter::Change> ReadingMeter::changes(const Readings& learnt, bool quieter) const {
  const std::int64_t least = least_in_a_row(learnt, quieter);
  std::vector<Change> out;
  for (std::size_t i = 0; i < std::min(n_, learnt.size()); ++i) {
    if (!learnt[i]) continue;
    const LearntSensor::Reading& usual = *learnt[i];
    Change one{i, 0, 1, 0, 0, false}, row = one;  // of those in a row
    std::int64_t in_a_row = 0, changed = 0, first = -1, last = 0;
    for (std::size_t k = 0; k < blocks_.size(); ++k) {
      const Sums& s = blocks_[k][i];
      if (s.n < kLeastInBlock) continue;
      const Fit here = fit(s, usual.offset, usual.gain);
      if (!beyond(here, usual, quieter)) {
        in_a_row = 0;
        continue;
      }
      if (in_a_row++ == 0) row = {i, 0, 1, static_cast<std::int64_t>(k), 0, false};
      if (std::abs(here.mean) > std::abs(row.offset)) row.offset = here.mean;
      if (usual.usual_rms > 0) row.scatter = less_usual(row.scatter, here.rms / usual.usual_rms);
      if (in_a_row < least) continue;
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
  return own_changes(std::move(out), learnt);
}

namespace {

/// "g1: up to 5 deg/s off, 12 times its scatter, from 4 min to the end"
std::string change_text(const ReadingMeter::Change& change, const std::vector<std::string>& names,
                        const std::vector<std::string>& units, const Clock& clock) {
  const auto at = [&](std::int64_t instant) {
    return duration_text(clock.start_s + static_cast<double>(instant) / clock.rate_hz);
  };
  const std::string& unit = units[change.sensor];
  return fmt::format("{}: up to {}{}{} off, {} times its scatter, from {} to {}", printable(names[change.sensor], 40),
                     brief_text(change.offset, 2), unit.empty() ? "" : " ", unit, brief_text(change.scatter, 2),
                     change.from == 0 ? std::string("the start") : at(change.from),
                     change.to_end ? std::string("the end") : at(change.to));
}

/// How far a value is from others that are as scattered as these, over what chance does in an array in 300: by their
/// deviation (Student's t of one left out), and of many by their median deviation, so that several may stand apart.
/// `usual_sd`: what sound sensors scatter by counts as three more of them; 0: nothing is known of that.
double apart_from(std::vector<double> others, double value, double usual_sd) {
  constexpr std::size_t kMany = 8;
  constexpr double kOfMedian = 10;
  const auto n = static_cast<double>(others.size());
  double mean = 0, squares = 0;
  for (const double other : others) mean += other / n;
  for (const double other : others) squares += (other - mean) * (other - mean);
  const double more = usual_sd > 0 ? 3 : 0, dof = n - 1 + more;
  const double sd = std::sqrt((squares + more * usual_sd * usual_sd) / dof * (1 + 1 / n));
  const double limit = student_quantile(1 - kFalseAlarm / (2 * (n + 1)), dof);
  const double by_sd = (value - mean) / (limit * sd);
  if (others.size() < kMany) return by_sd;
  const double middle = median_in_place(others);
  for (double& other : others) other = std::abs(other - middle);
  const double by_median = (value - middle) / (kOfMedian * kOfNormal * median_in_place(others));
  return std::abs(by_median) > std::abs(by_sd) ? by_median : by_sd;
}

/// Of each value, beyond 1 in magnitude: it stands apart, and by `least` at least; 0: unknown.
std::vector<double> apart(const std::vector<std::optional<double>>& values, double least, double usual_sd) {
  std::vector<double> out(values.size());
  for (std::size_t i = 0; i < values.size(); ++i) {
    std::vector<double> others;
    for (std::size_t j = 0; j < values.size(); ++j)
      if (j != i && values[j]) others.push_back(*values[j]);
    if (!values[i] || others.size() < 2) continue;
    const double away = (*values[i] - median_in_place(others)) / least;
    const double by_chance = apart_from(std::move(others), *values[i], usual_sd);
    out[i] = std::abs(by_chance) < std::abs(away) ? by_chance : away;
  }
  return out;
}

struct ApartSensor {
  std::string name, unit;
  double offset = 0, gain = 0, noise = 0;  ///< beyond 1 in magnitude: it stands apart by that
};

/// What is said of one sensor.
std::string apart_text(const ApartSensor& sensor, const LearntSensor::Reading& reading) {
  std::vector<std::string> what;
  if (std::abs(sensor.gain) > 1) what.push_back(fmt::format("gain {}", brief_text(1 + reading.gain, 3)));
  if (std::abs(sensor.offset) > 1)
    what.push_back(
        fmt::format("offset {}{}{}", brief_text(reading.offset, 2), sensor.unit.empty() ? "" : " ", sensor.unit));
  if (sensor.noise > 1) what.push_back(fmt::format("noise {}", brief_text(reading.usual_rms, 2)));
  return fmt::format("{}: {}", printable(sensor.name, 40), fmt::join(what, ", "));
}

void warn_of_apart(const ReadingMeter::Readings& steady, const std::vector<std::string>& names,
                   const std::vector<std::string>& units, Findings& warnings) {
  std::vector<std::optional<double>> offset, gain, noise;
  std::vector<double> rms;
  for (const auto& one : steady) {
    offset.push_back(one ? std::optional(one->offset) : std::nullopt);
    gain.push_back(one ? std::optional(one->gain) : std::nullopt);
    noise.push_back(one && one->usual_rms > 0 ? std::optional(std::log(one->usual_rms)) : std::nullopt);
    if (one) rms.push_back(one->usual_rms);
  }
  if (rms.size() < 3) return;
  const double usual = median_in_place(rms);
  const std::vector<double> offsets = apart(offset, kLeastOffset * usual, 0),
                            gains = apart(gain, kLeastGain, kUsualGain),
                            levels = apart(noise, kLeastLouder, kUsualLevel);
  for (std::size_t i = 0; i < steady.size(); ++i) {
    const ApartSensor one{names[i], units[i], offsets[i], gains[i], levels[i]};
    if (std::abs(one.offset) > 1 || std::abs(one.gain) > 1 || one.noise > 1)
      warnings.add("sensor_apart", "sensors read otherwise than all others, throughout", apart_text(one, *steady[i]));
  }
}

}  // namespace

void warn_of_readings(const ReadingMeter& meter, const std::vector<std::string>& names,
                      const std::vector<std::string>& units, const Clock& clock, const std::vector<TakenOut>& taken_out,
                      Findings& warnings) {
  ReadingMeter::Readings steady = meter.steady();
  std::vector<ReadingMeter::Change> changes = meter.changes(steady, true);
  // Where most change it is what they see that does: motion, and how the sensors differ in it.
  if (2 * changes.size() > steady.size()) changes.clear();
  for (const ReadingMeter::Change& change : changes)
    warnings.add("sensor_failing", "sensors read otherwise, relative to the others, than for most of the run",
                 change_text(change, names, units, clock));
  for (std::size_t i = 0; i < steady.size(); ++i)
    if (steady[i]) {
      steady[i]->offset += taken_out[i].offset;
      steady[i]->gain += taken_out[i].gain;
    }
  warn_of_apart(steady, names, units, warnings);
}

void warn_of_changes(const std::vector<ReadingMeter::Change>& changes, const std::vector<std::string>& names,
                     const std::vector<std::string>& units, const Clock& clock, Findings& warnings) {
  for (const ReadingMeter::Change& change : changes)
    warnings.add("sensor_changed",
                 "sensors read otherwise, relative to the others, than where this was learnt: weights and standard "
                 "deviations of there do not fit",
                 change_text(change, names, units, clock));
}

}  // namespace libchar::detail
