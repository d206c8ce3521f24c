// One-way analysis of variance with known uncertainties: grouped_effects.hpp.
#include "libchar/lot/detail/lot_batches.hpp"

#include <algorithm>
#include <cmath>

#include "libchar/lot/detail/statistics/grouped_effects.hpp"

namespace libchar {
namespace {

double median_of(std::vector<double> values) {
  if (values.empty()) return kNone;
  std::sort(values.begin(), values.end());
  const std::size_t n = values.size();
  return (values[(n - 1) / 2] + values[n / 2]) / 2;
}

}  // namespace

void add_batches(const Fleet& fleet, Statistic& s) {
  QuantityLot& out = s.lot;
  const bool logarithm = in_logarithm(out.quantity);
  std::vector<double> y, v;
  std::vector<std::size_t> batch;
  std::size_t compared = 0;
  for (std::size_t b = 0; b < fleet.batches.size(); ++b) {
    if (s.values.batch_counts[b].members == 0) continue;
    const QuantityValues part = values_of_batch(s.values, *s.group, fleet.batch_of, b);
    const double middle = median_of(part.y);
    BatchLot one{fleet.batches[b],
                 part.counts,
                 std::nullopt,
                 part.counts.counted,
                 logarithm ? std::exp(middle) : middle};
    if (const auto found = effects_of(part, logarithm)) {
      one.figures = lot_figures(found->effects, logarithm);
      one.in_figures = found->effects.count;
    }
    if (enough_count(part.y.size(), part.counts.members)) {
      y.insert(y.end(), part.y.begin(), part.y.end());
      v.insert(v.end(), part.v.begin(), part.v.end());
      batch.insert(batch.end(), part.y.size(), compared++);
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
