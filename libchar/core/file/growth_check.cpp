#include "libchar/core/file/growth_check.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "libchar/core/refusal.hpp"
#include "libchar/core/text/decimal.hpp"
#include "libchar/core/text/spelling.hpp"

namespace libchar {
namespace {

std::string either(const std::vector<std::string>& words) {
  std::string out;
  for (std::size_t i = 0; i < words.size(); ++i)
    out += (i == 0 ? "" : i + 1 == words.size() ? " or " : ", ") + words[i];
  return out;
}

}  // namespace

void refuse_check(std::string_view text, const std::string& what, const std::string& hint) {
  throw usage_error("E0922", "`check`").says(what).got(std::string(text)).hint(hint);
}

GrowthCheck parse_growth_check(std::string_view text, const GrowthWords& words) {
  GrowthCheck out;
  out.text = text;
  const std::size_t plus = text.rfind('+');
  if (plus == std::string_view::npos || text.empty() || text.back() != '%')
    refuse_check(text, "expected METRIC+NUMBER%", words.example);
  const auto percent = parse_double(text.substr(plus + 1, text.size() - plus - 2));
  if (!percent || *percent < 0) refuse_check(text, "expected a number of at least 0 between + and %", words.example);
  out.share = *percent / 100;
  std::string_view metric = text.substr(0, plus);
  if (const std::size_t colon = metric.rfind(':'); colon != std::string_view::npos) {
    out.label = metric.substr(0, colon);
    if (out.label.empty()) refuse_check(text, fmt::format("no {} before the colon", words.labelled), words.example);
    metric.remove_prefix(colon + 1);
  }
  out.metric = metric;
  if (std::find(words.metrics.begin(), words.metrics.end(), out.metric) != words.metrics.end()) return out;
  const auto near = nearest(metric, words.metrics);
  refuse_check(text, fmt::format("expected {} before the plus sign", either(words.metrics)),
               did_you_mean(near, words.example));
}

}  // namespace libchar
