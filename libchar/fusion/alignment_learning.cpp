// Learning an alignment. With z the samples as aligned so far and x their mean (blind: its noise is
// shared by all, and by Gauss-Markov hardly correlated with z - x) or the reference (with a reference):
//   e_i = z_i - x = b0 + g (x - x0) + sum_k m_k (c_k - c0_k) - d dz_i/dd + noise
// is solved for each channel, put on top of what is known, and repeated. Interpolation between two samples smooths
// white noise, and least squares would be rewarded for half a sample: the equation of the delay is therefore taken with
// an instrument, the slope of what does not hold the channel's own noise (sum slope e = 0): that of the reference, or
// of the mean of the other channels. What noise they share with e (blind: their parts of x) is taken out, v_j sum h
// h' / (n (n - 1)), h the taps of a channel and h' their derivative, v_j by the sixth difference of e.
// Blind, and where aliased vibration is more than noise (neighbours in e have opposite signs), interpolation
// is there to damp it: least squares on the own slope and its second derivative (Newton) find the smallest rest.
// Blind, noise v_i of the channels in x is taken out of both sides (errors in variables):
//   sum x^2 - rows mean(v)/n,   sum e_i x - rows (v_i - mean(v))/n,   v by MINQUE of the residuals.
// Delays start from the peak of the correlation below a tenth of the rate, within 8 samples; where it lies at
// their end, or there is none, within twice as many. Normal equations of centred regressors scaled to one.
// In the end the gauge is that of the channels that do not stand apart from the others (standing_apart.hpp).
// Standard errors: delete-one jackknife over stretches.
#include "libchar/fusion/alignment_learning.hpp"

#include <fmt/format.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <utility>

#include "libchar/core/numeric/dense.hpp"
#include "libchar/core/numeric/median.hpp"
#include "libchar/core/numeric/standing_apart.hpp"
#include "libchar/core/numeric/whole.hpp"
#include "libchar/core/refusal.hpp"
#include "libchar/core/text/readable.hpp"
#include "libchar/fusion/aligner.hpp"
#include "libchar/fusion/detail/alignment_samples.hpp"

namespace libchar::fusion {
namespace {

using Index = Eigen::Index;

constexpr Index kFewestInstants = 64;
constexpr int kIterations = 25;
constexpr double kDelayStep = 0.02;        // samples, of numerical derivatives
constexpr double kLargestDelayStep = 0.5;  // samples, of an iteration
constexpr double kSettled = 1e-6;
constexpr double kSeen = 4;             // power of x over that of its own noise, at least
constexpr double kLeastScale = 0.01;    // of a gain; deg read as rad are 0.0175 times what the others say
constexpr double kFarGain = 0.5;        // from one
constexpr double kLikeEnough = 0.5;     // correlation of the slow parts, at least
constexpr double kDoubtfulDelay = 0.5;  // samples of standard error
constexpr double kResolved = 3;         // standard errors that a delay is from zero, at least
constexpr double kBound = 2;            // standard errors beyond what was found, of a delay that is not resolved
constexpr double kEndOfSearch = 0.5;    // samples: nearer to it a delay is an end, no estimate
constexpr double kFirstReach = 8;       // samples of delay that are searched at first
constexpr double kSurelyLike = 0.8;     // correlation at which no longer search is made, and which it must find
constexpr double kMuchMoreLike = 0.1;   // than within a shorter search
constexpr double kInstantsPerLag = 40;  // at least, for a longer search: chance makes slow parts alike, too
constexpr Index kCorrelated = 1 << 16;  // instants that a longer search looks at, at most
constexpr double kQuarter = 0.25;       // samples: where the slope of the interpolator's noise is largest
constexpr double kMostShared = 0.1;
constexpr double kVibrates = -0.15;  // correlation of neighbours
constexpr double kSixth[] = {1, -6, 15, -20, 15, -6, 1};
constexpr double kUnknownValue = ChannelAlignment::kUnknown;

Refusal refusal(const std::string& what) {
  return numeric_error("E0911")
      .says("no alignment can be learnt: " + what)
      .hint("learn it on a stretch in which the sensors move and are there");
}

double correlation(const Eigen::VectorXd& a, const Eigen::VectorXd& b, Index lag) {
  double n = 0, sa = 0, sb = 0, aa = 0, bb = 0, ab = 0;
  const Index from = std::max<Index>(0, -lag), to = std::min(b.size(), a.size() - lag);
  double a0 = kUnknownValue, b0 = kUnknownValue;
  for (Index t = from; t < to; ++t) {
    double u = a(t + lag), v = b(t);
    if (!std::isfinite(u) || !std::isfinite(v)) continue;
    if (std::isnan(a0)) a0 = u, b0 = v;
    u -= a0;
    v -= b0;
    n += 1, sa += u, sb += v, aa += u * u, bb += v * v, ab += u * v;
  }
  const double va = aa - sa * sa / n, vb = bb - sb * sb / n;
  return n > 8 && va > 0 && vb > 0 ? (ab - sa * sb / n) / std::sqrt(va * vb) : 0;
}

/// The equations of one channel, a part a stretch of time.
struct Equations {
  std::vector<Eigen::MatrixXd> left;
  std::vector<Eigen::VectorXd> right;

  Eigen::VectorXd solve(std::size_t without) const {
    Eigen::MatrixXd a = Eigen::MatrixXd::Zero(left[0].rows(), left[0].cols());
    Eigen::VectorXd b = Eigen::VectorXd::Zero(a.rows());
    for (std::size_t k = 0; k < left.size(); ++k)
      if (k != without) {
        a += left[k];
        b += right[k];
      }
    Eigen::VectorXd scale(a.rows());
    for (Index j = 0; j < a.rows(); ++j) scale(j) = a(j, j) > 0 ? 1 / std::sqrt(a(j, j)) : 0;
    const Eigen::MatrixXd scaled = scale.asDiagonal() * a * scale.asDiagonal();
    // What says nothing beyond the other terms gets nothing.
    return scale.cwiseProduct(shortest_least_squares(scaled, scale.cwiseProduct(b), 1e-10).x);
  }

  std::size_t all() const { return left.size(); }
};

class Learner {
 public:
  Learner(const AlignmentData& data, const AlignmentOptions& options, double reach)
      : data_(data),
        options_(options),
        n_(data.channels),
        further_(data.samples.rows() / data.channels - 1),
        m_(data.samples.cols()),
        raw_(data.samples.transpose()) {
    delays_.reach = reach;
  }

  Alignment learn() {
    prepare();
    average_cross();
    find_truth_slope();
    start_gains();
    do {
      delays_.vibrates = blind() && options_.delay && vibrates();
      if (options_.delay) start_delays();
      choose_strictness();
      iterate();
      if (doubt_delays()) iterate();
    } while (leaves_unlike_out());
    level_gauge();
    tell();
    return out_;
  }

  /// A delay may lie beyond the search, and the stretch is long enough for twice of it.
  bool asks_for_more() const {
    const bool moves = !blind() || delays_.likest > kLikeEnough;
    return options_.delay && moves && (delays_.ends > 0 || delays_.least_like < kSurelyLike) &&
           2 * delays_.reach <= kMostDelay && static_cast<double>(out_.instants) > kInstantsPerLag * 2 * delays_.reach;
  }
  bool finds_more_than(const Learner& nearer) const {
    return delays_.ends < nearer.delays_.ends || delays_.least_like > nearer.delays_.least_like + kMuchMoreLike;
  }

 private:
  void prepare() {
    out_.interpolation = options_.interpolation;
    out_.channels.resize(static_cast<std::size_t>(n_));
    for (ChannelAlignment& channel : out_.channels) {
      channel.cross.assign(static_cast<std::size_t>(further_), 0);
      channel.cross_se.assign(static_cast<std::size_t>(further_), kUnknownValue);
    }
    interior_.assign(static_cast<std::size_t>(m_), false);
    const Index margin = kAlignmentMargin + static_cast<Index>(delays_.reach - kFirstReach);
    for (std::size_t s = 0; s < data_.starts.size(); ++s) {
      const Index end = s + 1 < data_.starts.size() ? data_.starts[s + 1] : m_;
      for (Index t = data_.starts[s] + margin; t < end - margin; ++t) interior_[static_cast<std::size_t>(t)] = true;
    }
    if (std::count(interior_.begin(), interior_.end(), true) < kFewestInstants)
      throw refusal("the stretch is too short").got("{} instants; {} are needed", m_, kFewestInstants + 2 * margin);
    for (Index c = 0; c < raw_.cols(); ++c) {
      out_.limits.push_back(limits_of(raw_.col(c)));
      for (Index t = 0; t < m_; ++t)
        if (!out_.limits.back().hold(raw_(t, c))) raw_(t, c) = kUnknownValue;
    }
    drop_wild(raw_.leftCols(n_));
    for (Index i = 0; i < n_; ++i) {
      const auto column = raw_.col(i).array();
      double low = std::numeric_limits<double>::infinity(), high = -low;
      for (Index t = 0; t < m_; ++t)
        if (std::isfinite(column(t))) low = std::min(low, column(t)), high = std::max(high, column(t));
      if (2 * column.isFinite().count() > m_ && high > low)
        used_.push_back(i);
      else
        out_.channels[static_cast<std::size_t>(i)].used = false;
    }
    if (used_.size() < (blind() ? 2U : 1U))
      throw refusal("too few sensors have samples that change").got("{} of {}", used_.size(), n_);
    if (used_.size() < static_cast<std::size_t>(n_))
      out_.notes.push_back(
          fmt::format("{} of {} sensors are constant or mostly missing within the stretch: left as they are",
                      static_cast<std::size_t>(n_) - used_.size(), n_));
    can_delay_.assign(used_.size(), false);
    residual_power_.resize(0);
  }

  void average_cross() {
    cross_.resize(m_, further_);
    if (further_ == 0) return;  // an empty matrix has no rows to point at
    for (Index t = 0; t < m_; ++t) {
      const Eigen::VectorXd column = raw_.row(t).transpose();
      Eigen::VectorXd means;
      cross_means(out_, column, means);
      cross_.row(t) = means.transpose();
    }
  }

  struct Lag {
    double likeness = 0, delay = 0;
  };

  /// The peak of the correlation with the others.
  Lag lag_of(const Eigen::VectorXd& own, const Eigen::VectorXd& others) const {
    const auto lags = static_cast<Index>(delays_.reach);
    const Index looked = delays_.reach > kFirstReach ? std::min(m_, kCorrelated) : m_, skipped = (m_ - looked) / 2;
    const Eigen::VectorXd a = own.segment(skipped, looked), b = others.segment(skipped, looked);
    Eigen::VectorXd like(2 * lags + 1);
    for (Index lag = -lags; lag <= lags; ++lag) like(lag + lags) = correlation(a, b, lag);
    Index best = 0;
    Lag out{like.maxCoeff(&best), static_cast<double>(best - lags)};
    if (best > 0 && best < 2 * lags) {
      const double bend = like(best - 1) - 2 * like(best) + like(best + 1);
      if (bend < 0) out.delay += 0.5 * (like(best - 1) - like(best + 1)) / bend;
    }
    return out;
  }

  bool is_like(const Lag& lag) const {
    return lag.likeness > (delays_.reach > kFirstReach ? kSurelyLike : kLikeEnough);
  }

  void start_delay(std::size_t k, const Lag& lag) {
    can_delay_[k] = is_like(lag);
    delays_.least_like = k == 0 ? lag.likeness : std::min(delays_.least_like, lag.likeness);
    delays_.likest = k == 0 ? lag.likeness : std::max(delays_.likest, lag.likeness);
    if (can_delay_[k]) of(k).delay = std::clamp(lag.delay, -delays_.reach, delays_.reach);
  }

  /// Far apart, the mean of the others is like none: the first channel that most others are like.
  void start_from_one(const Eigen::MatrixXd& slow) {
    for (Index from = 0; from < slow.cols(); ++from) {
      std::vector<Lag> lags;
      for (Index k = 0; k < slow.cols(); ++k)
        lags.push_back(k == from ? Lag{1, 0} : lag_of(slow.col(k), slow.col(from)));
      const auto like = std::count_if(lags.begin(), lags.end(), [&](const Lag& lag) { return is_like(lag); });
      if (2 * like <= slow.cols()) continue;
      for (std::size_t k = 0; k < lags.size(); ++k) start_delay(k, lags[k]);
      return settle_gauge();
    }
  }

  // Correlations of the slow parts, where aliased vibration and noise say little.
  void start_delays() {
    Eigen::MatrixXd slow(m_, static_cast<Index>(used_.size()));
    for (std::size_t k = 0; k < used_.size(); ++k) slow.col(static_cast<Index>(k)) = low_passed(raw_.col(used_[k]));
    if (!blind()) {
      const Eigen::VectorXd truth = low_passed(data_.truth.transpose());
      for (std::size_t k = 0; k < used_.size(); ++k) start_delay(k, lag_of(slow.col(static_cast<Index>(k)), truth));
      return;
    }
    Eigen::MatrixXd moved = slow;
    const auto move = [&](std::size_t k) {
      const DelayTaps taps(of(k).delay, Interpolation::cubic);
      const auto column = static_cast<Index>(k);
      for (Index t = 0; t < m_; ++t) moved(t, column) = taps.at(slow.col(column).data(), 1, m_, t);
    };
    if (delays_.reach > kFirstReach) start_from_one(slow);
    for (std::size_t k = 0; k < used_.size(); ++k) move(k);
    // Each in turn: of two sensors that are moved at once either goes to where the other was.
    for (int round = 0; round < 4; ++round) {
      for (std::size_t k = 0; k < used_.size(); ++k) {
        const auto column = static_cast<Index>(k);
        const Eigen::VectorXd others =
            (moved.rowwise().sum() - moved.col(column)) / static_cast<double>(moved.cols() - 1);
        start_delay(k, lag_of(slow.col(column), others));
        move(k);
      }
      settle_gauge();
      for (std::size_t k = 0; k < used_.size(); ++k) move(k);
    }
  }

  // Interpolation beside a gap or a saturated stretch bends the result; with gaps everywhere there is nothing else.
  void choose_strictness() {
    realign();
    Index complete = 0;
    for (Index t = 0; t < m_; ++t)
      if (interior_[static_cast<std::size_t>(t)] && z_.row(t).allFinite()) ++complete;
    strict_ = complete > std::max(kFewestInstants, m_ / 10);
  }

  void iterate() {
    for (int k = 0; k < kIterations; ++k)
      if (step() < kSettled) break;
    keep_errors();
  }

  void realign() {
    const auto n = static_cast<Index>(used_.size());
    z_.resize(m_, n);
    slope_.resize(m_, n);
    delays_.bend.resize(delays_.vibrates ? m_ : 0, n);
    for (Index k = 0; k < n; ++k) {
      const ChannelAlignment& channel = of(static_cast<std::size_t>(k));
      const double* y = raw_.col(used_[static_cast<std::size_t>(k)]).data();
      const DelayTaps at(channel.delay, options_.interpolation);
      const DelayTaps later(channel.delay + kDelayStep, options_.interpolation);
      const DelayTaps earlier(channel.delay - kDelayStep, options_.interpolation);
      const bool moves = can_delay_[static_cast<std::size_t>(k)];
      for (Index t = 0; t < m_; ++t) {
        if (!interior_[static_cast<std::size_t>(t)]) continue;
        const double now = at.at(y, 1, m_, t, strict_);
        double value = now - channel.bias;
        for (Index a = 0; a < further_; ++a)
          if (const double c = channel.cross[static_cast<std::size_t>(a)]; c != 0) value -= c * cross_(t, a);
        z_(t, k) = value / (1 + channel.gain);
        if (!moves) continue;
        const double up = later.at(y, 1, m_, t, strict_), down = earlier.at(y, 1, m_, t, strict_);
        slope_(t, k) = (up - down) / (2 * kDelayStep) / (1 + channel.gain);
        if (delays_.vibrates)
          delays_.bend(t, k) = (up - 2 * now + down) / (kDelayStep * kDelayStep) / (1 + channel.gain);
        if (!std::isfinite(slope_(t, k))) z_(t, k) = kUnknownValue;
      }
    }
  }

  // Of the reference; nothing where it has values at few instants only.
  void find_truth_slope() {
    delays_.truth_slope.resize(0);
    if (blind() || !options_.delay) return;
    const Eigen::VectorXd truth = data_.truth.transpose();
    const DelayTaps later(kDelayStep, options_.interpolation), earlier(-kDelayStep, options_.interpolation);
    Eigen::VectorXd out = Eigen::VectorXd::Constant(m_, kUnknownValue);
    Index known = 0, there = 0;
    for (Index t = 0; t < m_; ++t) {
      if (!interior_[static_cast<std::size_t>(t)] || !std::isfinite(truth(t))) continue;
      ++there;
      out(t) = (later.at(truth.data(), 1, m_, t, true) - earlier.at(truth.data(), 1, m_, t, true)) / (2 * kDelayStep);
      known += std::isfinite(out(t)) ? 1 : 0;
    }
    if (2 * known > there) delays_.truth_slope = out;
  }

  void find_rows() {
    x_ = blind() ? Eigen::VectorXd(z_.rowwise().mean()) : Eigen::VectorXd(data_.truth.transpose());
    rows_.clear();
    for (Index t = 0; t < m_; ++t)
      if (interior_[static_cast<std::size_t>(t)] && std::isfinite(x_(t)) && z_.row(t).allFinite() &&
          (delays_.truth_slope.size() == 0 || std::isfinite(delays_.truth_slope(t))) &&
          (further_ == 0 || cross_.row(t).allFinite()))
        rows_.push_back(t);
    const auto rows = static_cast<Index>(rows_.size());
    if (rows < kFewestInstants)
      throw refusal("too few instants have samples of all sensors").got("{}; {} are needed", rows, kFewestInstants);
    out_.instants = rows;
    batches_ = static_cast<std::size_t>(std::clamp<Index>(rows / 40, 4, 30));
    x0_ = x_(rows_).mean();
    c0_ = cross_(rows_, Eigen::indexing::all).colwise().mean().transpose();
  }

  // Which terms can be told at all: the input, and the other axes, must stand above their own noise.
  void choose_terms() {
    const auto rows = static_cast<double>(rows_.size());
    const Eigen::VectorXd x = x_(rows_).array() - x0_;
    const double power = x.squaredNorm() / rows, n = static_cast<double>(used_.size());
    if (residual_power_.size() == 0) {
      residual_power_.resize(static_cast<Index>(used_.size()));
      for (Index k = 0; k < residual_power_.size(); ++k) {
        const Eigen::VectorXd e = z_(rows_, k) - x_(rows_);
        residual_power_(k) = (e.array() - e.mean()).square().mean();
      }
    }
    const double noise = blind() ? residual_power_.sum() / (n * (n - 1)) : 0;
    gain_ = options_.gain && power > kSeen * noise && power > 0;
    axes_.clear();
    for (Index a = 0; options_.misalignment && a < further_; ++a) {
      const Eigen::VectorXd c = cross_(rows_, a).array() - c0_(a);
      double spread = 0, count = 0;
      for (Index i = 0; i < n_; ++i)
        for (const Index t : rows_)
          if (const double d = raw_(t, (a + 1) * n_ + i) - cross_(t, a); std::isfinite(d)) spread += d * d, count += 1;
      const auto all = static_cast<double>(n_);
      if (c.squaredNorm() / rows > kSeen * spread / (count * all)) axes_.push_back(a);
    }
  }

  double step() {
    realign();
    find_rows();
    choose_terms();
    regressors_ = regressors();
    if (needs_white()) find_white();
    std::vector<Eigen::VectorXd> changes;
    Eigen::VectorXd power(static_cast<Index>(used_.size()));
    for (std::size_t k = 0; k < used_.size(); ++k) {
      const Equations system = equations(k);
      changes.push_back(system.solve(system.all()));
      power(static_cast<Index>(k)) = linear_residual(k).squaredNorm() / static_cast<double>(rows_.size());
    }
    residual_power_ = power;
    double largest = 0;
    for (std::size_t k = 0; k < used_.size(); ++k) largest = std::max(largest, update(k, changes[k]));
    settle_gauge();
    return largest;
  }

  // Adds a change of the terms to what is known; returns its size beside one.
  double update(std::size_t k, const Eigen::VectorXd& change) {
    ChannelAlignment& to = of(k);
    const double scale = 1 + to.gain, spread = std::sqrt(residual_power_(static_cast<Index>(k)));
    double bias = change(0), size = 0;
    Index next = 1;
    double gain = 0;
    if (gain_) {
      gain = change(next++);
      bias -= gain * x0_;
      size = std::max(size, std::abs(gain));
    }
    for (const Index a : axes_) {
      const double c = change(next++);
      to.cross[static_cast<std::size_t>(a)] += scale * c;
      bias -= c * c0_(a);
      size = std::max(size, std::abs(c));
    }
    if (options_.bias) {
      to.bias += scale * bias;
      if (spread > 0) size = std::max(size, std::abs(change(0)) / spread);
    }
    to.gain = std::max(scale * (1 + gain), kLeastScale) - 1;
    if (can_delay_[k]) {
      const double step = std::clamp(change(next), -kLargestDelayStep, kLargestDelayStep);
      to.delay = std::clamp(to.delay + step, -delays_.reach, delays_.reach);
      size = std::max(size, std::abs(step));
    }
    return size;
  }

  // Blind: the channels' mean is the truth.
  void settle_gauge() {
    if (!blind()) return;
    ChannelAlignment mean;
    mean.cross.assign(static_cast<std::size_t>(further_), 0);
    const auto n = static_cast<double>(used_.size());
    double late = 0;
    for (std::size_t k = 0; k < used_.size(); ++k) {
      if (can_delay_[k]) {
        mean.delay += of(k).delay;
        late += 1;
      }
      mean.bias += of(k).bias / n;
      mean.gain += of(k).gain / n;
      for (std::size_t a = 0; a < mean.cross.size(); ++a) mean.cross[a] += of(k).cross[a] / n;
    }
    for (std::size_t k = 0; k < used_.size(); ++k) {
      if (can_delay_[k]) of(k).delay = std::clamp(of(k).delay - mean.delay / late, -delays_.reach, delays_.reach);
      const double scale = (1 + of(k).gain) / (1 + mean.gain);
      of(k).gain = scale - 1;
      of(k).bias -= scale * mean.bias;
      for (std::size_t a = 0; a < mean.cross.size(); ++a) of(k).cross[a] -= scale * mean.cross[a];
    }
  }

  // In the end the input is that of most channels: what stands apart (a wrong unit, an offset of its own) does not move
  // the others.
  void level_gauge() {
    if (!blind() || used_.size() < 3) return;
    const double gain = centre([&](std::size_t k) { return of(k).gain; });
    for (std::size_t k = 0; k < used_.size(); ++k) {
      of(k).gain = (1 + of(k).gain) / (1 + gain) - 1;
      of(k).gain_se /= 1 + gain;
    }
    x0_ *= 1 + gain;
    if (!options_.bias) return;
    const double bias = centre([&](std::size_t k) { return of(k).bias + of(k).gain * x0_; });
    for (std::size_t k = 0; k < used_.size(); ++k) of(k).bias -= (1 + of(k).gain) * bias;
  }

  template <typename Value>
  double centre(const Value& value) const {
    std::vector<double> values;
    for (std::size_t k = 0; k < used_.size(); ++k) values.push_back(value(k));
    const std::vector<bool> apart = detail::standing_apart(values);
    double mean = 0, n = 0;
    for (std::size_t k = 0; k < values.size(); ++k)
      if (!apart[k]) n += 1, mean += (values[k] - mean) / n;
    return mean;
  }

  // Blind, the mean is the input of none where one channel has another unit or sign: those that stand apart beside the
  // median start from what they are beside it.
  void start_gains() {
    if (!blind() || !options_.gain || used_.size() < 3) return;
    const auto n = static_cast<Index>(used_.size());
    std::vector<double> row(used_.size()), slopes;
    Eigen::ArrayXd middle = Eigen::ArrayXd::Constant(m_, kUnknownValue);
    for (Index t = 0; t < m_; ++t) {
      for (Index k = 0; k < n; ++k) row[static_cast<std::size_t>(k)] = raw_(t, used_[static_cast<std::size_t>(k)]);
      if (std::all_of(row.begin(), row.end(), [](double y) { return std::isfinite(y); }))
        middle(t) = median_in_place(row);
    }
    std::vector<Index> rows;
    for (Index t = 0; t < m_; ++t)
      if (std::isfinite(middle(t))) rows.push_back(t);
    if (static_cast<Index>(rows.size()) < kFewestInstants) return;
    const double level = middle(rows).mean();
    const Eigen::ArrayXd u = middle(rows) - level;
    const auto mean_of = [&](std::size_t k) { return raw_.col(used_[k])(rows).mean(); };
    for (std::size_t k = 0; k < used_.size(); ++k)
      slopes.push_back(((raw_.col(used_[k])(rows).array() - mean_of(k)) * u).sum() / u.square().sum());
    const std::vector<bool> apart = detail::standing_apart(slopes);
    for (std::size_t k = 0; k < used_.size(); ++k) {
      if (!apart[k] || std::abs(slopes[k] - 1) < kFarGain) continue;
      of(k).gain = std::max(slopes[k], kLeastScale) - 1;
      if (options_.bias) of(k).bias = mean_of(k) - slopes[k] * level;
    }
    leaves_unlike_out();
  }

  bool follows(std::size_t k) { return 1 + of(k).gain > 1.001 * kLeastScale; }

  // A gain at the least one that is searched is no estimate: its channel has another sign, or does not see the input.
  bool leaves_unlike_out() {
    std::vector<Index> left;
    for (std::size_t k = 0; k < used_.size(); ++k)
      if (follows(k)) left.push_back(used_[k]);
    if (left.size() == used_.size() || left.size() < (blind() ? 2U : 1U)) return false;
    out_.notes.push_back(
        fmt::format("{} of {} sensors do not follow the input, or with the other sign: left as they are",
                    used_.size() - left.size(), n_));
    for (std::size_t k = 0; k < used_.size(); ++k) {
      ChannelAlignment nominal;
      nominal.cross.assign(static_cast<std::size_t>(further_), 0);
      nominal.cross_se.assign(static_cast<std::size_t>(further_), kUnknownValue);
      nominal.used = follows(k);
      of(k) = nominal;
    }
    used_ = std::move(left);
    can_delay_.assign(used_.size(), false);
    residual_power_.resize(0);
    delays_.bounds.clear();
    delays_.ends = 0;
    return true;
  }

  // The spread of what the equations say when each stretch in turn is left out.
  void keep_errors() {
    realign();
    find_rows();
    regressors_ = regressors();
    if (needs_white()) find_white();
    for (std::size_t k = 0; k < used_.size(); ++k) {
      const Equations system = equations(k);
      const auto count = static_cast<double>(system.all());
      Eigen::MatrixXd without(system.left[0].rows(), static_cast<Index>(system.all()));
      for (std::size_t b = 0; b < system.all(); ++b) without.col(static_cast<Index>(b)) = system.solve(b);
      // The bias is the one at x = 0, not at the middle of the stretch.
      if (gain_) without.row(0) -= x0_ * without.row(1);
      for (std::size_t a = 0; a < axes_.size(); ++a)
        without.row(0) -= c0_(axes_[a]) * without.row(static_cast<Index>(a) + (gain_ ? 2 : 1));
      const Eigen::VectorXd se =
          ((without.colwise() - without.rowwise().mean()).rowwise().squaredNorm() * (count - 1) / count).cwiseSqrt();
      ChannelAlignment& to = of(k);
      const double scale = 1 + to.gain;
      Index next = 1;
      to.bias_se = options_.bias ? scale * se(0) : kUnknownValue;
      to.gain_se = gain_ ? scale * se(next++) : kUnknownValue;
      to.cross_se.assign(static_cast<std::size_t>(further_), kUnknownValue);
      for (const Index a : axes_) to.cross_se[static_cast<std::size_t>(a)] = scale * se(next++);
      to.delay_se = can_delay_[k] && outweighs_noise(system) ? se(next) : kUnknownValue;
    }
  }

  bool needs_white() const {
    return delays_.truth_slope.size() == 0 && !delays_.vibrates &&
           std::find(can_delay_.begin(), can_delay_.end(), true) != can_delay_.end();
  }

  enum class Delay { resolved, within_its_error, unknown, end };

  Delay delay_of(std::size_t k) const {
    const ChannelAlignment& channel = out_.channels[static_cast<std::size_t>(used_[k])];
    if (std::abs(channel.delay) > delays_.reach - kEndOfSearch) return Delay::end;
    if (!(channel.delay_se > 0 && channel.delay_se < kDoubtfulDelay)) return Delay::unknown;
    return std::abs(channel.delay) > kResolved * channel.delay_se ? Delay::resolved : Delay::within_its_error;
  }

  // A delay that is known to no better than half a sample is none, nor one that is not resolved from zero, nor the end
  // of the search. Blind, delays are differences: those that are within their errors go together, or stay.
  bool doubt_delays() {
    bool doubted = false, any = false;
    for (std::size_t k = 0; k < used_.size(); ++k) any = any || (can_delay_[k] && delay_of(k) == Delay::resolved);
    for (std::size_t k = 0; k < used_.size(); ++k) {
      if (!can_delay_[k]) continue;
      ChannelAlignment& channel = of(k);
      const Delay is = delay_of(k);
      if (is == Delay::resolved || (is == Delay::within_its_error && blind() && any)) continue;
      if (is == Delay::end) ++delays_.ends;
      if (is == Delay::within_its_error) delays_.bounds.push_back(std::abs(channel.delay) + kBound * channel.delay_se);
      can_delay_[k] = false;
      channel.delay = 0;
      doubted = true;
    }
    return doubted;
  }

  void tell() {
    const auto note = [&](const std::string& text) { out_.notes.push_back(text); };
    std::size_t still = 0;
    for (std::size_t k = 0; k < used_.size(); ++k) still += can_delay_[k] ? 0 : 1;
    still -= std::min(still, delays_.bounds.size() + delays_.ends);
    if (options_.delay && still > 0)
      note(fmt::format("the delay of {} of {} sensors cannot be estimated from this stretch: left at zero", still,
                       used_.size()));
    if (!delays_.bounds.empty())
      note(fmt::format("the delay of {} of {} sensors is not distinguishable from zero: at most {} samples (95 %)",
                       delays_.bounds.size(), used_.size(),
                       brief_text(*std::max_element(delays_.bounds.begin(), delays_.bounds.end()), 2)));
    if (delays_.ends > 0)
      note(fmt::format("the delay of {} of {} sensors may be beyond the {} samples that are searched: left at zero",
                       delays_.ends, used_.size(), delays_.reach));
    if (options_.gain && !gain_) note("the input hardly moves within the stretch: gains are left at one");
    if (options_.misalignment && axes_.size() < static_cast<std::size_t>(further_))
      note(fmt::format("{} of {} other axes hardly move within the stretch: misalignment with them is not estimated",
                       static_cast<std::size_t>(further_) - axes_.size(), further_));
  }

  Equations equations(std::size_t k) {
    const auto column = static_cast<Index>(k);
    const Eigen::VectorXd e = z_(rows_, column) - x_(rows_);
    const Index linear = terms(), all = linear + (can_delay_[k] ? 1 : 0);
    Eigen::VectorXd slope, lead;
    if (can_delay_[k]) {
      slope = slope_(rows_, column);
      lead = instrument(column);
    }
    Equations out;
    const auto rows = static_cast<Index>(rows_.size());
    for (std::size_t b = 0; b < batches_; ++b) {
      const Index from = rows * static_cast<Index>(b) / static_cast<Index>(batches_);
      const Index size = rows * static_cast<Index>(b + 1) / static_cast<Index>(batches_) - from;
      Eigen::MatrixXd part(size, all), with(size, all);
      part.leftCols(linear) = with.leftCols(linear) = regressors_.middleRows(from, size);
      if (can_delay_[k]) {
        part.col(linear) = -slope.segment(from, size);
        with.col(linear) = -lead.segment(from, size);
      }
      out.left.push_back(with.transpose() * part);
      out.right.push_back(with.transpose() * e.segment(from, size));
    }
    correct_for_noise(k, out);
    if (can_delay_[k] && delays_.vibrates) bend_delay(k, slope, out);
    if (can_delay_[k] && !delays_.vibrates) correct_delay(column, out);
    return out;
  }

  // What the slope of a channel's own interpolation is replaced by.
  Eigen::VectorXd instrument(Index column) const {
    if (delays_.truth_slope.size() > 0) return delays_.truth_slope(rows_);
    if (!blind() || delays_.vibrates) return slope_(rows_, column);
    Eigen::VectorXd out = Eigen::VectorXd::Zero(static_cast<Index>(rows_.size()));
    for (Index k = 0; k < z_.cols(); ++k)
      if (k != column) out += slope_(rows_, k);
    return out / static_cast<double>(z_.cols() - 1);
  }

  // Neighbouring samples of what the channels differ by have opposite signs: aliased vibration, of which there is more
  // than white noise.
  bool vibrates() const {
    const auto n = static_cast<Index>(used_.size());
    Eigen::VectorXd mean = Eigen::VectorXd::Zero(m_);
    for (const Index i : used_) mean += raw_.col(i) / static_cast<double>(n);
    double sum = 0;
    for (const Index i : used_) sum += neighbours(raw_.col(i) - mean);
    return sum < kVibrates * static_cast<double>(n);
  }

  static double neighbours(const Eigen::VectorXd& e) {
    return correlation(e.tail(e.size() - 1), e.head(e.size() - 1), 0);
  }

  // Where vibration is damped by interpolation the best delay is that of the smallest rest: Newton, by its curvature.
  void bend_delay(std::size_t k, const Eigen::VectorXd& slope, Equations& to) const {
    const Eigen::VectorXd left_over = linear_residual(k), bend = delays_.bend(rows_, static_cast<Index>(k));
    const double steep = slope.squaredNorm();
    if (!(steep + left_over.dot(bend) > 0.05 * steep)) return;
    const auto rows = static_cast<Index>(rows_.size());
    for (std::size_t b = 0; b < batches_; ++b) {
      const Index from = rows * static_cast<Index>(b) / static_cast<Index>(batches_);
      const Index size = rows * static_cast<Index>(b + 1) / static_cast<Index>(batches_) - from;
      to.left[b].bottomRightCorner(1, 1).array() += left_over.segment(from, size).dot(bend.segment(from, size));
    }
  }

  // Noise that the instrument shares with e, on the right, and with the slope, on the left.
  void correct_delay(Index column, Equations& to) const {
    if (delays_.truth_slope.size() > 0) return;
    const auto n = static_cast<double>(used_.size());
    double right = 0, left = 0;
    if (blind()) {
      for (Index k = 0; k < z_.cols(); ++k)
        if (k != column) right -= delays_.white(k) * noise_gain(k).along / (n * (n - 1));
    } else {
      right = delays_.white(column) * noise_gain(column).along;
      left = -delays_.white(column) * noise_gain(column).slopes;
    }
    for (std::size_t b = 0; b < to.left.size(); ++b) {
      const double rows = to.left[b](0, 0);
      to.right[b].tail(1).array() += rows * right;
      to.left[b].bottomRightCorner(1, 1).array() += rows * left;
    }
  }

  // Blind, on slow motion: what is taken out for shared noise must be small beside what the slopes say.
  bool outweighs_noise(const Equations& system) const {
    if (!blind() || delays_.vibrates) return true;
    const auto n = static_cast<double>(used_.size());
    double says = 0, rows = 0;
    for (const Eigen::MatrixXd& left : system.left) {
      says += left(left.rows() - 1, left.cols() - 1);
      rows += left(0, 0);
    }
    const double shared = delays_.white.sum() * std::abs(noise_gain(kQuarter).along) / (n * (n - 1));
    return says > 0 && rows * shared < kMostShared * says;
  }

  struct NoiseGain {
    double along = 0;   // of white noise: between interpolated samples and their slope
    double slopes = 0;  // of the slope
    double sixth = 0;   // of the sixth difference of interpolated samples
  };

  NoiseGain noise_gain(Index k) const {
    return noise_gain(out_.channels[static_cast<std::size_t>(used_[static_cast<std::size_t>(k)])].delay);
  }

  NoiseGain noise_gain(double delay) const {
    const std::ptrdiff_t origin = clamped_whole<std::ptrdiff_t>(std::floor(delay)) - 16;
    const auto spread = [&](double at) {
      const DelayTaps taps(at, options_.interpolation);
      Eigen::VectorXd out = Eigen::VectorXd::Zero(32);
      for (std::size_t w = 0; w < taps.weights.size(); ++w)
        out(taps.floor + taps.first + static_cast<std::ptrdiff_t>(w) - origin) = taps.weights[w];
      return out;
    };
    const Eigen::VectorXd now = spread(delay);
    const Eigen::VectorXd slope = (spread(delay + kDelayStep) - spread(delay - kDelayStep)) / (2 * kDelayStep);
    NoiseGain out{now.dot(slope), slope.squaredNorm(), 0};
    for (Index at = -6; at < now.size(); ++at) {
      double sum = 0;
      for (Index j = 0; j < 7; ++j)
        if (at + j >= 0 && at + j < now.size()) sum += kSixth[j] * now(at + j);
      out.sixth += sum * sum;
    }
    return out;
  }

  // White noise of each channel, from what the sixth difference leaves of e; blind by MINQUE, as all are in x.
  void find_white() {
    const auto n = static_cast<Index>(used_.size());
    Eigen::VectorXd power = Eigen::VectorXd::Zero(n);
    for (Index k = 0; k < n; ++k) {
      const Eigen::VectorXd e = z_.col(k) - x_;
      double count = 0;
      for (Index t = 0; t + 6 < m_; ++t) {
        if (!interior_[static_cast<std::size_t>(t)] || !interior_[static_cast<std::size_t>(t + 6)]) continue;
        double d = 0;
        for (Index j = 0; j < 7; ++j) d += kSixth[j] * e(t + j);
        if (std::isfinite(d)) power(k) += d * d, count += 1;
      }
      power(k) = count > 0 ? power(k) / count : 0;
    }
    const auto all = static_cast<double>(n);
    if (blind()) {
      const double sum = power.sum() * all / (all - 1);
      power = n > 2 ? Eigen::VectorXd(((power.array() - sum / (all * all)) / (1 - 2 / all)).max(0.0))
                    : Eigen::VectorXd::Constant(n, sum / all);
    }
    delays_.white.resize(n);
    for (Index k = 0; k < n; ++k) delays_.white(k) = power(k) / noise_gain(k).sixth;
  }

  void correct_for_noise(std::size_t k, Equations& to) const {
    if (!blind() || !gain_) return;
    const auto n = static_cast<double>(used_.size());
    const double sum = residual_power_.sum() * n / (n - 1);
    const double mean = sum / n;
    double own = mean;
    if (used_.size() > 2) own = std::max(0.0, (residual_power_(static_cast<Index>(k)) - sum / (n * n)) / (1 - 2 / n));
    for (std::size_t b = 0; b < to.left.size(); ++b) {
      const double rows = to.left[b](0, 0);
      to.left[b](1, 1) -= std::min(rows * mean / n, 0.5 * to.left[b](1, 1));
      to.right[b](1) -= rows * (own - mean) / n;
    }
  }

  Eigen::VectorXd linear_residual(std::size_t k) const {
    const Eigen::VectorXd e = z_(rows_, static_cast<Index>(k)) - x_(rows_);
    Equations whole;
    whole.left.push_back(regressors_.transpose() * regressors_);
    whole.right.push_back(regressors_.transpose() * e);
    return e - regressors_ * whole.solve(1);
  }

  Eigen::MatrixXd regressors() const {
    Eigen::MatrixXd out(static_cast<Index>(rows_.size()), terms());
    out.col(0).setOnes();
    Index next = 1;
    if (gain_) out.col(next++) = x_(rows_).array() - x0_;
    for (const Index a : axes_) out.col(next++) = cross_(rows_, a).array() - c0_(a);
    return out;
  }

  ChannelAlignment& of(std::size_t k) { return out_.channels[static_cast<std::size_t>(used_[k])]; }
  bool blind() const { return data_.truth.size() == 0; }
  Index terms() const { return 1 + (gain_ ? 1 : 0) + static_cast<Index>(axes_.size()); }

  const AlignmentData& data_;
  const AlignmentOptions& options_;
  Index n_, further_, m_;
  Alignment out_;
  std::vector<Index> used_;
  std::vector<bool> can_delay_;  // of `used_`
  std::vector<bool> interior_;   // of instants
  Eigen::MatrixXd raw_, cross_;  // a column a channel, an axis
  Eigen::MatrixXd z_, slope_;    // a column a used channel: aligned, and its derivative
  Eigen::VectorXd x_, residual_power_;
  struct {
    double reach = kFirstReach;         // samples that are searched
    bool vibrates = false;              // more than it is noisy
    Eigen::MatrixXd bend;               // second derivative of z_, where it vibrates
    Eigen::VectorXd truth_slope;        // empty: the reference does not tell it
    Eigen::VectorXd white;              // variance of the white noise of a used channel
    std::vector<double> bounds;         // of delays that are not resolved, in samples
    std::size_t ends = 0;               // delays at the end of the search
    double least_like = 0, likest = 0;  // of the channels' correlations with the others, each at its best lag
  } delays_;
  std::vector<Index> rows_;
  bool strict_ = true;  // samples whose interpolation misses a tap are left out
  bool gain_ = false;   // terms that the stretch tells
  std::vector<Index> axes_;
  double x0_ = 0;
  Eigen::VectorXd c0_;
  Eigen::MatrixXd regressors_;  // rows x terms
  std::size_t batches_ = 0;
};

}  // namespace

Alignment learn_alignment(const AlignmentData& data, const AlignmentOptions& options) {
  auto nearer = std::make_unique<Learner>(data, options, kFirstReach);
  Alignment out = nearer->learn();
  for (double reach = 2 * kFirstReach; nearer->asks_for_more(); reach *= 2) {
    auto further = std::make_unique<Learner>(data, options, reach);
    try {
      Alignment found = further->learn();
      if (further->finds_more_than(*nearer)) out = std::move(found);
    } catch (const Error&) {  // too little is left between the margins
      break;
    }
    nearer = std::move(further);
  }
  return out;
}

Index margin_of(const Alignment& alignment) {
  double most = kFirstReach;
  for (const ChannelAlignment& channel : alignment.channels) most = std::max(most, std::abs(channel.delay));
  return kAlignmentMargin + clamped_whole<Index>(std::ceil(most - kFirstReach));
}

}  // namespace libchar::fusion
