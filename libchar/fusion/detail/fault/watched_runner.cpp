#include "libchar/fusion/detail/fault/watched_runner.hpp"

#include <algorithm>
#include <limits>
#include <string>
#include <utility>

namespace libchar::fusion {
namespace {

constexpr double kNoisy = 2;  ///< of its variance
constexpr Eigen::Index kWatchedAtOnce = 256;

}  // namespace

WatchedRunner::WatchedRunner(const Array& array,
                             const Settings& settings,
                             std::unique_ptr<Runner> watched)
    : array_(array),
      options_{settings["false_alarm_s"], static_cast<std::int64_t>(settings["recovery_window"])},
      watched_(std::move(watched)),
      used_(array.channels, kWatchedAtOnce) {
  if (array.channels > 2 * array.inputs() && array.channels <= kMostPaired)
    detector_.emplace(array_, options_);
}

void WatchedRunner::run(const Block& samples, BlockOut x, BlockOut variance) {
  if (!detector_) return watched_->run(samples, x, variance);
  for (Eigen::Index begin = 0; begin < samples.cols(); begin += kWatchedAtOnce) {
    const Eigen::Index count = std::min(kWatchedAtOnce, samples.cols() - begin);
    leave_out(*detector_, samples.middleCols(begin, count));
    watched_->run(
        used_.leftCols(count), x.middleCols(begin, count), variance.middleCols(begin, count));
  }
}

// A detector of its own: that of the run begins with its first step.
void WatchedRunner::look(const Block& samples) {
  if (!detector_) return watched_->look(samples);
  if (!ahead_) ahead_.emplace(array_, options_);
  for (Eigen::Index begin = 0; begin < samples.cols(); begin += kWatchedAtOnce) {
    const Eigen::Index count = std::min(kWatchedAtOnce, samples.cols() - begin);
    leave_out(*ahead_, samples.middleCols(begin, count));
    watched_->look(used_.leftCols(count));
  }
}

void WatchedRunner::leave_out(FaultDetector& detector, const Block& samples) {
  for (Eigen::Index k = 0; k < samples.cols(); ++k) {
    detector.step(samples.data() + k * samples.outerStride());
    for (Eigen::Index i = 0; i < samples.rows(); ++i) {
      const auto channel = static_cast<std::size_t>(i);
      const bool out = detector.out(channel) || detector.noisy(channel) > kNoisy;
      used_(i, k) = out ? std::numeric_limits<double>::quiet_NaN() : samples(i, k);
    }
  }
}

void WatchedRunner::remarks(Findings& warnings) const {
  watched_->remarks(warnings);
  const std::string_view name = description().name;
  if (detector_) return detector_->remarks(name, warnings);
  warnings.add("faults_not_watched",
               std::string(name) +
                   " looks for no faults: the search takes more than two sensors an input, and at "
                   "most " +
                   std::to_string(kMostPaired));
}

}  // namespace libchar::fusion
