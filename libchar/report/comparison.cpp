#include "libchar/report/comparison.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "libchar/core/error.hpp"
#include "libchar/core/text.hpp"

namespace libchar {
namespace {

std::optional<double> ratio_less_one(const std::optional<double>& a,
                                     const std::optional<double>& b) {
  if (!a || !b || !(*a > 0)) return std::nullopt;
  return *b / *a - 1;
}

const ReportedAlgorithm* find(const ReportedReplay& report, const std::string& label) {
  for (const ReportedAlgorithm& a : report.algorithms)
    if (a.label == label) return &a;
  return nullptr;
}

ComparedAlgorithm compared(const ReportedAlgorithm& a, const ReportedAlgorithm& b) {
  ComparedAlgorithm out{a, b, {}, {}, {}, {}, {}};
  out.score_change = ratio_less_one(a.score, b.score);
  out.ns_change = ratio_less_one(a.ns_per_sample, b.ns_per_sample);
  out.bytes_change = ratio_less_one(a.peak_bytes, b.peak_bytes);
  if (a.regret && b.regret) out.regret_change = *b.regret - *a.regret;
  if (a.score_ci95 && b.score_ci95)
    out.resolved = a.score_ci95->high < b.score_ci95->low || b.score_ci95->high < a.score_ci95->low;
  return out;
}

// Those that ran in `here` and not in `there`.
std::vector<std::pair<std::string, std::string>> only(const ReportedReplay& here,
                                                      const ReportedReplay& there) {
  std::vector<std::pair<std::string, std::string>> out;
  for (const ReportedAlgorithm& a : here.algorithms) {
    if (!a.ran) continue;
    const ReportedAlgorithm* other = find(there, a.label);
    if (other == nullptr)
      out.emplace_back(a.label, "");
    else if (!other->ran)
      out.emplace_back(a.label, other->why);
  }
  return out;
}

std::optional<double> metric_of(const ReportedAlgorithm& a, const std::string& metric) {
  return metric == "rmse"            ? a.score
         : metric == "regret"        ? a.regret
         : metric == "ns_per_sample" ? a.ns_per_sample
                                     : a.peak_bytes;
}

const std::vector<std::string>& metrics() {
  static const std::vector<std::string> names = {"rmse", "regret", "ns_per_sample", "peak_bytes"};
  return names;
}

[[noreturn]] void refuse_check(const std::string& what,
                               const std::string& got,
                               const std::string& hint) {
  throw Error({ErrorKind::usage, "E0924", "--fail-if", what, got, hint});
}

}  // namespace

std::vector<std::string> scene_differences(const ReportedReplay& a, const ReportedReplay& b) {
  std::vector<std::string> out;
  for (std::size_t i = 0; i < std::min(a.identity.size(), b.identity.size()); ++i)
    if (a.identity[i].second != b.identity[i].second)
      out.push_back(fmt::format("the {} differs: {} in A, {} in B",
                                a.identity[i].first,
                                a.identity[i].second,
                                b.identity[i].second));
  return out;
}

Comparison compare_replays(const ReportedReplay& a, const ReportedReplay& b) {
  Comparison out{a, b, scene_differences(a, b), {}, only(a, b), only(b, a)};
  for (const ReportedAlgorithm& mine : a.algorithms) {
    const ReportedAlgorithm* other = find(b, mine.label);
    if (mine.ran && other != nullptr && other->ran) out.both.push_back(compared(mine, *other));
  }
  return out;
}

Check check_from_words(const std::string& text) {
  Check out;
  out.text = text;
  std::string rest = text;
  if (const std::size_t colon = rest.rfind(':'); colon != std::string::npos) {
    out.label = rest.substr(0, colon);
    rest = rest.substr(colon + 1);
    if (out.label.empty()) refuse_check("no label stands before the colon", text, "minque:rmse+5%");
  }
  const std::size_t plus = rest.find('+');
  if (plus == std::string::npos)
    refuse_check("expected [LABEL:]METRIC+LIMIT", text, "rmse+5% or minque:ns_per_sample+20");
  out.metric = rest.substr(0, plus);
  if (std::find(metrics().begin(), metrics().end(), out.metric) == metrics().end()) {
    const auto near = nearest(out.metric, metrics());
    refuse_check(fmt::format("expected one of {}", fmt::join(metrics(), ", ")),
                 out.metric,
                 near ? "did you mean " + *near + "?" : "");
  }
  std::string limit = rest.substr(plus + 1);
  out.relative = limit.ends_with('%');
  if (out.relative) limit.pop_back();
  while (limit.ends_with(' ')) limit.pop_back();
  const auto value = parse_double(limit);
  if (!value || *value < 0)
    refuse_check("expected a limit of at least 0 behind the +", text, "rmse+5%");
  out.limit = out.relative ? *value / 100 : *value;
  return out;
}

namespace {

// Empty: within the limit.
std::string breach(const ComparedAlgorithm& c, const Check& check) {
  const auto a = metric_of(c.a, check.metric), b = metric_of(c.b, check.metric);
  if (!a) return "";
  if (!b)
    return fmt::format(
        "{}: {} was {} in A and is not known in B", c.a.label, check.metric, significant(*a, 5));
  // A regret is a share itself: its percents are percentage points.
  const bool share = check.relative && check.metric != "regret";
  const double allowed = share ? *a * (1 + check.limit) : *a + check.limit;
  if (*b <= allowed) return "";
  const std::string change = share && *a > 0 ? fmt::format("{:+.2f} %", 100 * (*b / *a - 1))
                             : check.metric == "regret"
                                 ? fmt::format("{:+.3g} percentage points", 100 * (*b - *a))
                                 : fmt::format("{:+.4g}", *b - *a);
  std::string out = fmt::format("{}: {} went from {} to {} ({}), more than {} allows",
                                c.a.label,
                                check.metric,
                                significant(*a, 5),
                                significant(*b, 5),
                                change,
                                check.text);
  if ((check.metric == "rmse" || check.metric == "regret") && c.resolved && !*c.resolved)
    out += "; the 95 % intervals overlap";
  return out;
}

}  // namespace

std::vector<std::string> breaches(const Comparison& comparison, const Check& check) {
  std::vector<std::string> out;
  const auto meant = [&](const std::string& label) {
    return check.label.empty() || check.label == label;
  };
  bool compared_any = false;
  for (const ComparedAlgorithm& c : comparison.both) {
    if (!meant(c.a.label)) continue;
    compared_any = compared_any || metric_of(c.a, check.metric).has_value();
    const std::string sentence = breach(c, check);
    if (!sentence.empty()) out.push_back(sentence);
  }
  for (const auto& [label, why] : comparison.only_a)
    if (meant(label))
      out.push_back(label + " ran in A and not in B" + (why.empty() ? "" : ": " + why));
  if (out.empty() && !compared_any)
    out.push_back(fmt::format("{}: nothing to compare, no {} in both reports has this figure",
                              check.text,
                              check.label.empty() ? "algorithm" : "algorithm of this label"));
  return out;
}

}  // namespace libchar
