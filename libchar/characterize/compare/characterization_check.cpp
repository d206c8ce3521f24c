#include "libchar/characterize/compare/characterization_check.hpp"

#include <fmt/format.h>

#include "libchar/core/refusal.hpp"
#include "libchar/core/text/decimal.hpp"
#include "libchar/core/text/readable.hpp"
#include "libchar/core/text/spelling.hpp"

namespace libchar {
namespace {

bool is_known(const Coefficient& c) {
  return c.status == Status::detected || c.status == Status::given ||
         c.status == Status::not_detected;
}

// Empty: it holds.
std::string growth_failure(const std::string& channel,
                           const ComparedTerm& t,
                           const GrowthCheck& check) {
  const std::string name = channel + ": " + check.metric;
  if (!is_known(t.b))
    return fmt::format("{} is {} in B ({}), and A knows it",
                       name,
                       t.b.status == Status::not_fitted ? "not fitted" : "not to be relied on",
                       name_of(t.b.status));
  const double allowed = 1 + check.share;
  if (t.ratio && t.ratio_ci95.low > allowed)
    return fmt::format("{} is {} times that of A [{}, {}], {} % more is allowed",
                       name,
                       number_text(*t.ratio),
                       number_text(t.ratio_ci95.low),
                       number_text(t.ratio_ci95.high),
                       shortest(100 * check.share));
  if (!t.a.value && t.a.upper95 && t.b.value && t.b.ci95.low > allowed * *t.a.upper95)
    return fmt::format("{} is {} in B, and was not detected in A ({})",
                       name,
                       coefficient_text(t.b),
                       value_text(t.a));
  return "";
}

}  // namespace

GrowthCheck parse_characterization_check(std::string_view text) {
  GrowthWords words{{}, "channel", "such as white_noise+5%, or gyro_x:bias_instability+20%"};
  for (const TermName& name : kTermNames) words.metrics.emplace_back(name.key);
  return parse_growth_check(text, words);
}

std::vector<std::string> failures(const CharacterizationComparison& comparison,
                                  const GrowthCheck& check) {
  std::vector<std::string> out, labels;
  std::size_t checked = 0;
  bool found = false;
  for (const ComparedChannel& c : comparison.channels) {
    labels.push_back(c.name);
    if (!check.label.empty() && c.name != check.label) continue;
    found = true;
    // Not asked for in B, unless by name: nothing was lost.
    if (!c.in_b && !check.label.empty())
      out.push_back(fmt::format("{}: the channel is only in A", c.name));
    checked += !c.in_b && !check.label.empty() ? 1 : 0;
    for (const ComparedTerm& t : c.terms) {
      if (kTermNames[static_cast<std::size_t>(t.term)].key != check.metric || !is_known(t.a))
        continue;
      ++checked;
      if (std::string sentence = growth_failure(c.name, t, check); !sentence.empty())
        out.push_back(std::move(sentence));
    }
  }
  if (!found && !check.label.empty()) {
    const auto near = nearest(check.label, labels);
    refuse_check(check.text,
                 "neither report has this channel",
                 did_you_mean(near, "labels are names of channels"));
  }
  if (checked == 0)
    throw Refusal(ErrorKind::check, "E0923", "`check`")
        .says("A has no {} that B could be held against", check.metric)
        .got(check.text);
  return out;
}

}  // namespace libchar
