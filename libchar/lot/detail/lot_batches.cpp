// One-way analysis of variance with known uncertainties: grouped_effects.hpp.
#include "libchar/lot/detail/lot_batches.hpp"

#include <algorithm>
#include <cmath>

#include "libchar/lot/detail/grouped_effects.hpp"

namespace libchar {
namespace {

/// The values of each batch.
struct BatchValues {
  std::vector<std::vector<double>> y, v;
};

BatchValues by_batch(const Fleet& fleet, const LotGroup& group, const QuantityValues& values) {
  BatchValues out;
  out.y.resize(fleet.batches.size());
  out.v.resize(fleet.batches.size());
  for (std::size_t i = 0; i < values.y.size(); ++i) {
    const std::size_t b = fleet.batch_of[group.devices[values.member[i]]];
    out.y[b].push_back(values.y[i]);
    out.v[b].push_back(values.v[i]);
  }
  return out;
}

}  // namespace

void add_batches(const Fleet& fleet, Statistic& s) {
  QuantityLot& out = s.lot;
  const BatchValues parts = by_batch(fleet, *s.group, s.values);
  const bool logarithm = in_logarithm(out.quantity);
  std::vector<double> y, v;
  std::vector<std::size_t> batch;
  std::size_t compared = 0;
  for (std::size_t b = 0; b < fleet.batches.size(); ++b) {
    const LotCounts& counts = s.values.batch_counts[b];
    if (counts.members == 0) continue;
    BatchLot one{fleet.batches[b], counts, std::nullopt, kNone};
    std::vector<double> sorted = parts.y[b];
    std::sort(sorted.begin(), sorted.end());
    if (!sorted.empty()) {
      const std::size_t n = sorted.size();
      const double middle = (sorted[(n - 1) / 2] + sorted[n / 2]) / 2;
      one.median = logarithm ? std::exp(middle) : middle;
    }
    if (const auto effects = lot_effects(parts.y[b], parts.v[b], counts.members)) {
      one.figures = lot_figures(*effects, logarithm);
      y.insert(y.end(), parts.y[b].begin(), parts.y[b].end());
      v.insert(v.end(), parts.v[b].begin(), parts.v[b].end());
      batch.insert(batch.end(), parts.y[b].size(), compared++);
    }
    out.batches.push_back(std::move(one));
  }
  if (out.batches.size() < 2) out.batches.clear();
  if (compared < 2) return;
  const GroupedEffects effects = grouped_effects(y, v, batch, compared);
  out.batch_difference = BatchDifference{
      effects.between.spread, effects.between.spread_ci95, effects.within, effects.p};
}

}  // namespace libchar
