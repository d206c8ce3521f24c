#include "libchar/fusion/detail/watched_runner.hpp"

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
    : watched_(std::move(watched)), used_(array.channels, kWatchedAtOnce) {
  if (array.channels > 2 * array.inputs() && array.channels <= kMostPaired)
    detector_.emplace(array,
                      FaultDetectorOptions{settings["false_alarm_s"],
                                           static_cast<std::int64_t>(settings["recovery_window"])});
}

void WatchedRunner::run(const Block& samples, BlockOut x, BlockOut variance) {
  if (!detector_) return watched_->run(samples, x, variance);
  for (Eigen::Index begin = 0; begin < samples.cols(); begin += kWatchedAtOnce) {
    const Eigen::Index count = std::min(kWatchedAtOnce, samples.cols() - begin);
    for (Eigen::Index k = 0; k < count; ++k) leave_out(samples.col(begin + k), used_.col(k));
    watched_->run(
        used_.leftCols(count), x.middleCols(begin, count), variance.middleCols(begin, count));
  }
}

void WatchedRunner::leave_out(const Eigen::Ref<const Eigen::VectorXd>& y,
                              Eigen::Ref<Eigen::VectorXd> used) {
  detector_->step(y.data());
  for (Eigen::Index i = 0; i < y.size(); ++i) {
    const auto channel = static_cast<std::size_t>(i);
    const bool out = detector_->out(channel) || detector_->noisy(channel) > kNoisy;
    used[i] = out ? std::numeric_limits<double>::quiet_NaN() : y[i];
  }
}

void WatchedRunner::remarks(Warnings& warnings) const {
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
