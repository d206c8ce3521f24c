// Learning an alignment. With z the samples as aligned so far and x their mean (blind: its noise is
// shared by all, and by Gauss-Markov hardly correlated with z - x) or the reference (with a reference):
//   e_i = z_i - x = b0 + g (x - x0) + sum_k m_k (c_k - c0_k) - d dz_i/dd + noise
// is solved for each channel, put on top of what is known, and repeated (Gauss-Newton; the delay,
// whose derivative is that of the interpolated samples, with its second derivative: Newton).
// Blind, noise v_i of the channels in x is taken out of both sides (errors in variables):
//   sum x^2 - rows mean(v)/n,   sum e_i x - rows (v_i - mean(v))/n,   v by MINQUE of the residuals.
// Delays start from the peak of the correlation below a tenth of the rate. Normal equations of
// centred regressors scaled to one. Standard errors: delete-one jackknife over stretches.
#include "libchar/fusion/alignment_learning.hpp"

#include <fmt/format.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>

#include "libchar/core/numeric/dense.hpp"
#include "libchar/core/refusal.hpp"
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
constexpr double kLikeEnough = 0.5;     // correlation of the slow parts, at least
constexpr double kDoubtfulDelay = 0.5;  // samples of standard error
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
  Learner(const AlignmentData& data, const AlignmentOptions& options)
      : data_(data),
        options_(options),
        n_(data.channels),
        further_(data.samples.rows() / data.channels - 1),
        m_(data.samples.cols()),
        raw_(data.samples.transpose()) {}

  Alignment learn() {
    prepare();
    average_cross();
    if (options_.delay) start_delays();
    choose_strictness();
    iterate();
    if (doubt_delays()) iterate();
    tell();
    return out_;
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
    for (std::size_t s = 0; s < data_.starts.size(); ++s) {
      const Index end = s + 1 < data_.starts.size() ? data_.starts[s + 1] : m_;
      for (Index t = data_.starts[s] + kAlignmentMargin; t < end - kAlignmentMargin; ++t)
        interior_[static_cast<std::size_t>(t)] = true;
    }
    if (std::count(interior_.begin(), interior_.end(), true) < kFewestInstants)
      throw refusal("the stretch is too short")
          .got("{} instants; {} are needed", m_, kFewestInstants + 2 * kAlignmentMargin);
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
        if (std::isfinite(column(t)))
          low = std::min(low, column(t)), high = std::max(high, column(t));
      if (2 * column.isFinite().count() > m_ && high > low)
        used_.push_back(i);
      else
        out_.channels[static_cast<std::size_t>(i)].used = false;
    }
    if (used_.size() < (blind() ? 2U : 1U))
      throw refusal("too few sensors have samples that change").got("{} of {}", used_.size(), n_);
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

  // Correlations of the slow parts, where aliased vibration and noise say little.
  void start_delays() {
    Eigen::MatrixXd slow(m_, static_cast<Index>(used_.size()));
    for (std::size_t k = 0; k < used_.size(); ++k)
      slow.col(static_cast<Index>(k)) = low_passed(raw_.col(used_[k]));
    Eigen::VectorXd truth;
    if (!blind()) truth = low_passed(data_.truth.transpose());
    Eigen::MatrixXd moved = slow;
    constexpr Index kLags = 8;
    for (int round = 0; round < 4; ++round) {
      for (std::size_t k = 0; k < used_.size(); ++k) {
        const auto column = static_cast<Index>(k);
        Eigen::VectorXd others = truth;
        if (blind())
          others =
              (moved.rowwise().sum() - moved.col(column)) / static_cast<double>(moved.cols() - 1);
        Eigen::VectorXd like(2 * kLags + 1);
        for (Index lag = -kLags; lag <= kLags; ++lag)
          like(lag + kLags) = correlation(slow.col(column), others, lag);
        Index best = 0;
        can_delay_[k] = like.maxCoeff(&best) > kLikeEnough;
        if (!can_delay_[k]) continue;
        double delay = static_cast<double>(best - kLags);
        if (best > 0 && best < 2 * kLags) {
          const double bend = like(best - 1) - 2 * like(best) + like(best + 1);
          if (bend < 0) delay += 0.5 * (like(best - 1) - like(best + 1)) / bend;
        }
        of(k).delay = std::clamp(delay, -kMostDelay, kMostDelay);
      }
      settle_gauge();
      for (std::size_t k = 0; k < used_.size(); ++k) {
        const DelayTaps taps(of(k).delay, Interpolation::cubic);
        const auto column = static_cast<Index>(k);
        for (Index t = 0; t < m_; ++t)
          moved(t, column) = taps.at(slow.col(column).data(), 1, m_, t);
      }
    }
  }

  // Interpolation beside a gap or a saturated stretch bends the result; with gaps everywhere there is
  // nothing else.
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
    bend_.resize(m_, n);
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
          if (const double c = channel.cross[static_cast<std::size_t>(a)]; c != 0)
            value -= c * cross_(t, a);
        z_(t, k) = value / (1 + channel.gain);
        if (!moves) continue;
        const double up = later.at(y, 1, m_, t, strict_), down = earlier.at(y, 1, m_, t, strict_);
        slope_(t, k) = (up - down) / (2 * kDelayStep) / (1 + channel.gain);
        bend_(t, k) = (up - 2 * now + down) / (kDelayStep * kDelayStep) / (1 + channel.gain);
        if (!std::isfinite(bend_(t, k))) z_(t, k) = kUnknownValue;
      }
    }
  }

  void find_rows() {
    x_ = blind() ? Eigen::VectorXd(z_.rowwise().mean()) : Eigen::VectorXd(data_.truth.transpose());
    rows_.clear();
    for (Index t = 0; t < m_; ++t)
      if (interior_[static_cast<std::size_t>(t)] && std::isfinite(x_(t)) && z_.row(t).allFinite() &&
          (further_ == 0 || cross_.row(t).allFinite()))
        rows_.push_back(t);
    const auto rows = static_cast<Index>(rows_.size());
    if (rows < kFewestInstants)
      throw refusal("too few instants have samples of all sensors")
          .got("{}; {} are needed", rows, kFewestInstants);
    out_.instants = rows;
    batches_ = static_cast<std::size_t>(std::clamp<Index>(rows / 40, 4, 30));
    x0_ = x_(rows_).mean();
    c0_ = cross_(rows_, Eigen::all).colwise().mean().transpose();
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
          if (const double d = raw_(t, (a + 1) * n_ + i) - cross_(t, a); std::isfinite(d))
            spread += d * d, count += 1;
      const auto all = static_cast<double>(n_);
      if (c.squaredNorm() / rows > kSeen * spread / (count * all)) axes_.push_back(a);
    }
  }

  double step() {
    realign();
    find_rows();
    choose_terms();
    regressors_ = regressors();
    std::vector<Eigen::VectorXd> changes;
    Eigen::VectorXd power(static_cast<Index>(used_.size()));
    for (std::size_t k = 0; k < used_.size(); ++k) {
      const Equations system = equations(k);
      changes.push_back(system.solve(system.all()));
      power(static_cast<Index>(k)) =
          linear_residual(k).squaredNorm() / static_cast<double>(rows_.size());
    }
    residual_power_ = power;
    double largest = 0;
    for (std::size_t k = 0; k < used_.size(); ++k)
      largest = std::max(largest, update(k, changes[k]));
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
    to.gain = std::max(scale * (1 + gain), 0.02) - 1;
    if (can_delay_[k]) {
      const double step = std::clamp(change(next), -kLargestDelayStep, kLargestDelayStep);
      to.delay = std::clamp(to.delay + step, -kMostDelay, kMostDelay);
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
    for (std::size_t k = 0; k < used_.size(); ++k) {
      mean.delay += of(k).delay / n;
      mean.bias += of(k).bias / n;
      mean.gain += of(k).gain / n;
      for (std::size_t a = 0; a < mean.cross.size(); ++a) mean.cross[a] += of(k).cross[a] / n;
    }
    for (std::size_t k = 0; k < used_.size(); ++k) {
      of(k).delay = std::clamp(of(k).delay - mean.delay, -kMostDelay, kMostDelay);
      of(k).bias -= mean.bias;
      of(k).gain = (1 + of(k).gain) / (1 + mean.gain) - 1;
      for (std::size_t a = 0; a < mean.cross.size(); ++a) of(k).cross[a] -= mean.cross[a];
    }
  }

  // The spread of what the equations say when each stretch in turn is left out.
  void keep_errors() {
    realign();
    find_rows();
    regressors_ = regressors();
    for (std::size_t k = 0; k < used_.size(); ++k) {
      const Equations system = equations(k);
      const auto count = static_cast<double>(system.all());
      Eigen::MatrixXd without(system.left[0].rows(), static_cast<Index>(system.all()));
      for (std::size_t b = 0; b < system.all(); ++b)
        without.col(static_cast<Index>(b)) = system.solve(b);
      // The bias is the one at x = 0, not at the middle of the stretch.
      if (gain_) without.row(0) -= x0_ * without.row(1);
      for (std::size_t a = 0; a < axes_.size(); ++a)
        without.row(0) -= c0_(axes_[a]) * without.row(static_cast<Index>(a) + (gain_ ? 2 : 1));
      const Eigen::VectorXd se =
          ((without.colwise() - without.rowwise().mean()).rowwise().squaredNorm() * (count - 1) /
           count)
              .cwiseSqrt();
      ChannelAlignment& to = of(k);
      const double scale = 1 + to.gain;
      Index next = 1;
      to.bias_se = options_.bias ? scale * se(0) : kUnknownValue;
      to.gain_se = gain_ ? scale * se(next++) : kUnknownValue;
      to.cross_se.assign(static_cast<std::size_t>(further_), kUnknownValue);
      for (const Index a : axes_) to.cross_se[static_cast<std::size_t>(a)] = scale * se(next++);
      to.delay_se = can_delay_[k] ? se(next) : kUnknownValue;
    }
  }

  // A delay that is known to no better than half a sample is none.
  bool doubt_delays() {
    bool doubted = false;
    for (std::size_t k = 0; k < used_.size(); ++k)
      if (can_delay_[k] && !(of(k).delay_se < kDoubtfulDelay)) {
        can_delay_[k] = false;
        of(k).delay = 0;
        doubted = true;
      }
    return doubted;
  }

  void tell() {
    const auto note = [&](const std::string& text) { out_.notes.push_back(text); };
    std::size_t still = 0;
    for (std::size_t k = 0; k < used_.size(); ++k) still += can_delay_[k] ? 0 : 1;
    if (options_.delay && still > 0)
      note(fmt::format("the stretch does not tell the delay of {} of {} sensors: left at zero",
                       still,
                       used_.size()));
    if (options_.gain && !gain_)
      note("the input hardly moves within the stretch: gains are left at one");
    if (options_.misalignment && axes_.size() < static_cast<std::size_t>(further_))
      note(
          fmt::format("{} of {} other axes hardly move within the stretch: no misalignment with "
                      "them is told",
                      static_cast<std::size_t>(further_) - axes_.size(),
                      further_));
    if (used_.size() < static_cast<std::size_t>(n_))
      note(
          fmt::format("{} of {} sensors are constant or mostly missing within the stretch: left as "
                      "they are",
                      static_cast<std::size_t>(n_) - used_.size(),
                      n_));
  }

  Equations equations(std::size_t k) {
    const auto column = static_cast<Index>(k);
    const Eigen::VectorXd e = z_(rows_, column) - x_(rows_), left_over = linear_residual(k);
    const Index linear = terms(), all = linear + (can_delay_[k] ? 1 : 0);
    Eigen::VectorXd slope, bend;
    bool curved = false;
    if (can_delay_[k]) {
      slope = slope_(rows_, column);
      bend = bend_(rows_, column);
      const double steep = slope.squaredNorm();
      curved = steep + left_over.dot(bend) > 0.05 * steep;
    }
    Equations out;
    const auto rows = static_cast<Index>(rows_.size());
    for (std::size_t b = 0; b < batches_; ++b) {
      const Index from = rows * static_cast<Index>(b) / static_cast<Index>(batches_);
      const Index size = rows * static_cast<Index>(b + 1) / static_cast<Index>(batches_) - from;
      Eigen::MatrixXd part(size, all);
      part.leftCols(linear) = regressors_.middleRows(from, size);
      if (can_delay_[k]) part.col(linear) = -slope.segment(from, size);
      out.left.push_back(part.transpose() * part);
      out.right.push_back(part.transpose() * e.segment(from, size));
      if (curved)
        out.left.back()(linear, linear) +=
            left_over.segment(from, size).dot(bend.segment(from, size));
    }
    correct_for_noise(k, out);
    return out;
  }

  void correct_for_noise(std::size_t k, Equations& to) const {
    if (!blind() || !gain_) return;
    const auto n = static_cast<double>(used_.size());
    const double sum = residual_power_.sum() * n / (n - 1);
    const double mean = sum / n;
    double own = mean;
    if (used_.size() > 2)
      own = std::max(0.0, (residual_power_(static_cast<Index>(k)) - sum / (n * n)) / (1 - 2 / n));
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
  std::vector<bool> can_delay_;       // of `used_`
  std::vector<bool> interior_;        // of instants
  Eigen::MatrixXd raw_, cross_;       // a column a channel, an axis
  Eigen::MatrixXd z_, slope_, bend_;  // a column a used channel: aligned, and its derivatives
  Eigen::VectorXd x_, residual_power_;
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
  return Learner(data, options).learn();
}

}  // namespace libchar::fusion
