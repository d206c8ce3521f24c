#include "libchar/lot/detail/fleet_verdict.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <utility>

#include "libchar/core/text/text.hpp"

namespace libchar {
namespace {

/// Quantities of channels in which batches differ, each with its share of 5 %.
std::string batch_sentence(const FleetLot& lot) {
  const auto tested = [](const QuantityLot& q) { return !q.of_kind && q.batch_difference; };
  const auto tests = std::count_if(lot.quantities.begin(), lot.quantities.end(), tested);
  std::vector<const QuantityLot*> found;
  for (const QuantityLot& q : lot.quantities)
    if (tested(q) && q.batch_difference->p < 0.05 / static_cast<double>(tests)) found.push_back(&q);
  if (tests == 0) return "";
  if (found.empty()) return " No difference between batches is resolved.";
  std::stable_sort(found.begin(), found.end(), [](const QuantityLot* a, const QuantityLot* b) {
    return a->batch_difference->p < b->batch_difference->p;
  });
  constexpr std::size_t kShown = 3;
  std::string list;
  for (std::size_t i = 0; i < std::min(kShown, found.size()); ++i)
    list += fmt::format(
        "{}{} of {}", i == 0 ? "" : ", ", title_of(found[i]->quantity), found[i]->group);
  if (found.size() > kShown) list += fmt::format(" and {} more", found.size() - kShown);
  return fmt::format(" Batches differ: {}.", list);
}

/// ": 1 recording could not be characterized, of 3 recordings the result is not there yet"
std::string without_result(const FleetLot& lot) {
  std::string out;
  if (!lot.failed.empty())
    out += fmt::format(": {} could not be characterized", plural(lot.failed.size(), "recording"));
  if (!lot.awaited.empty())
    out += fmt::format("{} of {} the result is not there yet",
                       out.empty() ? ":" : ",",
                       plural(lot.awaited.size(), "recording"));
  return out;
}

std::string stand_out(std::size_t count, const char* what) {
  return count == 1 ? fmt::format(" 1 {} stands out from its kind.", what)
                    : fmt::format(" {} {}s stand out from their kind.", count, what);
}

/// That nobody stands out is a finding only where somebody could.
std::string outlying_sentence(const FleetLot& lot) {
  std::set<std::pair<std::size_t, std::size_t>> channels;  // of single devices
  bool any = false, searched = false, axes = true;
  for (const QuantityLot& q : lot.quantities) {
    any = any || q.counts.counted > 0;
    searched = searched || q.searched;
    axes = axes && (q.of_kind || !q.searched);
    if (q.of_kind)
      for (const FleetOutlier& o : q.outliers) channels.emplace(o.recording, o.channel);
  }
  if (!any) return " There is no result to judge.";
  if (!searched)
    return fmt::format(" Too few of a kind to say which stands out: at least {} are needed.",
                       kFewestForOutliers);
  std::string out = lot.outlying > 0 ? stand_out(lot.outlying, "device") : "";
  if (!channels.empty()) out += stand_out(channels.size(), "channel");
  if (!out.empty()) return out;
  return axes ? " No channel stands out from its kind." : " No device stands out from its kind.";
}

}  // namespace

std::string fleet_verdict(const FleetLot& lot) {
  std::string out = plural(lot.devices, "device");
  if (lot.types.size() > 1) out += fmt::format(" of {} types", lot.types.size());
  if (lot.batches.size() > 1) out += fmt::format(" in {} batches", lot.batches.size());
  if (lot.order.size() != lot.devices)
    out += fmt::format(", {}", plural(lot.order.size(), "recording"));
  out += without_result(lot) + "." + outlying_sentence(lot);
  const std::size_t held = lot.failing + lot.open + lot.keeping;
  if (held > 0)
    out += fmt::format(" Of {} held against limits, {} {}, {} not decided, {} all of them.",
                       plural(held, "device"),
                       lot.failing,
                       lot.failing == 1 ? "fails one" : "fail one or more",
                       lot.open,
                       lot.keeping == 1 ? "1 keeps" : fmt::format("{} keep", lot.keeping));
  return out + batch_sentence(lot);
}

}  // namespace libchar
