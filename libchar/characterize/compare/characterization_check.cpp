#include "libchar/characterize/compare/characterization_check.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "libchar/characterize/compare/paired_channels.hpp"
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

/// Of candidate `i` of a term against the first; empty: it holds.
std::string growth_failure(const ComparedGroup& group,
                           const ComparedTerm& t,
                           std::size_t i,
                           const GrowthCheck& check) {
  const Coefficient &a = t.values[0], &b = t.values[i];
  const std::string &in_a = group.candidates[0].name, &in_b = group.candidates[i].name;
  const std::string name = group.candidates[i].channels[0] + ": " + check.metric;
  if (!is_known(b))
    return fmt::format("{} is {} in {} ({}), and {} knows it",
                       name,
                       b.status == Status::not_fitted ? "not fitted" : "not to be relied on",
                       in_b,
                       name_of(b.status),
                       in_a);
  const double allowed = 1 + check.share;
  if (t.ratios[i].ratio && t.ratios[i].ci95.low > allowed)
    return fmt::format("{} in {} is {} times that of {} [{}, {}], {} % more is allowed",
                       name,
                       in_b,
                       number_text(*t.ratios[i].ratio),
                       in_a,
                       number_text(t.ratios[i].ci95.low),
                       number_text(t.ratios[i].ci95.high),
                       shortest(100 * check.share));
  if (!a.value && a.upper95 && b.value && b.ci95.low > allowed * *a.upper95)
    return fmt::format("{} is {} in {}, and was not detected in {} ({})",
                       name,
                       coefficient_text(b),
                       in_b,
                       in_a,
                       value_text(a));
  return "";
}

bool has_name(const ComparedGroup& group, const std::string& label) {
  return label == group.name ||
         std::any_of(group.candidates.begin(),
                     group.candidates.end(),
                     [&](const ComparedGroup::Candidate& c) { return c.channels[0] == label; });
}

const ReportedChannel* channel_of(const ReportedCharacterization& side, const std::string& label) {
  for (const ReportedChannel& one : side.channels)
    if (label == one.name || label == detail::usual_channel_name(one.name, one.unit)) return &one;
  return nullptr;
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
  for (const ReportedCharacterization& side : comparison.sides)
    for (const ReportedChannel& one : side.channels) labels.push_back(one.name);
  const ReportedCharacterization& first = comparison.sides[0];
  bool found = check.label.empty();
  for (const ReportedCharacterization& side : comparison.sides)
    found = found || channel_of(side, check.label) != nullptr;
  if (!found) {
    const auto near = nearest(check.label, labels);
    refuse_check(check.text,
                 "neither report has this channel",
                 did_you_mean(near, "labels are names of channels"));
  }
  // Not asked for elsewhere, unless by name: nothing was lost.
  if (!check.label.empty() && channel_of(first, check.label) != nullptr)
    for (const ReportedCharacterization& side : comparison.sides)
      if (channel_of(side, check.label) == nullptr) {
        out.push_back(fmt::format("{}: the channel is not in {}", check.label, side.name));
        ++checked;
      }
  for (const ComparedGroup& group : comparison.groups) {
    if (group.of_axes || group.candidates[0].side != 0) continue;
    if (!check.label.empty() && !has_name(group, check.label)) continue;
    for (const ComparedTerm& t : group.terms) {
      if (kTermNames[static_cast<std::size_t>(t.term)].key != check.metric ||
          !is_known(t.values[0]))
        continue;
      for (std::size_t i = 1; i < t.values.size(); ++i) {
        ++checked;
        if (std::string sentence = growth_failure(group, t, i, check); !sentence.empty())
          out.push_back(std::move(sentence));
      }
    }
  }
  if (checked == 0)
    throw Refusal(ErrorKind::check, "E0923", "`check`")
        .says("{} has no {} that another one could be held against", first.name, check.metric)
        .got(check.text);
  return out;
}

}  // namespace libchar
