#include "libchar/report/inspection_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "libchar/core/decimal.hpp"
#include "libchar/core/text.hpp"
#include "libchar/core/text_table.hpp"

namespace libchar {
namespace {

// Enough digits to see a thousandth of the noise beside a large offset.
std::string beside_noise(double value, double noise) {
  const double ratio = noise > 0 ? std::abs(value) / noise : 1;
  return significant(
      value, std::clamp(static_cast<int>(std::ceil(std::log10(std::max(ratio, 1.0)))) + 4, 5, 16));
}

std::vector<std::string> channel_row(const Channel& channel, const ChannelQuality& q) {
  const double noise = q.standard_deviation;
  const bool constant = q.samples > 1 && q.minimum == q.maximum;
  return {printable(channel.name, 40),
          channel.unit.empty() ? "-" : printable(channel.unit, 20),
          std::to_string(q.missing),
          beside_noise(q.mean, noise),
          constant                             ? "constant"
          : q.samples < 2 || std::isnan(noise) ? "-"
                                               : significant(noise, 4),
          beside_noise(q.minimum, noise),
          beside_noise(q.maximum, noise),
          q.resolution ? significant(*q.resolution, 4) : "-",
          std::to_string(q.saturated),
          q.samples < 3 || constant ? "-" : significant(q.difference_kurtosis, 3)};
}

std::string channel_table(const Inspection& inspection, std::size_t width) {
  std::vector<std::vector<std::string>> rows = {{"channel",
                                                 "unit",
                                                 "missing",
                                                 "mean",
                                                 "sd",
                                                 "min",
                                                 "max",
                                                 "LSB",
                                                 "saturated",
                                                 "kurtosis of differences"}};
  for (std::size_t c = 0; c < inspection.quality.size(); ++c)
    rows.push_back(channel_row(inspection.info.channels[c], inspection.quality[c]));
  return text_table(rows, "  ", false, width);
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

std::string topic_table(const LogInfo& info, std::size_t width) {
  std::vector<std::vector<std::string>> rows = {{"topic", "type", "rows", "rate", "fields"}};
  for (const LogTopic& topic : info.topics)
    rows.push_back({printable(topic.name, 60),
                    topic.type.empty() ? "-" : printable(topic.type, 40),
                    std::to_string(topic.rows),
                    topic.rate_hz > 0 ? significant(topic.rate_hz, 4) + " Hz" : "-",
                    some_fields(topic)});
  return text_table(rows, "  ", true, width);
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
  const std::string front = printable(info.file) + ": warning: ";
  for (const Warning& warning : info.warnings.list())
    text += "  warning: " + one_line(warning, info.file).substr(front.size()) + "\n";
  text += is_listing(info) ? topic_table(info, width) : channel_table(inspection, width);
  for (std::size_t c = 0; c < inspection.quality.size(); ++c)
    for (const std::string& suggestion : inspection.quality[c].suggestions)
      text +=
          fmt::format("  {}: {}\n", printable(info.channels[c].name, 40), printable(suggestion));
  return text;
}

}  // namespace libchar
