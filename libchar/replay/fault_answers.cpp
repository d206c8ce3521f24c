#include "libchar/replay/fault_answers.hpp"

#include <algorithm>
#include <limits>

namespace libchar {
namespace {

bool explains(const SensorFault& known, const FoundFault& found) {
  return known.sensor == found.sensor && found.from_s < known.to_s &&
         found.to_s.value_or(std::numeric_limits<double>::infinity()) > known.from_s;
}

}  // namespace

std::vector<FoundFault> found_faults(const fusion::FaultLog& log, const std::vector<std::size_t>& sensors,
                                     double start_s, double rate_hz) {
  std::vector<FoundFault> out;
  std::vector<std::ptrdiff_t> open;  // of each channel: its stretch that has not ended, -1: none
  for (const fusion::FaultEvent& event : log.events()) {
    const double time_s = start_s + static_cast<double>(event.sample) / rate_hz;
    const auto channel = static_cast<std::size_t>(event.channel);
    if (channel >= open.size()) open.resize(channel + 1, -1);
    if (event.faulty && open[channel] < 0) {
      open[channel] = std::ssize(out);
      out.push_back({sensors.empty() ? channel : sensors[channel], std::string(fusion::name(event.rule)), time_s, {}});
    } else if (!event.faulty && open[channel] >= 0) {
      out[static_cast<std::size_t>(open[channel])].to_s = time_s;
      open[channel] = -1;
    }
  }
  return out;
}

std::vector<detail::FaultsFound::Lead> detail::lead_stretches(const fusion::HandOverLog& log, double start_s,
                                                              double rate_hz) {
  std::vector<FaultsFound::Lead> out;
  bool open = false;
  for (const fusion::HandOver& event : log.events()) {
    const double time_s = start_s + static_cast<double>(event.sample) / rate_hz;
    if (open) {
      out.back().to_s = time_s;
      out.back().ended = std::string(fusion::name(event.reason));
    }
    open = event.to != fusion::Lead::baseline;
    if (open) out.push_back({std::string(fusion::name(event.to)), time_s, {}, ""});
  }
  return out;
}

std::vector<FaultAnswer> answers_to(const std::vector<SensorFault>& known, const std::vector<FoundFault>& found,
                                    double start_s, double end_s) {
  std::vector<FaultAnswer> out;
  for (std::size_t f = 0; f < known.size(); ++f) {
    const SensorFault& fault = known[f];
    if (fault.from_s >= end_s || fault.to_s <= start_s) continue;
    FaultAnswer answer{f, {}, {}};
    for (const FoundFault& one : found) {
      if (!explains(fault, one)) continue;
      if (!answer.found_s) answer.found_s = std::max(0.0, one.from_s - fault.from_s);
      // The last time it was out while the fault lasted.
      answer.returned_s.reset();
      if (one.to_s && *one.to_s >= fault.to_s) answer.returned_s = *one.to_s - fault.to_s;
    }
    out.push_back(answer);
  }
  return out;
}

std::size_t alarms_without_fault(const std::vector<SensorFault>& known, const std::vector<FoundFault>& found) {
  return static_cast<std::size_t>(std::count_if(found.begin(), found.end(), [&](const FoundFault& one) {
    return std::none_of(known.begin(), known.end(), [&](const auto& fault) { return explains(fault, one); });
  }));
}

}  // namespace libchar
