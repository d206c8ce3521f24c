// Channels that measure the same are paired (paired_channels.cpp), brought to one unit, and compared term by
// term and averaging time by averaging time. Each judgement gets its share of the probability by which equal
// sensors may be called different (Bonferroni): pairs of candidates times terms and octaves of averaging time.

#include "libchar/characterize/compare/characterization_comparison.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "libchar/allan/noise_curves.hpp"
#include "libchar/core/refusal.hpp"
#include "libchar/core/text/decimal.hpp"
#include "libchar/core/text/readable.hpp"
#include "libchar/core/text/shown.hpp"
#include "libchar/core/text/spelling.hpp"

namespace libchar {
namespace {

using detail::PairedChannel;

bool touches_noise(const Finding& finding) {
  return std::any_of(finding.effects.begin(), finding.effects.end(), [](const auto& effect) {
    return effect.quantity != Affected::mean && effect.quantity != Affected::weights &&
           effect.quantity != Affected::verdict;
  });
}

/// A misfit is of coefficients, which say so themselves: the curve is as it was measured.
bool spoils(const Finding& finding) {
  return finding.severity == Severity::bad && finding.code != "misfit" && touches_noise(finding);
}

void add_findings(const ReportedCharacterization& side, const std::string& channel, ComparedGroup::Candidate& out) {
  for (const Finding& one : side.findings) {
    if (one.subject != channel && one.subject != detail::kOfRecording) continue;
    if (!touches_noise(one)) continue;
    const bool known =
        std::any_of(out.findings.begin(), out.findings.end(), [&](const auto& f) { return f.code == one.code; });
    if (!known) out.findings.push_back(one);
    if (spoils(one)) out.takes_part = false;
  }
}

bool has_interval(const ReportedChannel& channel) {
  return std::none_of(channel.term.begin(), channel.term.end(), [](const Coefficient& c) {
    return c.value && c.ci95.low == *c.value && c.ci95.high == *c.value;
  });
}

std::vector<AllanPoint> scaled_curve(const ReportedChannel& channel, double factor) {
  std::vector<AllanPoint> out = channel.curve;
  for (AllanPoint& point : out) {
    point.deviation *= factor;
    for (Interval* ends : {&point.ci68, &point.ci95}) {
      ends->low *= factor;
      ends->high *= factor;
    }
  }
  std::erase_if(out, [](const AllanPoint& p) { return !(p.deviation > 0); });
  return out;
}

/// At the averaging times of the first of them where all reach.
std::vector<AllanPoint> curve_of_axes(const std::vector<std::vector<AllanPoint>>& axes) {
  std::vector<AllanPoint> out;
  for (const AllanPoint& point : axes[0]) {
    std::vector<Coefficient> all;
    for (const auto& axis : axes) all.push_back(detail::curve_at(axis, point.tau_s));
    const Coefficient mean = detail::root_mean_square(all);
    if (!mean.value) continue;
    AllanPoint& made = out.emplace_back(point);
    made.deviation = *mean.value;
    made.ci95 = mean.status == Status::detected ? mean.ci95 : Interval{};
    made.ci68 = {};
  }
  return out;
}

/// The channels of one side as one candidate: one, or its axes.
void add_candidate(const std::vector<ReportedCharacterization>& sides, const std::vector<PairedChannel>& axes,
                   bool several, ComparedGroup& out) {
  ComparedGroup::Candidate made;
  made.side = axes[0].side;
  const ReportedCharacterization& side = sides[made.side];
  made.name = several ? side.name + " " + axes[0].channel->name : side.name;
  if (several && sides.size() == 1) made.name = axes[0].channel->name;
  std::vector<std::vector<AllanPoint>> curves;
  for (const PairedChannel& one : axes) {
    made.channels.push_back(one.channel->name);
    made.measured = made.measured && has_interval(*one.channel);
    add_findings(side, one.channel->name, made);
    curves.push_back(scaled_curve(*one.channel, one.factor));
  }
  made.findings = worst_first(std::move(made.findings));
  made.curve = curves.size() == 1 ? curves[0] : curve_of_axes(curves);
  for (std::size_t t = 0; t < kTerms; ++t) {
    std::vector<Coefficient> all;
    for (const PairedChannel& one : axes) all.push_back(detail::scaled(one.channel->term[t], one.factor));
    if (out.terms.size() <= t) out.terms.push_back({static_cast<Term>(t), {}, {}, {}, {}, {}});
    out.terms[t].values.push_back(all.size() == 1 ? all[0] : detail::root_mean_square(all));
  }
  out.candidates.push_back(std::move(made));
}

bool is_fitted_in(const Coefficient& c) { return c.status != Status::not_fitted; }

/// An axis of another group that has all of its candidates.
bool is_within(const ComparedGroup& group, const std::vector<ComparedGroup>& all) {
  const auto holds = [&](const ComparedGroup& other) {
    return other.of_axes && other.quantity == group.quantity &&
           std::all_of(group.candidates.begin(), group.candidates.end(), [&](const auto& one) {
             return std::any_of(other.candidates.begin(), other.candidates.end(),
                                [&](const auto& c) { return c.side == one.side; });
           });
  };
  return !group.of_axes && !group.axis.empty() && std::any_of(all.begin(), all.end(), holds);
}

std::vector<ComparedGroup> groups_of(const std::vector<ReportedCharacterization>& sides,
                                     const std::vector<detail::ChannelPairs>& pairs) {
  std::vector<ComparedGroup> out;
  for (const detail::AxesTogether& one : detail::axes_together(pairs)) {
    out.push_back(one.group);
    for (const auto& axes : one.sides) add_candidate(sides, axes, false, out.back());
  }
  for (const detail::ChannelPairs& one : pairs) {
    if (one.channels.size() < 2) continue;
    out.push_back(one.group);
    for (const PairedChannel& channel : one.channels) {
      const auto same_side = [&](const PairedChannel& c) { return c.side == channel.side; };
      add_candidate(sides, {channel}, std::count_if(one.channels.begin(), one.channels.end(), same_side) > 1,
                    out.back());
    }
  }
  for (ComparedGroup& group : out) group.within = is_within(group, out);
  for (ComparedGroup& group : out)
    std::erase_if(group.terms,
                  [](const ComparedTerm& t) { return std::none_of(t.values.begin(), t.values.end(), is_fitted_in); });
  return out;
}

std::size_t judgements_of(const ComparedGroup& group) {
  const std::size_t n = group.candidates.size();
  return n * (n - 1) / 2 * (group.terms.size() + detail::octaves_of(group));
}

std::string terms_words(const ComparedGroup& group) {
  std::vector<std::string> out;
  for (const ComparedTerm& term : group.terms) {
    if (!term.lowest.best || !term.values[*term.lowest.best].value) continue;
    const auto letter = kTermNames[static_cast<std::size_t>(term.term)].letter;
    const auto judged = std::count_if(term.values.begin(), term.values.end(), detail::relied_on);
    if (judged < 2) continue;
    std::vector<std::string> alike;
    for (const std::size_t i : term.lowest.not_apart) alike.push_back(group.candidates[i].name);
    const std::string& best = group.candidates[*term.lowest.best].name;
    out.push_back(alike.empty()
                      ? fmt::format("{}: {}", letter, best)
                      : fmt::format("{}: {} or {}, not distinguished", letter, best, fmt::join(alike, " or ")));
  }
  return out.empty() ? "" : fmt::format("Lowest {}.", fmt::join(out, "; "));
}

void judge(ComparedGroup& group, double share) {
  std::vector<bool> takes_part;
  for (const ComparedGroup::Candidate& one : group.candidates) takes_part.push_back(one.takes_part);
  for (ComparedTerm& term : group.terms) {
    for (const Coefficient& c : term.values) {
      term.ratios.push_back(detail::ratio_of(c, term.values[0]));
      term.differences.push_back(detail::difference_of(c, term.values[0], share));
    }
    term.lowest = detail::lowest_of(term.values, takes_part, share);
  }
  detail::compare_times(group, share);
  group.terms_sentence = terms_words(group);
}

/// Who is the lowest anywhere, in the order of the candidates.
std::vector<std::size_t> winners_of(const ComparedGroup& group) {
  std::vector<std::size_t> out;
  for (std::size_t i = 0; i < group.candidates.size(); ++i) {
    bool wins = false;
    for (const ComparedGroup::Range& range : group.ranges)
      wins = wins || (range.lowest.size() < group.candidates.size() &&
                      std::count(range.lowest.begin(), range.lowest.end(), i) > 0);
    for (const ComparedTerm& term : group.terms) wins = wins || term.lowest.best == i;
    if (wins) out.push_back(i);
  }
  return out;
}

std::string titles_of(const std::vector<Finding>& findings) {
  std::vector<std::string> out;
  for (const Finding& one : findings) {
    const FindingKind* const kind = find_finding_kind(one.code);
    out.emplace_back(kind != nullptr ? std::string(kind->title) : one.code);
    if (out.size() == 3) break;
  }
  return fmt::format("{}", fmt::join(out, ", "));
}

/// "a is left out: motion.", "a, b, c and 5 more are left out: motion.": once for each reason.
std::string left_out_words(const ComparedGroup& group) {
  constexpr std::size_t kMostNames = 3;
  std::vector<std::pair<std::string, std::vector<std::string>>> reasons;
  for (const ComparedGroup::Candidate& one : group.candidates) {
    if (one.takes_part) continue;
    const std::string reason = titles_of(one.findings);
    auto at = std::find_if(reasons.begin(), reasons.end(), [&](const auto& known) { return known.first == reason; });
    if (at == reasons.end()) at = reasons.insert(at, {reason, {}});
    at->second.push_back(one.name);
  }
  std::string out;
  for (const auto& [reason, names] : reasons) {
    const std::size_t shown = std::min(names.size(), kMostNames);
    std::string who =
        fmt::format("{}", fmt::join(names.begin(), names.begin() + static_cast<std::ptrdiff_t>(shown), ", "));
    if (shown < names.size()) who += fmt::format(" and {} more", names.size() - shown);
    out += fmt::format(" {} {} left out: {}.", who, names.size() == 1 ? "is" : "are", reason);
  }
  return out;
}

/// What to know of those that lead, and who was left out.
std::string warning_words(const ComparedGroup& group) {
  std::string out = left_out_words(group);
  for (const std::size_t i : winners_of(group)) {
    const ComparedGroup::Candidate& one = group.candidates[i];
    if (!one.measured) out += fmt::format(" {} is stated without intervals.", one.name);
    if (!one.findings.empty()) out += fmt::format(" Check {} first: {}.", one.name, titles_of(one.findings));
  }
  return out;
}

/// Of several axes together where there are, else of each.
std::string comparison_verdict(const CharacterizationComparison& c) {
  std::string out;
  for (const ComparedGroup& group : c.groups) {
    if (group.within) continue;
    std::string said = group.sentence;
    for (const std::string& more : {group.terms_sentence, warning_words(group)})
      if (!more.empty()) said += (said.empty() || more[0] == ' ' ? "" : " ") + more;
    if (said.empty()) said = "no term and no averaging time is known for two of them.";
    out += fmt::format("{}{}: {}", out.empty() ? "" : "\n", group.name, said);
  }
  return out.empty() ? "No channel is in both." : out;
}

// ---- what else differs ----

class Remarks {
 public:
  void add(const std::string& channel, const std::string& remark) {
    auto [place, made] = channels_.try_emplace(remark);
    if (made) order_.push_back(remark);
    place->second.push_back(channel);
  }
  std::vector<std::string> list() const {
    std::vector<std::string> out;
    for (const std::string& remark : order_)
      out.push_back(fmt::format("{}: {}", fmt::join(channels_.at(remark), ", "), remark));
    return out;
  }

 private:
  std::map<std::string, std::vector<std::string>> channels_;
  std::vector<std::string> order_;
};

std::string band_text(const ReportedChannel& c) {
  return c.band.whole ? "the whole spectrum" : fmt::format("up to {}", detail::frequency_text(c.band.top_hz, 3));
}

std::string unit_or_none(const std::string& unit) { return unit.empty() ? "no unit" : unit; }

/// What differs between the first channel of a group and another.
void add_remarks(const std::vector<ReportedCharacterization>& sides, const std::string& group,
                 const PairedChannel& first, const PairedChannel& other, Remarks& out) {
  const ReportedChannel &a = *first.channel, &b = *other.channel;
  const bool one_side = first.side == other.side;
  const std::string &in_a = one_side ? a.name : sides[first.side].name,
                    &in_b = one_side ? b.name : sides[other.side].name;
  const auto remark = [&](bool differ, const char* what, const std::string& x, const std::string& y) {
    if (differ) out.add(group, fmt::format("{} {} in {}, {} in {}.", what, x, in_a, y, in_b));
  };
  remark(a.unit != b.unit, "unit", unit_or_none(a.unit), unit_or_none(b.unit));
  if (!a.fitted || !b.fitted) {
    for (const auto& [side, channel] : {std::pair{&in_a, &a}, std::pair{&in_b, &b}})
      if (!channel->fitted) out.add(group, "without a fit in " + *side + ".");
    return;
  }
  remark(a.rate_hz > 0 && b.rate_hz > 0 && std::abs(a.rate_hz - b.rate_hz) > 0.01 * a.rate_hz, "sampling rate in Hz",
         brief_text(a.rate_hz, 6), brief_text(b.rate_hz, 6));
  const bool bands =
      a.band.whole != b.band.whole || (!a.band.whole && std::abs(std::log(a.band.top_hz / b.band.top_hz)) > 0.4);
  remark(bands, "band of the fit", band_text(a), band_text(b));
  remark(a.shape != b.shape, "shape", a.shape, b.shape);
  remark(a.events != b.events, "steps, warm-up and ramps taken out:", fmt::format("{}", a.events),
         fmt::format("{}", b.events));
}

std::vector<std::string> remarks_of(const std::vector<ReportedCharacterization>& sides,
                                    const std::vector<detail::ChannelPairs>& pairs) {
  Remarks out;
  for (const detail::ChannelPairs& one : pairs) {
    const PairedChannel& first = one.channels[0];
    if (one.channels.size() == 1 && sides.size() > 1)
      out.add(first.channel->name,
              fmt::format("only in {} ({}).", sides[first.side].name,
                          one.group.quantity.empty() ? unit_or_none(first.channel->unit) : first.channel->unit));
    for (std::size_t i = 1; i < one.channels.size(); ++i)
      add_remarks(sides, one.group.name, first, one.channels[i], out);
  }
  return out.list();
}

/// "NAME, gyro_x, gyro_y: caution: SENTENCE", at most five of each side, of the channels that are wanted.
std::vector<std::string> known_of(const std::vector<ReportedCharacterization>& sides,
                                  const std::vector<std::string>& wanted) {
  constexpr std::size_t kMost = 5;
  std::vector<std::string> out;
  for (const ReportedCharacterization& side : sides) {
    std::vector<std::pair<std::string, std::string>> said;  // subjects, and what is said of them
    for (const Finding& one : side.findings) {
      const ReportedChannel* const channel = side.find(one.subject);
      if (channel != nullptr && !detail::is_chosen(*channel, wanted)) continue;
      const std::string sentence = fmt::format("{}: {}", name_of(one.severity), with_help(one));
      const auto same =
          std::find_if(said.begin(), said.end(), [&](const auto& other) { return other.second == sentence; });
      if (same == said.end())
        said.emplace_back(one.subject, sentence);
      else
        same->first += ", " + one.subject;
    }
    for (std::size_t i = 0; i < std::min(kMost, said.size()); ++i)
      out.push_back(fmt::format("{}, {}: {}", side.name, said[i].first, said[i].second));
    if (said.size() > kMost) out.push_back(fmt::format("{}: and {} more", side.name, said.size() - kMost));
  }
  return out;
}

void set_names(std::vector<ReportedCharacterization>& sides, const std::vector<std::string>& wanted) {
  std::vector<std::string> names, files;
  for (const ReportedCharacterization& side : sides) {
    names.push_back(side.name);
    files.push_back(side.file);
  }
  detail::set_names_apart(names, files);
  for (std::size_t i = 0; i < sides.size(); ++i) {
    if (i < wanted.size() && !wanted[i].empty()) names[i] = wanted[i];
    const auto before = std::count(names.begin(), names.begin() + static_cast<std::ptrdiff_t>(i), names[i]);
    sides[i].name = before > 0 ? fmt::format("{} ({})", names[i], before + 1) : names[i];
  }
}

/// What the sides measure, where they have nothing in common.
void refuse_unlike(const std::vector<ReportedCharacterization>& sides, const std::vector<detail::ChannelPairs>& pairs) {
  if (std::any_of(pairs.begin(), pairs.end(), [](const auto& p) { return p.channels.size() > 1; })) return;
  if (std::any_of(sides.begin(), sides.end(), [](const auto& s) { return s.channels.empty(); })) return;
  std::vector<std::string> measured;
  for (const ReportedCharacterization& side : sides) {
    const ReportedChannel& c = side.channels[0];
    measured.push_back(fmt::format("{} of {} is in {}", c.name, side.name, unit_or_none(c.unit)));
  }
  throw input_error("E0976")
      .says("no two channels measure the same quantity: {}", fmt::join(measured, ", "))
      .hint(
          "at least two recordings of one quantity and axis are needed; give `units` where a log does not state the "
          "unit");
}

/// Whether a name is that of a channel of the group on any side, or says what they measure.
bool names_group(const std::string& name, const ComparedGroup& group) {
  const auto is_named = [&](const std::string& channel) {
    return name == channel || name == detail::usual_channel_name(channel, group.unit);
  };
  return name == group.name ||
         std::any_of(group.candidates.begin(), group.candidates.end(), [&](const ComparedGroup::Candidate& one) {
           return std::any_of(one.channels.begin(), one.channels.end(), is_named);
         });
}

/// The limits with each channel under the name of its group; `some`: of those that are compared.
NoiseLimits by_group(NoiseLimits limits, const std::vector<ComparedGroup>& groups, bool some) {
  for (LimitBlock& block : limits.blocks) {
    std::vector<std::string> names;
    for (const std::string& name : block.channels) {
      const auto group =
          std::find_if(groups.begin(), groups.end(), [&](const ComparedGroup& one) { return names_group(name, one); });
      if (group == groups.end() && some) continue;
      const std::string& known = group == groups.end() ? name : group->name;
      if (std::find(names.begin(), names.end(), known) == names.end()) names.push_back(known);
    }
    if (!names.empty()) block.channels = std::move(names);
  }
  return limits;
}

void add_limits(CharacterizationComparison& out, const NoiseLimits& limits, bool some) {
  std::vector<NamedChannel> named;
  for (const ComparedGroup& group : out.groups) named.push_back({group.name, group.unit});
  for (const ChannelLimit& limit : limits_for(by_group(limits, out.groups, some), named)) {
    ComparedGroup& group = out.groups[limit.channel];
    for (ComparedTerm& term : group.terms)
      if (term.term == limit.term) term.limit = limit.most;
  }
  for (ComparedGroup& group : out.groups) {
    Mixture theta{};
    for (const ComparedTerm& term : group.terms)
      theta[static_cast<std::size_t>(term.term)] = std::pow(term.limit.value_or(0), 2);
    for (const ComparedGroup::Time& time : group.times) {
      const double variance = allan_variance(theta, 1000, time.tau_s / 1000);
      if (!(variance > 0)) continue;
      group.limit_tau_s.push_back(time.tau_s);
      group.limit_curve.push_back(std::sqrt(variance));
    }
  }
}

}  // namespace

CharacterizationComparison compare_characterizations(std::vector<ReportedCharacterization> sides,
                                                     const CharacterizationCompareOptions& options) {
  CharacterizationComparison out;
  out.sides = std::move(sides);
  out.probability = options.probability;
  set_names(out.sides, options.names);
  const std::vector<detail::ChannelPairs> pairs = detail::paired_channels(out.sides, options.channels);
  refuse_unlike(out.sides, pairs);
  out.groups = groups_of(out.sides, pairs);
  std::size_t judgements = 0;
  for (const ComparedGroup& group : out.groups) judgements += judgements_of(group);
  for (ComparedGroup& group : out.groups)
    judge(group, options.probability / static_cast<double>(std::max<std::size_t>(1, judgements)));
  if (options.limits) add_limits(out, *options.limits, !options.channels.empty());
  out.remarks = remarks_of(out.sides, pairs);
  out.known = known_of(out.sides, options.channels);
  out.verdict = comparison_verdict(out);
  return out;
}

namespace {

/// Of candidate `i` of a term against the first; empty: it holds.
std::string growth_failure(const ComparedGroup& group, const ComparedTerm& t, std::size_t i, const GrowthCheck& check) {
  const Coefficient &a = t.values[0], &b = t.values[i];
  const std::string &in_a = group.candidates[0].name, &in_b = group.candidates[i].name;
  const std::string name = group.candidates[i].channels[0] + ": " + check.metric;
  if (!detail::relied_on(b))
    return fmt::format("{} is {} in {} ({}), and {} knows it", name,
                       b.status == Status::not_fitted ? "not fitted" : "not to be relied on", in_b, name_of(b.status),
                       in_a);
  const double allowed = 1 + check.share;
  if (t.ratios[i].ratio && t.ratios[i].ci95.low > allowed)
    return fmt::format("{} in {} is {} times that of {} [{}, {}], {} % more is allowed", name, in_b,
                       number_text(*t.ratios[i].ratio), in_a, number_text(t.ratios[i].ci95.low),
                       number_text(t.ratios[i].ci95.high), shortest(100 * check.share));
  if (!a.value && a.upper95 && b.value && b.ci95.low > allowed * *a.upper95)
    return fmt::format("{} is {} in {}, and was not detected in {} ({})", name, coefficient_text(b), in_b, in_a,
                       value_text(a));
  return "";
}

bool has_name(const ComparedGroup& group, const std::string& label) {
  return label == group.name || std::any_of(group.candidates.begin(), group.candidates.end(),
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

std::vector<std::string> failures(const CharacterizationComparison& comparison, const GrowthCheck& check) {
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
    refuse_check(check.text, "neither report has this channel", did_you_mean(near, "labels are names of channels"));
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
      if (kTermNames[static_cast<std::size_t>(t.term)].key != check.metric || !detail::relied_on(t.values[0])) continue;
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
