// At each of ten averaging times a decade the lowest curve is sought, and those that cannot be distinguished
// from it by the intervals of both (term_ratio.cpp). Neighbouring times with the same answer are a range. Where
// two curves cross, neither is lower for a stretch: one shorter than a third of a decade between two others is a
// border, in its geometric middle.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "libchar/characterize/compare/characterization_comparison.hpp"
#include "libchar/core/numeric/whole.hpp"
#include "libchar/core/text/readable.hpp"

namespace libchar::detail {
namespace {

constexpr int kADecade = 10;
constexpr double kBorder = 2.2;  ///< a range that is no longer, between two others, is a border

double between(double a, double b, double share) {
  return a > 0 && b > 0 ? std::exp(std::log(a) + share * (std::log(b) - std::log(a))) : 0;
}

bool reaches(const std::vector<AllanPoint>& curve, double tau_s) {
  return curve.size() > 1 && curve.front().tau_s <= tau_s * 1.0001 && curve.back().tau_s >= tau_s * 0.9999;
}

std::vector<ComparedGroup::Range> ranges_of(const std::vector<ComparedGroup::Time>& times) {
  std::vector<ComparedGroup::Range> out;
  for (const ComparedGroup::Time& time : times) {
    if (!time.lowest.best) continue;
    std::vector<std::size_t> lowest = time.lowest.not_apart;
    lowest.push_back(*time.lowest.best);
    std::sort(lowest.begin(), lowest.end());
    if (!out.empty() && out.back().lowest == lowest)
      out.back().to_s = time.tau_s;
    else
      out.push_back({time.tau_s, time.tau_s, lowest});
  }
  return out;
}

/// Ranges meet in the middle, those that are borders are left out, and alike ones are joined.
std::vector<ComparedGroup::Range> with_borders(std::vector<ComparedGroup::Range> ranges) {
  std::vector<ComparedGroup::Range> kept;
  for (std::size_t i = 0; i < ranges.size(); ++i) {
    const bool inside = i > 0 && i + 1 < ranges.size();
    const bool is_border = inside && ranges[i].lowest.size() > 1 && ranges[i].to_s < kBorder * ranges[i].from_s;
    if (is_border) continue;
    if (!kept.empty() && kept.back().lowest == ranges[i].lowest)
      kept.back().to_s = ranges[i].to_s;
    else
      kept.push_back(ranges[i]);
  }
  for (std::size_t i = 1; i < kept.size(); ++i)
    kept[i - 1].to_s = kept[i].from_s = std::sqrt(kept[i - 1].to_s * kept[i].from_s);
  return kept;
}

/// Two digits: a border is not known better.
std::string time_words(double tau_s) {
  const double unit = std::pow(10.0, std::floor(std::log10(tau_s)) - 1);
  return duration_text(std::round(tau_s / unit) * unit, 2);
}

/// " below 1 s", " from 1 s to 10 s", " beyond 10 s"; "" for all of them.
std::string range_words(const std::vector<ComparedGroup::Range>& ranges, std::size_t k) {
  const bool first = k == 0, last = k + 1 == ranges.size();
  if (first && last) return " at every averaging time";
  if (first) return " below " + time_words(ranges[k].to_s);
  if (last) return " beyond " + time_words(ranges[k].from_s);
  return fmt::format(" from {} to {}", time_words(ranges[k].from_s), time_words(ranges[k].to_s));
}

std::string names_of(const ComparedGroup& group, const std::vector<std::size_t>& which) {
  if (which.size() > 3 && which.size() == group.candidates.size()) return "all";
  std::vector<std::string> names;
  for (const std::size_t i : which) names.push_back(group.candidates[i].name);
  if (names.size() == 1) return names[0];
  const std::string last = names.back();
  names.pop_back();
  return fmt::format("{} and {}", fmt::join(names, ", "), last);
}

std::string lowest_words(const ComparedGroup& group) {
  std::vector<std::string> lowest, apart;
  for (std::size_t k = 0; k < group.ranges.size(); ++k) {
    const ComparedGroup::Range& range = group.ranges[k];
    const std::string where = range_words(group.ranges, k);
    if (range.lowest.size() == 1)
      lowest.push_back(group.candidates[range.lowest[0]].name + (lowest.empty() ? " is lowest" : "") + where);
    else
      apart.push_back(names_of(group, range.lowest) + where);
  }
  std::string out = lowest.empty() ? "" : fmt::format("{}.", fmt::join(lowest, ", "));
  if (!apart.empty()) out += fmt::format("{}Not distinguished: {}.", out.empty() ? "" : " ", fmt::join(apart, "; "));
  return out;
}

/// Curves that do not reach over all of the compared times.
std::string shorter_words(const ComparedGroup& group) {
  std::string out;
  for (const ComparedGroup::Candidate& one : group.candidates) {
    if (!one.takes_part || one.curve.size() < 2) continue;
    if (!reaches(one.curve, group.times.back().tau_s))
      out += fmt::format(" The curve of {} ends at {}.", one.name, time_words(one.curve.back().tau_s));
    if (!reaches(one.curve, group.times.front().tau_s))
      out += fmt::format(" The curve of {} begins at {}.", one.name, time_words(one.curve.front().tau_s));
  }
  return out;
}

}  // namespace

Coefficient curve_at(const std::vector<AllanPoint>& curve, double tau_s) {
  Coefficient out;
  if (!reaches(curve, tau_s)) return out;
  auto right =
      std::find_if(curve.begin() + 1, curve.end(), [&](const AllanPoint& p) { return p.tau_s >= tau_s * 0.9999; });
  if (right == curve.end()) --right;
  const auto left = right - 1;
  const double share = std::clamp(std::log(tau_s / left->tau_s) / std::log(right->tau_s / left->tau_s), 0.0, 1.0);
  if (!(left->deviation > 0) || !(right->deviation > 0)) return out;
  out.value = between(left->deviation, right->deviation, share);
  out.ci95 = {between(left->ci95.low, right->ci95.low, share), between(left->ci95.high, right->ci95.high, share)};
  out.status = out.ci95.high > 0 ? Status::detected : Status::undetermined;
  return out;
}

std::vector<double> compared_times(const ComparedGroup& group) {
  // A model has a curve at any averaging time: recordings say which are of interest.
  const bool recorded = std::any_of(group.candidates.begin(), group.candidates.end(),
                                    [](const ComparedGroup::Candidate& c) { return c.measured && c.takes_part; });
  std::vector<double> begins, ends, out;
  std::size_t curves = 0;
  for (const ComparedGroup::Candidate& one : group.candidates) {
    if (!one.takes_part || one.curve.size() < 2) continue;
    ++curves;
    if (recorded && !one.measured) continue;
    begins.push_back(one.curve.front().tau_s);
    ends.push_back(one.curve.back().tau_s);
  }
  if (curves < 2 || begins.empty()) return out;
  std::sort(begins.begin(), begins.end());
  std::sort(ends.begin(), ends.end(), std::greater<>());
  const std::size_t second = begins.size() > 1 ? 1 : 0;
  const int first = clamped_whole<int>(std::ceil(kADecade * std::log10(begins[second]) - 1e-4)),
            last = clamped_whole<int>(std::floor(kADecade * std::log10(ends[second]) + 1e-4));
  for (int k = first; k <= last; ++k) out.push_back(std::pow(10.0, static_cast<double>(k) / kADecade));
  return out;
}

std::size_t octaves_of(const ComparedGroup& group) {
  const std::size_t times = compared_times(group).size();
  return times == 0 ? 0 : 1 + times * 10 / (3 * kADecade);
}

void compare_times(ComparedGroup& group, double share) {
  std::vector<bool> takes_part;
  for (const ComparedGroup::Candidate& one : group.candidates) takes_part.push_back(one.takes_part);
  for (const double tau_s : compared_times(group)) {
    ComparedGroup::Time time{tau_s, {}, {}};
    for (const ComparedGroup::Candidate& one : group.candidates) time.values.push_back(curve_at(one.curve, tau_s));
    time.lowest = lowest_of(time.values, takes_part, share);
    const auto known = std::count_if(time.values.begin(), time.values.end(), relied_on);
    if (known >= 2) group.times.push_back(std::move(time));
  }
  group.ranges = with_borders(ranges_of(group.times));
  if (group.ranges.empty()) return;
  group.sentence = fmt::format("{}{} Compared from {} to {}.", lowest_words(group), shorter_words(group),
                               time_words(group.times.front().tau_s), time_words(group.times.back().tau_s));
}

}  // namespace libchar::detail
