#pragma once
// What is done to all sensors and the reference alike before anything is learnt or fused: a trend
// is taken out of each, and one filter runs over all.

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <optional>
#include <vector>

namespace libchar {

// One causal filter for all sensors and the reference: a high-pass, or a band.

/// Second order: y_k = b0 x_k + b1 x_{k-1} + b2 x_{k-2} - a1 y_{k-1} - a2 y_{k-2}.
struct SecondOrderSection {
  double b0 = 1, b1 = 0, b2 = 0, a1 = 0, a2 = 0;
};

/// Butterworth of second order, 0 < corner < 0.5, as a share of the rate.
SecondOrderSection butterworth_high_pass(double corner);
SecondOrderSection butterworth_low_pass(double corner);

/// A high-pass at `from_hz` and, where `to_hz` > 0, a low-pass at `to_hz` behind it.
struct BandFilter {
  std::array<SecondOrderSection, 2> sections;
  std::size_t count = 0;      ///< of sections
  std::int64_t settling = 0;  ///< samples until what a step left is below a thousandth
  std::int64_t bridged = 0;   ///< as many missing samples in a row are bridged
  double noise_gain = 1;      ///< variance of filtered white noise over that of white noise
};

/// Until it has settled, in periods of its lower corner.
inline constexpr double kSettlingPeriods = 1.65;

/// Both corners below half the rate.
BandFilter band_filter(double from_hz, double to_hz, double rate_hz);

/// The filter's run over one channel. It begins in the steady state of the first sample, so that a constant leaves no
/// trace. Missing samples (NaN) stay missing, and the last value stands for them inside; after more than `bridged` it
/// begins anew, and what comes is missing until it has settled.
class FilteredChannel {
 public:
  explicit FilteredChannel(const BandFilter& filter) : filter_(&filter) {}
  double operator()(double sample);

 private:
  struct State {
    double first = 0, second = 0;
  };
  double filtered(double x);
  void begin(double sample);

  const BandFilter* filter_;
  std::array<State, 2> states_;
  bool begun_ = false;
  double origin_ = 0, last_ = 0;
  std::int64_t missing_ = 0;  // in a row
  std::int64_t unsettled_ = 0;
};

/// A straight line over the instants.
struct TrendLine {
  double level = 0;   ///< at `middle`
  double slope = 0;   ///< an instant
  double middle = 0;  ///< instant
  double at(std::int64_t instant) const { return level + slope * (static_cast<double>(instant) - middle); }
};

/// The mean, or the line of least squares, of each of several series; NaN = missing. One pass, constant memory.
class TrendMeter {
 public:
  /// Consecutive instants from `first` on, a column each, a row a series.
  void push(std::int64_t first, const Eigen::MatrixXd& series);
  /// `sloped`: lines, else means. A series without samples has a line of zeros.
  std::vector<TrendLine> lines(bool sloped) const;

 private:
  // Moments about the running means: an offset, or a late time, costs no digits.
  struct Sums {
    double n = 0, time = 0, value = 0, time_squares = 0, products = 0;
  };
  std::vector<Sums> sums_;
};

struct Preparation {
  std::vector<TrendLine> trends;  ///< a row each; empty: none is taken out
  std::optional<BandFilter> filter;
  bool idle() const { return trends.empty() && !filter; }
};

/// One pass over all rows.
class Prepared {
 public:
  Prepared(const Preparation& preparation, std::size_t rows);
  /// The instants of a row come in order from the first one on.
  double operator()(std::size_t row, std::int64_t instant, double value);

 private:
  const Preparation* preparation_;
  std::vector<FilteredChannel> channels_;
};

}  // namespace libchar
