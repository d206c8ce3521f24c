#include "libchar/report/text/characterization_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "libchar/characterize/compare/verification.hpp"
#include "libchar/core/numeric/whole.hpp"
#include "libchar/core/table/table.hpp"
#include "libchar/core/text/readable.hpp"
#include "libchar/core/text/shown.hpp"
#include "libchar/core/text/spelling.hpp"
#include "libchar/core/text/text.hpp"
#include "libchar/core/units.hpp"
#include "libchar/report/detail/tables/coefficients.hpp"

namespace libchar {

std::string characterization_text(const CharacterizationView& view, const TextLook& look) {
  const Characterization& result = *view.result;
  const LogInfo& log = result.log;
  const double rate = log.time.rate_hz;
  const std::string length = rate > 0 ? fmt::format("{}, {}", detail::frequency_text(rate, 6),
                                                    duration_text(static_cast<double>(log.samples) / rate))
                                      : plural(log.samples, "sample") + ", rate unknown";
  std::string text = fmt::format("{}: {}, {}, {}\n", printable(log.file), plural(log.channels.size(), "channel"),
                                 length, plural(log.time.gaps, "gap"));
  if (result.still) text += printable(result.still->sentence) + "\n";
  for (const ChannelView& channel : view.channels) {
    const ChannelResult& c = *channel.result;
    text += "\n" + (c.fit ? fit_text(c.channel, *c.fit, look) : printable(c.channel.name) + "\n");
    const Rating rating = channel.judgement.rating;
    text += fmt::format("  {} {}\n", tinted(fmt::format("{}:", rating_word(rating)), tint_of(rating), look.colours),
                        printable(channel.summary));
    if (c.verification)
      for (const std::string& sentence : c.verification->sentences) text += fmt::format("  {}\n", printable(sentence));
    text += findings_text(channel.judgement.findings, 5, look.colours);
  }
  if (result.limits) text += limits_text(*result.limits, look);
  return text;
}

std::string characterization_text(const Characterization& result, const TextLook& look) {
  return characterization_text(characterization_view(result), look);
}

std::string fit_text(const Channel& channel, const NoiseFit& fit, const TextLook& look) {
  std::string text = fmt::format(
      "{}{}\n", printable(channel.name),
      shown_unit(channel.unit).empty() || channel.unit.empty() ? "" : fmt::format(" [{}]", printable(channel.unit)));
  text += terminal_table(coefficients_table(fit, channel.unit), look);
  if (!fit.band.whole)
    text +=
        "  best possible, record for 10 %: for a recording whose whole spectrum the terms describe, not only this "
        "band\n";
  if (const Table laws = power_laws_table(fit, channel.unit); !laws.rows.empty())
    text += "  " + terminal_table(laws, look);
  if (fit.bandwidth_hz) {
    const int digits = digits_of(*fit.bandwidth_hz, *fit.bandwidth_ci95);
    text += fmt::format("  low-pass corner {} Hz ({})\n", number_text(*fit.bandwidth_hz, digits),
                        interval_text(*fit.bandwidth_ci95, digits));
  }
  // A curve without uncertainties is scaled to its own scatter: its chi-square says nothing.
  const bool judged = fit.goodness.p < 1 || fit.goodness.chi2 != fit.goodness.dof;
  text += "  " + fit.search.method;
  if (judged)
    text +=
        fmt::format("; goodness of fit: chi-square {} for {} degrees of freedom, p = {}",
                    brief_text(fit.goodness.chi2, 4), brief_text(fit.goodness.dof, 4), brief_text(fit.goodness.p, 2));
  text += "\n";
  if (fit.second_opinion)
    text += fmt::format("  second opinion (covariance-weighted Allan fit): {}\n", fit.second_opinion->sentence);
  for (const Remedy& remedy : fit.remedies)
    text += fmt::format("  remedy {}: {} – because {}\n", remedy.kind, remedy.action, remedy.alarm);
  return text;
}

namespace {

// Enough digits to see a thousandth of the noise beside a large offset.
std::string beside_noise(double value, double noise) {
  const double ratio = noise > 0 ? std::abs(value) / noise : 1;
  return brief_text(value, 4 + clamped_whole(std::ceil(std::log10(ratio)), 1, 12));
}

std::vector<Cell> channel_row(const Channel& channel, const ChannelQuality& q) {
  const double noise = q.standard_deviation;
  const bool constant = q.samples > 1 && q.minimum == q.maximum;
  return {printable(channel.name, 40),
          channel.unit.empty()          ? "-"
          : dimensionless(channel.unit) ? ""
                                        : printable(channel.unit, 20),
          std::to_string(q.missing),
          beside_noise(q.mean, noise),
          constant                             ? "constant"
          : q.samples < 2 || std::isnan(noise) ? "-"
                                               : brief_text(noise, 4),
          beside_noise(q.minimum, noise),
          beside_noise(q.maximum, noise),
          q.resolution ? brief_text(*q.resolution, 4) : "-",
          std::to_string(q.saturated),
          Cell::shown(q.samples < 3 || constant ? "-" : brief_text(q.difference_kurtosis, 3), q.difference_kurtosis)};
}

/// The first rows of a table, and how many more there are.
template <class RowOf>
Table first_rows(std::string_view heads, std::size_t rows, RowOf&& row_of) {
  constexpr std::size_t kShown = 1000;
  Table out(heads);
  for (std::size_t r = 0; r < std::min(rows, kShown); ++r) out.add(row_of(r));
  if (rows > kShown) out.note = fmt::format("… and {} more, which JSON lists", rows - kShown);
  return out;
}

Table channel_table(const Inspection& inspection) {
  return first_rows("channel|unit|missing|mean|sd|min|max|LSB|saturated|kurtosis of differences",
                    inspection.quality.size(),
                    [&](std::size_t c) { return channel_row(inspection.info.channels[c], inspection.quality[c]); });
}

// "angular_velocity.x, … and 34 more": enough to see what a topic is about.
std::string some_fields(const LogTopic& topic) {
  if (!topic.why_not.empty()) return "not read: " + topic.why_not;
  std::string text;
  constexpr std::size_t kShown = 4;
  for (std::size_t i = 0; i < std::min(kShown, topic.fields.size()); ++i)
    text += (i == 0 ? "" : ", ") + printable(topic.fields[i].name, 40);
  if (topic.fields.size() > kShown) text += fmt::format(" and {} more", topic.fields.size() - kShown);
  return text;
}

std::vector<Cell> topic_row(const LogTopic& topic) {
  return {printable(topic.name, 60), topic.type.empty() ? "-" : printable(topic.type, 40), std::to_string(topic.rows),
          topic.rate_hz > 0 ? detail::frequency_text(topic.rate_hz, 4) : "-", some_fields(topic)};
}

// What sensors write first, what cannot be read last.
Table topic_table(const LogInfo& info) {
  const auto rank = [](const LogTopic* topic) { return !topic->why_not.empty() ? 2 : topic->sensor ? 0 : 1; };
  std::vector<const LogTopic*> topics;
  for (const LogTopic& topic : info.topics) topics.push_back(&topic);
  std::stable_sort(topics.begin(), topics.end(), [&](auto* a, auto* b) { return rank(a) < rank(b); });
  return first_rows("topic|type|rows|rate|fields", topics.size(),
                    [&](std::size_t row) { return topic_row(*topics[row]); });
}

// One line for each kind of finding, not one for each channel: what the first says, and who is alike. The worst first.
std::string remarks(const Inspection& inspection) {
  struct Alike {
    const Finding* first;
    std::vector<std::string> channels;
    bool same = true;
  };
  std::vector<Alike> kinds;
  for (std::size_t c = 0; c < inspection.quality.size(); ++c)
    for (const Finding& one : inspection.quality[c].findings) {
      auto kind = std::find_if(kinds.begin(), kinds.end(), [&](const Alike& k) { return k.first->code == one.code; });
      if (kind == kinds.end()) kind = kinds.insert(kinds.end(), {&one, {}});
      kind->same = kind->same && kind->first->sentence == one.sentence;
      kind->channels.push_back(printable(inspection.info.channels[c].name, 40));
    }
  constexpr std::size_t kOnScreen = 5;
  std::stable_sort(kinds.begin(), kinds.end(),
                   [](const Alike& a, const Alike& b) { return a.first->severity > b.first->severity; });
  std::string text;
  for (std::size_t i = 0; i < std::min(kOnScreen, kinds.size()); ++i) {
    const Alike& kind = kinds[i];
    const std::vector<std::string> others(kind.channels.begin() + 1, kind.channels.end());
    const std::string who = kind.same ? first_names(kind.channels) : kind.channels[0];
    text += "  " + who + ": " + with_help(*kind.first);
    text += kind.same ? "\n" : " (alike: " + first_names(others) + ")\n";
  }
  if (kinds.size() > kOnScreen) text += "  and " + plural(kinds.size() - kOnScreen, "finding") + " more\n";
  return text;
}

}  // namespace

std::string inspection_text(const Inspection& inspection, std::size_t width) {
  const LogInfo& info = inspection.info;
  std::string text = summary_line(info) + "\n";
  std::string dialect = info.format;
  for (const std::string& fact : info.dialect) dialect += (dialect == info.format ? ": " : "; ") + printable(fact);
  text += "  read as " + dialect + "\n";
  for (const std::string& guess : info.guesses) text += "  guessed: " + printable(guess) + "\n";
  for (const Finding& warning : info.warnings.list())
    text += fmt::format("  {}: {}\n", warning.severity == Severity::note ? "note" : "warning",
                        sentence_of(warning) + detail::help_of(warning));
  text += terminal_table(is_listing(info) ? topic_table(info) : channel_table(inspection), {width});
  return text + remarks(inspection);
}

}  // namespace libchar
