// Intervals that do not overlap: for two independent estimates with 95 % intervals of like width, a
// difference that large comes by chance in about 0.6 % of cases (Schenker & Gentleman, Am. Stat. 55
// (2001) 182). Two replays of one recording share its noise, so it is rarer still: "not resolved"
// is said too often rather than too seldom.
#include "libchar/replay/comparison.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "libchar/core/error.hpp"
#include "libchar/core/not_known.hpp"
#include "libchar/core/numeric/median.hpp"
#include "libchar/core/text/readable.hpp"
#include "libchar/core/text/term_cells.hpp"
#include "libchar/replay/detail/plan/likeness.hpp"

namespace libchar {
namespace {

Difference difference(const ReplayReport::Algorithm& a, const ReplayReport::Algorithm& b) {
  if (std::isnan(a.rmse) || std::isnan(b.rmse)) return Difference::unknown;
  if (a.rmse == b.rmse) return Difference::equal;
  if (std::isnan(a.rmse_ci95.low) || std::isnan(b.rmse_ci95.low)) return Difference::unknown;
  if (b.rmse_ci95.high < a.rmse_ci95.low) return Difference::better;
  if (b.rmse_ci95.low > a.rmse_ci95.high) return Difference::worse;
  return Difference::not_resolved;
}

double change(double a, double b) {
  return a > 0 ? b / a - 1 : a == b ? 0 : kNone;
}

ComparedAlgorithm row(const ReplayReport::Algorithm* a, const ReplayReport::Algorithm* b) {
  ComparedAlgorithm out;
  out.label = a != nullptr ? a->label : b->label;
  out.a = a;
  out.b = b;
  out.rmse_change = out.ns_change = out.bytes_change = kNone;
  if (!out.both_ran()) return out;
  out.difference = difference(*a, *b);
  out.rmse_change = change(a->rmse, b->rmse);
  out.ns_change = change(a->ns_per_sample, b->ns_per_sample);
  out.bytes_change = change(a->bytes(), b->bytes());
  return out;
}

// Those without a number behind all others.
double order(const ReplayReport::Algorithm* one) {
  return one != nullptr && one->ran && !std::isnan(one->rmse)
             ? one->rmse
             : std::numeric_limits<double>::infinity();
}

std::string best_of(const ReplayReport& r) {
  const ReplayReport::Algorithm* best = r.find(r.best);
  return best == nullptr ? "none" : fmt::format("{} ({})", best->label, brief_text(best->rmse, 5));
}

std::string comparison_verdict(const Comparison& c) {
  std::size_t counts[5] = {};
  std::vector<double> ns;
  std::size_t both = 0;
  for (const ComparedAlgorithm& one : c.algorithms) {
    if (!one.both_ran()) continue;
    ++both;
    ++counts[static_cast<std::size_t>(one.difference)];
    if (std::isfinite(one.ns_change)) ns.push_back(one.ns_change);
  }
  if (both == 0) return "No algorithm ran in both.";
  std::string out = fmt::format("{} of {} algorithms that ran in both:", c.a.score_words(), both);
  const char* comma = " ";
  for (const Difference d : {Difference::better,
                             Difference::worse,
                             Difference::not_resolved,
                             Difference::equal,
                             Difference::unknown})
    if (const std::size_t count = counts[static_cast<std::size_t>(d)]; count > 0) {
      out += fmt::format("{}{} {}", comma, count, name_of(d));
      comma = ", ";
    }
  out += ".";
  if (const double typical = median_in_place(ns); std::isfinite(typical))
    out += fmt::format(" Time a sample: {:+.1f} % (median).", 100 * typical);
  return out + fmt::format(" Best: {} in A, {} in B.", best_of(c.a), best_of(c.b));
}

}  // namespace

Comparison compare_replays(ReplayReport a, ReplayReport b) {
  Comparison out;
  out.a = std::move(a);
  out.b = std::move(b);
  out.unlike = unlike(out.a, out.b);
  for (const ReplayReport::Algorithm& one : out.a.algorithms)
    out.algorithms.push_back(row(&one, out.b.find(one.label)));
  for (const ReplayReport::Algorithm& one : out.b.algorithms)
    if (out.a.find(one.label) == nullptr) out.algorithms.push_back(row(nullptr, &one));
  std::stable_sort(out.algorithms.begin(),
                   out.algorithms.end(),
                   [](const ComparedAlgorithm& left, const ComparedAlgorithm& right) {
                     return std::pair(order(left.b), order(left.a)) <
                            std::pair(order(right.b), order(right.a));
                   });
  out.remarks = remarks(out);
  out.verdict = comparison_verdict(out);
  return out;
}

void refuse_unlike(const Comparison& comparison) {
  if (comparison.unlike.empty()) return;
  const std::size_t shown = std::min(comparison.unlike.size(), kMostNamed);
  std::string what = "not two replays of one scene";
  for (std::size_t i = 0; i < shown; ++i) what += "; " + comparison.unlike[i];
  if (comparison.unlike.size() > shown)
    what += fmt::format("; and {} more differences", comparison.unlike.size() - shown);
  throw Error({ErrorKind::input,
               "E0921",
               comparison.a.file + " and " + comparison.b.file,
               what,
               "",
               "`compare_replays` compares them all the same"});
}

}  // namespace libchar
