#pragma once
// The fault rule of [RV 4.34], mended: a fast second moment about ZERO of each channel's residual (a calibrated channel
// has zero mean, so a lasting bias stays visible), compared with what the channel's own variance leaves in the residual
// (one threshold a channel, not 2 max v for all). The worst channel is taken out first; it comes in again when its
// moment has been below the threshold for the whole recovery time.
//
//   m_i <- m_i + a (r_i^2 / (v_i - V) - m_i),  out when m_i > threshold,  V = 1 / sum 1/v
//   while out:  m_i of (y_i - x)^2 / (v_i + V), in again when m_i < threshold for `recovery` instants
//   on end
//
// What is expected changes with the set of channels: the ratio is kept, not the square.

#include <algorithm>
#include <cstdint>
#include <vector>

#include "libchar/fusion/fault_log.hpp"

namespace libchar::fusion {

struct FaultWatchOptions {
  double gamma = 0.99;           ///< memory of the second moment
  double threshold = 2;          ///< of the second moment, relative to its expectation
  std::int64_t recovery = 1000;  ///< instants
};

class FaultWatch {
 public:
  FaultWatch(std::size_t n, const FaultWatchOptions& options)
      : options_(options),
        gain_(1 - options.gamma),
        moment_(n, -1),
        out_(n, 0),
        calm_(n, 0),
        not_begun_(static_cast<int>(n)) {}

  bool out(std::size_t i) const { return out_[i] != 0; }
  int count_out() const { return count_out_; }

  /// Takes in the residuals of the m channels named in `index`; true when a moment is beyond its
  /// threshold. `expected`: of the squares, by channel, never taken for less than `least`.
  bool beyond(const double* residuals, const double* expected, double least, const int* index, int m) {
    for (int k = 0; not_begun_ > 0 && k < m; ++k) begin(index[k]);
    const double* __restrict const r = residuals;
    const double* __restrict const e = expected;
    double* __restrict const moment = moment_.data();
    const double gain = gain_, threshold = options_.threshold;
    // Two at a time, without branches.
    double over[2] = {-1, -1};
    const auto take_in = [&](int i, int lane) {
      const double expectation = e[i] > least ? e[i] : least;
      moment[i] += gain * (r[i] * r[i] / expectation - moment[i]);
      const double beyond = moment[i] - threshold;
      over[lane] = beyond > over[lane] ? beyond : over[lane];
    };
    if (m == static_cast<int>(moment_.size())) {
      int i = 0;
      for (; i + 2 <= m; i += 2)
        for (int lane = 0; lane < 2; ++lane) take_in(i + lane, lane);
      if (i < m) take_in(i, 0);
    } else {
      for (int k = 0; k < m; ++k) take_in(index[k], 0);
    }
    return over[0] > 0 || over[1] > 0;
  }
  /// The channel whose moment is the largest multiple of what is expected.
  int worst(const int* index, int m) const {
    double largest = 0;
    int where = index[0];
    for (int k = 0; k < m; ++k) {
      const double ratio = moment_[static_cast<std::size_t>(index[k])];
      if (ratio > largest) {
        largest = ratio;
        where = index[k];
      }
    }
    return where;
  }
  void take_out(std::size_t i, std::int64_t sample) {
    out_[i] = 1;
    calm_[i] = 0;
    ++count_out_;
    log_.note({sample, static_cast<int>(i), true, FaultRule::residual_moment});
  }
  /// What the others have seen was the fault of another: they start anew.
  void forget(std::size_t i) {
    if (!(moment_[i] < 0)) ++not_begun_;
    moment_[i] = -1;
  }
  /// A channel that is out: true when it may come in again.
  bool calmed(std::size_t i, double residual, double expectation) {
    begin(static_cast<int>(i));
    moment_[i] += gain_ * (residual * residual / expectation - moment_[i]);
    const bool calm = !(moment_[i] > options_.threshold);
    // However bad it has been: what counts is how long ago.
    moment_[i] = std::min(moment_[i], 2 * options_.threshold);
    calm_[i] = calm ? calm_[i] + 1 : 0;
    return calm_[i] >= options_.recovery;
  }
  void let_in(std::size_t i, std::int64_t sample) {
    out_[i] = 0;
    --count_out_;
    forget(i);
    log_.note({sample, static_cast<int>(i), false, FaultRule::residual_moment});
  }
  const FaultLog& log() const { return log_; }

 private:
  void begin(int i) {
    double& moment = moment_[static_cast<std::size_t>(i)];
    if (!(moment < 0)) return;
    moment = 1;
    --not_begun_;
  }

  FaultWatchOptions options_;
  double gain_;
  std::vector<double> moment_;  // negative: not begun
  std::vector<char> out_;
  std::vector<std::int64_t> calm_;
  int count_out_ = 0;
  int not_begun_;
  FaultLog log_;
};

}  // namespace libchar::fusion
