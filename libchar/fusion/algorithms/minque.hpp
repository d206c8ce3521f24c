#pragma once
// Adaptive weights from variances that the channels tell about each other: recursive re-weighted MINQUE
// (reweighted_variances.hpp, any H: reweighted_matrix.hpp), faults by a bank of cumulative sums (fault_detector.hpp) or
// by the mended rule of [RV] (fault_watch.hpp), then the weighted mean or generalized least squares.

#include <array>
#include <optional>
#include <vector>

#include "libchar/fusion/algorithm.hpp"
#include "libchar/fusion/detail/fault/fault_detector.hpp"
#include "libchar/fusion/detail/fault/fault_watch.hpp"
#include "libchar/fusion/detail/variances/reweighted_matrix.hpp"
#include "libchar/fusion/detail/variances/reweighted_variances.hpp"

namespace libchar::fusion {

struct Minque {
  static constexpr Description description{.name = "minque",
                                           .title = "MINQUE, recursive and re-weighted",
                                           .source = "[RV 4, 5]; Patterson & Thompson 1971",
                                           .complexity = "O(n) for one input, O(n^2) otherwise",
                                           .needs = {.max_channels = kMostPaired,
                                                     .more_than_inputs = 2,
                                                     .observation_matrix = true,
                                                     .accepts_missing = true},
                                           .withstands = 2};
  static constexpr std::array options{
      Option{"gamma", "", 0.999, 0.5, 0.9999999, "memory of the variances: 1/(1 - gamma) instants"},
      Option{"damping", "", 10, 0, 1e6, "ridge on the information of ln v, in units of 1 - gamma; 0: none"},
      Option{"floor", "", 1e-4, 0, 1, "smallest variance relative to the fused variance of the other channels"},
      Option{"floor_largest", "", 0, 0, 1, "smallest variance relative to the largest one"},
      Option{"start_variance", "U^2", 0, 0, 1e300, "of every channel at the start; 0: from the first instants"},
      Option{
          "fault_detection", "", 1, 0, 2,
          "1: channels that fail are taken out or re-weighted, by cumulative sums; 2: by the second moment; 0: neither",
          true},
      Option{"false_alarm_s", "s", 1e5, 1, 1e15,
             "mean time between two false alarms of the array (detection 1; without a rate: per 20 million samples)"},
      Option{"recovery_window", "samples", 0, 0, 1e9,
             "own samples that must agree with the others before a channel comes in again (0: 200, or those of 2 s "
             "where they are fewer) (detection 1)",
             true},
      Option{"fault_gamma", "", 0.99, 0.5, 0.999999, "memory of the second moment that shows a fault (detection 2)"},
      Option{"fault_threshold", "", 2, 1, 1e6, "of that moment relative to the channel's own variance (detection 2)"},
      Option{"recovery_samples", "samples", 1000, 1, 1e12,
             "instants below the threshold before a channel comes in again (detection 2)", true}};

  Minque(const Array& array, const Settings& settings);
  static double cost_ns(const Array& array, const Settings&) {
    const auto n = static_cast<double>(array.channels);
    return array.one_common_input() ? 60 * n : 60 * n + 5 * n * n;
  }
  Minque(const Minque&) = delete;
  Minque& operator=(const Minque&) = delete;
  Estimate step(const Sample& y);
  Eigen::MatrixXd weights() const;
  Eigen::VectorXd variances() const;
  const FaultLog& faults() const { return detector_ ? detector_->log() : watch_.log(); }
  void remarks(Findings& warnings) const;
  /// Of one channel, without a trip to the heap.
  double noise_variance(std::size_t i) const { return general_ ? general_->variance(i) : scalar_.variance(i); }
  bool leaves_out(std::size_t i) const { return out(i); }

 private:
  template <class Variances>
  Estimate step_with(Variances& variances, const Sample& y);
  template <class Variances>
  bool left_out_outlier(const Variances& variances);
  template <class Variances>
  bool found_fault(const Variances& variances);
  template <class Variances>
  void check_recovery(const Variances& variances, const Sample& y);
  template <class Variances>
  void detect(Variances& variances, const Sample& y);
  bool out(std::size_t i) const { return detector_ ? detector_->out(i) : watch_.out(i); }
  int count_out() const { return detector_ ? detector_->count_out() : watch_.count_out(); }
  bool all_in_use() const;
  int in_use(int k) const { return present_[static_cast<std::size_t>(k)]; }
  void use_present(const Sample& y);

  ReweightedVariances scalar_;               // one input seen by all alike
  std::optional<ReweightedMatrix> general_;  // any other H
  std::optional<FaultDetector> detector_;    // detection 1
  FaultWatch watch_;                         // detection 2
  bool asked_, detection_;
  std::int64_t armed_from_, now_ = 0;
  Eigen::Index inputs_;
  std::vector<int> present_;  // channels of this instant, rising: the first m_
  int m_ = 0;
  double outliers_ = 0;  // share of the last instants that had one
  std::vector<std::string> names_;
};

}  // namespace libchar::fusion
