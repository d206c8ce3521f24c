#pragma once
// A network that learnt from the reference, and the decision module that judges its output at each instant:
//   its inputs lie within the range that it learnt,
//   |x - baseline| <= a + 4 sqrt(V): V the baseline's variance, a the largest distance where the truth was known,
//   the mean of s_i = y_i - r_i(x) over the last 128 instants stays within what it was there, for each sensor:
//   r_i, a cubic, is what sensor i read at the true x, so s are the parity residuals of the network,
//   D, the mean of (x - baseline)^2 over the last 1024, is beyond the largest where the truth was known by less than
//   the network was better there: an input that the network has not learnt adds its error to D, and to its variance.
// `Teaching` makes one in slices: fit, then judgement on rows that the fit has not seen, by these rules: mean square
// error smaller than the baseline's by 6 %, by 2.5 standard errors of the difference over blocks, not larger on the
// last instants of the learning window; and smaller with nine times what the network would have aged since it learnt,
// sum a_i^2 m_i^2: m_i the mean of s_i on the held-out rows, a_i what a lasting offset of sensor i does to x.

#include <algorithm>
#include <limits>
#include <vector>

#include "libchar/fusion/detail/simplex/network_fit.hpp"
#include "libchar/fusion/detail/simplex/taught_rows.hpp"
#include "libchar/fusion/fault_log.hpp"
#include "libchar/fusion/learnt.hpp"

namespace libchar::fusion {

/// What the baseline says of an instant.
struct BaselineView {
  double x = 0, variance = 0;      ///< NaN: none
  const char* left_out = nullptr;  ///< of each sensor; nullptr: none is
};

struct NetworkLimits {
  std::vector<double> low, high;  ///< of the inputs
  double apart = 0;
  double away = 0;                                        ///< the largest D
  double gain = std::numeric_limits<double>::infinity();  ///< mean square error of the baseline less its own
  double centre = 0, unit = 1;                            ///< u = (x - centre) / unit
  std::vector<double> reading;                            ///< r_i = sum of four terms u^p, a row a sensor
  std::vector<double> deviation;                          ///< of s_i
  std::vector<double> drift;                              ///< largest mean of s_i / deviation
};

class TaughtNetwork {
 public:
  TaughtNetwork(std::size_t sensors, std::size_t lags, const TanhNetwork& shape);

  /// Its estimate of an instant; false: not to be given out, `reason()` says why.
  bool judge(const RecentPast& past, const double* y, const BaselineView& baseline);
  double x() const { return x_; }
  double variance() const { return net.held_out_square + std::max(0.0, away_ - limits.away); }
  HandOverReason reason() const { return reason_; }
  /// The sensor furthest beyond its limit; -1: none.
  int worst(const std::vector<char>& apart_from) const;
  /// It is as if it had been right all the time.
  void start_over();
  void exchange(LearntExchange& with);

  SensorSet set;
  FittedNetwork net;
  NetworkLimits limits;
  bool right = false;  ///< it passed its judgement

  /// s_i / deviation of all sensors in use into `s`.
  void parity(double x, const double* y, double* s) const;
  double estimate(const double* past, double* z) const;

 private:
  bool good(HandOverReason reason, bool passed);
  bool within(const double* z) const;
  bool consistent(const double* y);
  bool still_better(double baseline);

  std::vector<double> past_, z_, s_, mean_;
  mutable std::vector<double> scratch_;
  double x_ = 0, away_ = 0;
  int calm_ = 0;
  bool drifts_ = false, worse_ = false;
  HandOverReason reason_ = HandOverReason::right;

  friend class Teaching;
};

class Teaching {
 public:
  Teaching(const TaughtRows& rows, std::size_t lags, const TanhNetwork& shape, std::uint64_t seed);
  Teaching(const Teaching&) = delete;
  Teaching& operator=(const Teaching&) = delete;
  /// Learns for this set of sensors; `variances`: of the baseline, which it is judged against.
  void begin(const std::vector<char>& used, const double* variances);
  bool busy() const { return fit_.busy() || phase_ != Phase::idle; }
  /// One slice; true: it is over, `made()` says whether it is right.
  bool advance();
  /// All of it, on all cores.
  void finish_at_once(std::size_t starts);
  const TaughtNetwork& made() const { return made_; }
  /// Of the held-out rows, for remarks: mean square errors.
  double network_square() const { return held_.network; }
  double baseline_square() const { return held_.baseline; }

  static constexpr std::size_t kBlocks = 16;

 private:
  enum class Phase : char { idle, range, reading, held_out, tail };
  void start_judgement();
  void next(Phase phase);
  std::size_t phase_rows() const;
  void add_range(std::size_t k);
  void add_reading(std::size_t k);
  void solve_readings();
  void add_held_out(std::size_t k);
  void add_tail(std::size_t k);
  void end_of_phase();
  void conclude();
  double weighted(const double* y) const;
  double ageing();
  bool whole() const;

  const TaughtRows& rows_;
  RowsOfSet source_;
  NetworkFit fit_;
  TaughtNetwork made_;
  RecentPast past_;
  Phase phase_ = Phase::idle;
  std::size_t at_ = 0;
  std::uint64_t seed_;
  std::vector<double> inverse_, z_;
  struct {
    std::vector<double> power, side, squares, means;  // of u; of each sensor times u^p; of s
  } readings_;
  struct {
    double network = 0, baseline = 0, weighted = 0, away = 0;
    std::vector<double> gain,
        gain_weighted;  // of each block: squares of the baseline less those of the network
  } held_;
  struct {
    double network = 0, baseline = 0, apart = 0, away = 0;
    std::vector<double> mean, largest;  // of s / deviation
    std::size_t count = 0;
  } tail_;
};

}  // namespace libchar::fusion
