#include "libchar/replay/detail/blind_share.hpp"

#include <algorithm>
#include <limits>

#include "libchar/fusion/why_not.hpp"
#include "libchar/replay/detail/plan/plan.hpp"
#include "libchar/replay/error_meter.hpp"

namespace libchar {
namespace {

constexpr std::int64_t kBlindStretches = 16;
/// Of a stretch, at least, is run and not scored.
constexpr double kLeadIn = 0.25;
constexpr double kMostKept = 1e9;  // bytes

/// Nanoseconds an instant of leave-one-out and both halves.
double cost_of_all(const fusion::Entry& entry, const fusion::Settings& settings, const fusion::Array& array) {
  const Eigen::Index n = array.channels;
  const auto cost = [&](Eigen::Index channels) {
    std::vector<Eigen::Index> some(static_cast<std::size_t>(channels));
    for (Eigen::Index i = 0; i < channels; ++i) some[static_cast<std::size_t>(i)] = i;
    const fusion::Array part = channels > 0 ? subset(array, some) : array;
    return channels > 0 && fusion::why_not(*entry.description, part).empty() ? entry.cost_ns(part, settings) : 0.0;
  };
  return static_cast<double>(left_out_of(n)) * cost(n - 1) + cost((n + 1) / 2) + cost(n / 2);
}

}  // namespace

BlindShare blind_share(const fusion::Entry& entry, const fusion::Settings& settings, const fusion::Array& array,
                       std::int64_t run, std::int64_t warm_up, double budget_s) {
  BlindShare out;
  const double an_instant_s = 1e-9 * cost_of_all(entry, settings, array);
  out.cost_s = an_instant_s * static_cast<double>(run);
  // What looks ahead keeps the run of every part at the same time.
  const auto n = static_cast<double>(array.channels);
  const double most = entry.looks_ahead(settings)
                          ? kMostKept / (8 * n * static_cast<double>(left_out_of(array.channels) + 1))
                          : std::numeric_limits<double>::infinity();
  const double affordable = std::min(budget_s / an_instant_s, most);
  if (!(static_cast<double>(run) > affordable)) return out;
  out.whole = false;
  out.share = 0;
  const auto cell = static_cast<std::int64_t>(ErrorMeter::cell_samples_of(static_cast<std::uint64_t>(run - warm_up)));
  const std::int64_t cells = (run - warm_up) / cell;
  const auto length = static_cast<std::int64_t>(affordable / kBlindStretches);
  const auto scored = static_cast<std::int64_t>((1 - kLeadIn) * static_cast<double>(length)) / cell;
  if (scored == 0) return out;
  // Whole cells: where a meter has samples, another has them at the same instants.
  for (std::int64_t k = 0; k < kBlindStretches; ++k) {
    const std::int64_t first = (2 * k + 1) * cells / (2 * kBlindStretches) - scored / 2;
    BlindStretch stretch;
    stretch.scored_from = warm_up + first * cell;
    stretch.to = stretch.scored_from + scored * cell;
    stretch.from = std::max<std::int64_t>(out.stretches.empty() ? 0 : out.stretches.back().to, stretch.to - length);
    out.stretches.push_back(stretch);
  }
  out.share = static_cast<double>(kBlindStretches * scored * cell) / static_cast<double>(run - warm_up);
  return out;
}

}  // namespace libchar
