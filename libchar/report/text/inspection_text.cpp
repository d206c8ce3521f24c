#include "libchar/report/text/inspection_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "libchar/core/table/table.hpp"
#include "libchar/core/text/decimal.hpp"
#include "libchar/core/text/readable.hpp"
#include "libchar/core/text/spelling.hpp"
#include "libchar/core/text/text.hpp"
#include "libchar/core/units.hpp"

namespace libchar {
namespace {

// Enough digits to see a thousandth of the noise beside a large offset.
std::string beside_noise(double value, double noise) {
  const double ratio = noise > 0 ? std::abs(value) / noise : 1;
  return brief_text(
      value, std::clamp(static_cast<int>(std::ceil(std::log10(std::max(ratio, 1.0)))) + 4, 5, 16));
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
          Cell::shown(q.samples < 3 || constant ? "-" : brief_text(q.difference_kurtosis, 3),
                      q.difference_kurtosis)};
}

Table channel_table(const Inspection& inspection) {
  Table out("channel|unit|missing|mean|sd|min|max|LSB|saturated|kurtosis of differences");
  for (std::size_t c = 0; c < inspection.quality.size(); ++c)
    out.add(channel_row(inspection.info.channels[c], inspection.quality[c]));
  return out;
}

// "angular_velocity.x, … and 34 more": enough to see what a topic is about.
std::string some_fields(const LogTopic& topic) {
  if (!topic.why_not.empty()) return "not read: " + topic.why_not;
  std::string text;
  constexpr std::size_t kShown = 4;
  for (std::size_t i = 0; i < std::min(kShown, topic.fields.size()); ++i)
    text += (i == 0 ? "" : ", ") + printable(topic.fields[i].name, 40);
  if (topic.fields.size() > kShown)
    text += fmt::format(" and {} more", topic.fields.size() - kShown);
  return text;
}

std::vector<Cell> topic_row(const LogTopic& topic) {
  return {printable(topic.name, 60),
          topic.type.empty() ? "-" : printable(topic.type, 40),
          std::to_string(topic.rows),
          topic.rate_hz > 0 ? brief_text(topic.rate_hz, 4) + " Hz" : "-",
          some_fields(topic)};
}

// What sensors write first, what cannot be read last.
Table topic_table(const LogInfo& info) {
  const auto rank = [](const LogTopic& topic) {
    return !topic.why_not.empty() ? 2 : topic.sensor ? 0 : 1;
  };
  Table out("topic|type|rows|rate|fields");
  for (const int wanted : {0, 1, 2})
    for (const LogTopic& topic : info.topics)
      if (rank(topic) == wanted) out.add(topic_row(topic));
  return out;
}

// A remark as words and the numbers between them.
struct RemarkParts {
  std::vector<std::string> words, numbers;
};

RemarkParts parts_of(const std::string& remark) {
  RemarkParts out{{""}, {}};
  for (std::size_t i = 0; i < remark.size();) {
    std::size_t end = i;
    while (end < remark.size() &&
           std::string_view("0123456789.+-e").find(remark[end]) != std::string_view::npos)
      ++end;
    std::string number = remark.substr(i, end - i);
    while (!number.empty() && !parse_double(number)) number.pop_back();
    if (number.empty()) {
      out.words.back() += remark[i++];
      continue;
    }
    out.numbers.push_back(number);
    out.words.emplace_back();
    i += number.size();
  }
  return out;
}

// The same remark on several channels, its numbers as ranges.
struct RemarkGroup {
  std::vector<std::string> channels;
  std::vector<std::string> words, least, most;

  void add(const std::string& channel, const RemarkParts& parts) {
    channels.push_back(channel);
    for (std::size_t k = 0; k < parts.numbers.size(); ++k) {
      const double value = *parse_double(parts.numbers[k]);
      if (value < *parse_double(least[k])) least[k] = parts.numbers[k];
      if (value > *parse_double(most[k])) most[k] = parts.numbers[k];
    }
  }
  std::string line() const {
    std::string text = "  " + first_names(channels) + ": " + words[0];
    for (std::size_t k = 0; k < least.size(); ++k)
      text += (least[k] == most[k] ? least[k] : least[k] + "…" + most[k]) + words[k + 1];
    return text + "\n";
  }
};

// One line a kind of remark, not one a channel.
std::string remarks(const Inspection& inspection) {
  std::vector<RemarkGroup> groups;
  for (std::size_t c = 0; c < inspection.quality.size(); ++c)
    for (const std::string& suggestion : inspection.quality[c].suggestions) {
      const RemarkParts parts = parts_of(printable(suggestion));
      const auto known = std::find_if(groups.begin(), groups.end(), [&](const RemarkGroup& group) {
        return group.words == parts.words;
      });
      RemarkGroup& group =
          known != groups.end()
              ? *known
              : groups.emplace_back(RemarkGroup{{}, parts.words, parts.numbers, parts.numbers});
      group.add(printable(inspection.info.channels[c].name, 40), parts);
    }
  std::string text;
  for (const RemarkGroup& group : groups) text += group.line();
  return text;
}

}  // namespace

std::string inspection_text(const Inspection& inspection, std::size_t width) {
  const LogInfo& info = inspection.info;
  std::string text = summary_line(info) + "\n";
  std::string dialect = info.format;
  for (const std::string& fact : info.dialect)
    dialect += (dialect == info.format ? ": " : "; ") + printable(fact);
  text += "  read as " + dialect + "\n";
  for (const std::string& guess : info.guesses) text += "  guessed: " + printable(guess) + "\n";
  for (const Warning& warning : info.warnings.list())
    text += "  warning: " + sentence_of(warning) + "\n";
  text += terminal_table(is_listing(info) ? topic_table(info) : channel_table(inspection), {width});
  return text + remarks(inspection);
}

}  // namespace libchar
