#include "libchar/replay/comparison_check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "libchar/core/refusal.hpp"
#include "libchar/core/text/decimal.hpp"
#include "libchar/core/text/readable.hpp"
#include "libchar/core/text/spelling.hpp"

namespace libchar {
namespace {

struct Metric {
  const char* name;
  double (*value)(const ReplayReport::Algorithm& algorithm);
  double slack;  ///< smaller differences fail no check
};
// The same algorithm holds some ten bytes more or less by where the allocator finds room.
constexpr Metric kMetrics[] = {{"rmse", [](const auto& a) { return a.rmse; }, 0},
                               {"regret", [](const auto& a) { return a.regret; }, 0},
                               {"ns_per_sample", [](const auto& a) { return a.ns_per_sample; }, 0},
                               {"peak_bytes", [](const auto& a) { return a.bytes(); }, 1024}};

const Metric& metric_of(std::string_view name) {
  return *std::find_if(std::begin(kMetrics), std::end(kMetrics), [&](const Metric& metric) {
    return name == metric.name;
  });
}

double value_of(const ReplayReport::Algorithm* one, const Metric& metric) {
  return one != nullptr && one->ran ? metric.value(*one) : std::nan("");
}

std::string number(double value, bool share) {
  return share ? fmt::format("{} %", brief_text(100 * value, 4)) : brief_text(value, 5);
}

// Empty: it holds.
std::string failure(const ComparedAlgorithm& row,
                    const Metric& metric,
                    const ComparisonCheck& check) {
  const bool regret = check.metric == "regret";
  const double a = value_of(row.a, metric), b = value_of(row.b, metric);
  if (std::isnan(b))
    return fmt::format("{}: {} is {} in A, and there is none in B{}",
                       row.label,
                       metric.name,
                       number(a, regret),
                       row.b != nullptr && !row.b->why.empty() ? ": " + row.b->why : "");
  const double limit = regret ? a + check.share : a * (1 + check.share);
  if (b <= limit || b - a <= metric.slack) return "";
  const std::string allowed = shortest(100 * check.share);
  return regret ? fmt::format("{}: regret {} in A, {} in B: {} points more, {} are allowed",
                              row.label,
                              number(a, true),
                              number(b, true),
                              brief_text(100 * (b - a), 3),
                              allowed)
                : fmt::format("{}: {} {} in A, {} in B: {} more, {} % is allowed",
                              row.label,
                              metric.name,
                              number(a, false),
                              number(b, false),
                              a > 0 ? brief_text(100 * (b / a - 1), 3) + " %" : "from nothing",
                              allowed);
}

}  // namespace

ComparisonCheck parse_comparison_check(std::string_view text) {
  GrowthWords words{{}, "algorithm", "such as rmse+5%, or minque:regret+0.5%"};
  for (const Metric& metric : kMetrics) words.metrics.emplace_back(metric.name);
  return parse_growth_check(text, words);
}

std::vector<std::string> failures(const Comparison& comparison, const ComparisonCheck& check) {
  const Metric& metric = metric_of(check.metric);
  std::vector<std::string> out, labels;
  std::size_t checked = 0;
  bool found = false;
  for (const ComparedAlgorithm& row : comparison.algorithms) {
    labels.push_back(row.label);
    if (!check.label.empty() && row.label != check.label) continue;
    found = true;
    if (std::isnan(value_of(row.a, metric))) continue;
    // Not asked for in B, unless by name: nothing was lost.
    if (row.b == nullptr && check.label.empty()) continue;
    ++checked;
    if (const std::string sentence = failure(row, metric, check); !sentence.empty())
      out.push_back(sentence);
  }
  if (!found && !check.label.empty()) {
    const auto near = nearest(check.label, labels);
    refuse_check(check.text,
                 "neither report has this algorithm",
                 did_you_mean(near, "labels are those of the table"));
  }
  if (checked == 0)
    throw Refusal(ErrorKind::check, "E0923", "`check`")
        .says("A has no {} that B could be held against", metric.name)
        .got(check.text);
  return out;
}

}  // namespace libchar
