// Every quantity of every channel is a search of its own (core/random_effects.hpp); with m of them
// each has the share 1/m of the probability of a false alarm (Bonferroni).
#include "libchar/lot/detail/statistics/lot_outliers.hpp"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "libchar/core/text/readable.hpp"

namespace libchar {
namespace {

FleetOutlier outlier_of(const Fleet& fleet,
                        const Statistic& s,
                        const Outlier& found,
                        double others) {
  const LotPlace place = place_of(*s.group, s.values.member[found.index]);
  const RecordedChannel& channel = fleet.records[place.recording].channels[place.channel];
  FleetOutlier out;
  out.recording = place.recording;
  out.channel = place.channel;
  out.p = found.p;
  out.deviation = found.deviation;
  out.value = s.values.y[found.index];
  const std::string what = channel.name + ": " + title_of(s.lot.quantity);
  if (!in_logarithm(s.lot.quantity)) {
    out.sentence = fmt::format("{} {} {}, {} standard deviations from the others ({}).",
                               what,
                               number_text(out.value),
                               s.lot.unit,
                               number_text(std::abs(found.deviation), 2),
                               probability_text(found.p));
    return out;
  }
  out.ratio = std::exp(out.value - others);
  out.value = std::exp(out.value);
  out.sentence = fmt::format("{} {} {}, {} times that of the others ({}).",
                             what,
                             number_text(out.value),
                             s.lot.unit,
                             number_text(out.ratio, 3),
                             probability_text(found.p));
  return out;
}

void add_outliers(const Fleet& fleet, double probability, Statistic& s) {
  std::vector<Outlier> found = find_outliers(s.values.y, s.values.v, probability);
  if (found.empty()) return;
  std::vector<bool> outside(s.values.y.size());
  for (const Outlier& one : found) outside[one.index] = true;
  std::vector<double> y, v;
  for (std::size_t i = 0; i < s.values.y.size(); ++i) {
    if (outside[i]) continue;
    y.push_back(s.values.y[i]);
    v.push_back(s.values.v[i]);
  }
  const double others = random_effects(y, v).mean;
  std::stable_sort(found.begin(), found.end(), [](const Outlier& a, const Outlier& b) {
    return std::abs(a.deviation) > std::abs(b.deviation);
  });
  for (const Outlier& one : found) s.lot.outliers.push_back(outlier_of(fleet, s, one, others));
}

}  // namespace

void search_outliers(const Fleet& fleet, double probability, std::vector<Statistic>& statistics) {
  std::size_t count = 0;
  for (Statistic& s : statistics) {
    const LotCounts& counts = s.lot.counts;
    s.lot.searched = shows_outliers(*s.group) && s.lot.effects &&
                     counts.counted >= kFewestForOutliers &&
                     enough_count(counts.counted, counts.members);
    count += s.lot.searched;
  }
  tbb::parallel_for(std::size_t{0}, statistics.size(), [&](std::size_t i) {
    if (statistics[i].lot.searched)
      add_outliers(fleet, probability / static_cast<double>(count), statistics[i]);
  });
}

}  // namespace libchar
