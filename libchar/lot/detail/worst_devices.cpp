#include "libchar/lot/detail/worst_devices.hpp"

#include <algorithm>
#include <cmath>
#include <unordered_map>

namespace libchar {
namespace {

/// Why a device is among the worst.
struct Reason {
  double p = 1, deviation = 0;
  std::string sentence;
};

using Reasons = std::unordered_map<std::size_t, std::vector<Reason>>;

Reasons reasons_of(const Fleet& fleet, const std::vector<Statistic>& statistics) {
  Reasons out;
  for (const Statistic& s : statistics) {
    for (const FleetOutlier& o : s.lot.outliers)
      out[fleet.sorted.device_of[o.recording]].push_back({o.p, std::abs(o.deviation), o.sentence});
    for (const LimitFailure& f : s.limit.failures)
      out[s.group->devices[f.member]].push_back({f.p, f.deviation, f.sentence});
  }
  return out;
}

bool worse(double p, double deviation, double other_p, double other_deviation) {
  return p != other_p ? p < other_p : deviation > other_deviation;
}

}  // namespace

void add_worst(const Fleet& fleet,
               const std::vector<Statistic>& statistics,
               std::size_t most,
               FleetLot& out) {
  Reasons reasons = reasons_of(fleet, statistics);
  for (auto& [device, all] : reasons) {
    std::stable_sort(all.begin(), all.end(), [](const Reason& a, const Reason& b) {
      return worse(a.p, a.deviation, b.p, b.deviation);
    });
    WorstDevice one{fleet.sorted.first[device], all[0].p, all[0].deviation, {}};
    for (const Reason& reason : all) one.reasons.push_back(reason.sentence);
    out.worst.push_back(std::move(one));
  }
  std::vector<std::size_t> rank(fleet.records.size());
  for (std::size_t i = 0; i < fleet.sorted.order.size(); ++i) rank[fleet.sorted.order[i]] = i;
  std::sort(out.worst.begin(), out.worst.end(), [&](const WorstDevice& a, const WorstDevice& b) {
    if (a.p != b.p || a.deviation != b.deviation) return worse(a.p, a.deviation, b.p, b.deviation);
    return rank[a.recording] < rank[b.recording];
  });
  if (out.worst.size() > most) out.worst.resize(most);
}

void mark_devices(const Fleet& fleet, const std::vector<Statistic>& statistics, FleetLot& out) {
  std::vector<bool> outlying(out.devices), failing(out.devices), open(out.devices),
      held(out.devices);
  for (const Statistic& s : statistics) {
    for (const FleetOutlier& o : s.lot.outliers)
      if (!s.lot.of_kind) outlying[fleet.sorted.device_of[o.recording]] = true;
    for (std::size_t m = 0; m < s.limit.status.size(); ++m) {
      const std::size_t device = s.group->devices[m];
      held[device] = true;
      if (s.limit.status[m] == LimitStatus::fail) failing[device] = true;
      if (s.limit.status[m] == LimitStatus::not_decided) open[device] = true;
    }
  }
  for (std::size_t d = 0; d < out.devices; ++d) {
    out.outlying += outlying[d];
    out.failing += failing[d];
    out.open += !failing[d] && open[d];
    out.keeping += held[d] && !failing[d] && !open[d];
  }
  out.stands_out.resize(fleet.records.size());
  out.fails.resize(fleet.records.size());
  for (std::size_t r = 0; r < fleet.records.size(); ++r) {
    const std::size_t device = fleet.sorted.device_of[r];
    if (device == kNoDevice) continue;
    out.stands_out[r] = outlying[device];
    out.fails[r] = failing[device];
  }
}

}  // namespace libchar
