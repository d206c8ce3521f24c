#pragma once
// The fault rule of [RV 4.34], mended: a fast second moment about ZERO of each channel's residual
// (a calibrated channel has zero mean, so a lasting bias stays visible), compared with what the
// channel's own variance leaves in the residual (one threshold a channel, not 2 max v for all). The
// worst channel is taken out first; it comes in again when its moment has been below the threshold
// for the whole recovery time.
//
//   m_i <- m_i + a (r_i^2 - m_i),  out when m_i > threshold x (v_i - V),  V = 1 / sum 1/v
//   while out:  e_i = y_i - x,  in again when m_i < threshold x (v_i + V) for `recovery` instants
//   on end

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
      : options_(options), gain_(1 - options.gamma), moment_(n, -1), out_(n, 0), calm_(n, 0) {}

  bool out(std::size_t i) const { return out_[i] != 0; }
  int count_out() const { return count_out_; }

  /// Takes in a residual; true when the moment is beyond the threshold.
  bool beyond(std::size_t i, double residual, double expectation) {
    double& m = moment_[i];
    m = m < 0 ? expectation : m;
    m += gain_ * (residual * residual - m);
    return m > options_.threshold * expectation;
  }
  double moment(std::size_t i) const { return moment_[i]; }
  void take_out(std::size_t i, std::int64_t sample) {
    out_[i] = 1;
    calm_[i] = 0;
    ++count_out_;
    log_.note({sample, static_cast<int>(i), true});
  }
  /// What the others have seen was the fault of another: they start anew.
  void forget(std::size_t i) { moment_[i] = -1; }
  /// A channel that is out: true when it may come in again.
  bool calmed(std::size_t i, double residual, double expectation) {
    const bool calm = !beyond(i, residual, expectation);
    // However bad it has been: what counts is how long ago.
    moment_[i] = std::min(moment_[i], 2 * options_.threshold * expectation);
    calm_[i] = calm ? calm_[i] + 1 : 0;
    return calm_[i] >= options_.recovery;
  }
  void let_in(std::size_t i, std::int64_t sample) {
    out_[i] = 0;
    --count_out_;
    forget(i);
    log_.note({sample, static_cast<int>(i), false});
  }
  const FaultLog& log() const { return log_; }

 private:
  FaultWatchOptions options_;
  double gain_;
  std::vector<double> moment_;  // negative: not begun
  std::vector<char> out_;
  std::vector<std::int64_t> calm_;
  int count_out_ = 0;
  FaultLog log_;
};

}  // namespace libchar::fusion
