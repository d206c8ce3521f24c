#include "libchar/report/text/characterization_text.hpp"

#include <fmt/format.h>

#include "libchar/characterize/compare/verification.hpp"
#include "libchar/core/text/readable.hpp"
#include "libchar/core/text/text.hpp"
#include "libchar/core/text/text_table.hpp"
#include "libchar/report/text/fit_text.hpp"
#include "libchar/report/text/limits_text.hpp"

namespace libchar {

std::string characterization_text(const CharacterizationView& view, const TextLook& look) {
  const Characterization& result = *view.result;
  const LogInfo& log = result.log;
  const double rate = log.time.rate_hz;
  const std::string length =
      rate > 0 ? fmt::format("{} Hz, {}",
                             brief_text(rate, 6),
                             duration_text(static_cast<double>(log.samples) / rate))
               : fmt::format("{} sample{}, rate unknown", log.samples, log.samples == 1 ? "" : "s");
  std::string text = fmt::format("{}: {} channel{}, {}, {} gap{}\n",
                                 printable(log.file),
                                 log.channels.size(),
                                 log.channels.size() == 1 ? "" : "s",
                                 length,
                                 log.time.gaps,
                                 log.time.gaps == 1 ? "" : "s");
  if (result.still) text += printable(result.still->sentence) + "\n";
  for (const ChannelView& channel : view.channels) {
    const ChannelResult& c = *channel.result;
    text += "\n" + (c.fit ? fit_text(c.channel, *c.fit, look) : printable(c.channel.name) + "\n");
    const Rating rating = channel.judgement.rating;
    text +=
        fmt::format("  {} {}\n",
                    tinted(fmt::format("{}:", rating_word(rating)), tint_of(rating), look.colours),
                    printable(channel.summary));
    if (c.verification)
      for (const std::string& sentence : c.verification->sentences)
        text += fmt::format("  {}\n", printable(sentence));
    text += findings_text(channel.judgement.findings, 5, look.colours);
  }
  if (result.limits) text += limits_text(*result.limits, look);
  return text;
}

std::string characterization_text(const Characterization& result, const TextLook& look) {
  return characterization_text(characterization_view(result), look);
}

}  // namespace libchar
