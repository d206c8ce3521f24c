#include "libchar/replay/detail/detection_sweep.hpp"

#include <algorithm>

namespace libchar {
namespace {

/// Mean time between two false alarms of the array, seconds.
constexpr double kAsked[] = {1e2, 1e3, 1e4, 1e5, 1e6, 1e7};

/// It has the detector, and it is on.
bool detects(const PlannedAlgorithm& planned) {
  const auto on = [&](std::string_view option) {
    const auto table = planned.settings.table();
    return std::any_of(
        table.begin(), table.end(), [&](const auto& one) { return one.name == option; });
  };
  return planned.runs() && on("false_alarm_s") &&
         (!on("fault_detection") || planned.settings["fault_detection"] == 1);
}

}  // namespace

DetectionSweep::DetectionSweep(const ReplayPlan& plan, const std::vector<SensorFault>& known)
    : known_(known), inputs_(plan.array.inputs()) {
  const auto with = std::find_if(plan.algorithms.begin(), plan.algorithms.end(), detects);
  const fusion::Array array = subset(plan.array, plan.live);
  if (known.empty() || with == plan.algorithms.end() || array.channels <= 2 * array.inputs() ||
      array.channels > fusion::kMostPaired)
    return;
  for (Eigen::Index i = 0; i < array.channels; ++i)
    sensors_.push_back(
        static_cast<std::size_t>(plan.live.empty() ? i : plan.live[static_cast<std::size_t>(i)]));
  const fusion::Entry& mean = fusion::algorithm("mean");
  for (const double false_alarm_s : kAsked) {
    fusion::Settings settings(mean.options);
    settings.set("fault_detection", 1);
    settings.set("false_alarm_s", false_alarm_s);
    settings.set("recovery_window", with->settings["recovery_window"]);
    settings_.push_back({false_alarm_s, mean.make(array, settings)});
  }
}

void DetectionSweep::push(const Eigen::MatrixXd& samples) {
  if (settings_.empty()) return;
  Eigen::MatrixXd live;
  const bool all = static_cast<Eigen::Index>(sensors_.size()) == samples.rows();
  if (!all) live = samples(sensors_, Eigen::all);
  for (const Setting& setting : settings_) {
    x_.resize(inputs_, samples.cols());
    variance_.resize(inputs_, samples.cols());
    setting.watched->run(all ? samples : live, x_, variance_);
  }
}

std::vector<DetectionAt> DetectionSweep::result(double start_s,
                                                double rate_hz,
                                                double end_s) const {
  std::vector<DetectionAt> out;
  for (const Setting& setting : settings_) {
    const auto found = found_faults(*setting.watched->faults(), sensors_, start_s, rate_hz);
    out.push_back({setting.false_alarm_s,
                   answers_to(known_, found, start_s, end_s),
                   alarms_without_fault(known_, found)});
  }
  return out;
}

}  // namespace libchar
