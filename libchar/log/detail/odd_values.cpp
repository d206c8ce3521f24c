#include "libchar/log/detail/odd_values.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "libchar/core/text/decimal.hpp"
#include "libchar/core/text/readable.hpp"
#include "libchar/core/text/text.hpp"

namespace libchar {

std::string missing_cells(const std::vector<Channel>& channels, const std::vector<std::uint64_t>& missing_per_channel) {
  std::string message = "empty or NaN cells, taken as missing samples";
  if (missing_per_channel.empty()) return message;
  message += " (";
  std::size_t listed = 0;
  for (std::size_t c = 0; c < missing_per_channel.size(); ++c) {
    if (missing_per_channel[c] == 0) continue;
    if (listed++ == 8) {
      message += ", …";
      break;
    }
    message += fmt::format("{}{} {}", listed == 1 ? "" : ", ", channels[c].name, missing_per_channel[c]);
  }
  return message + ")";
}

void OddPlaces::add(std::uint64_t row, std::size_t channel) {
  ++count;
  const std::pair place(row, channel);
  if (first.size() == kShown && !(place < first.back())) return;
  first.insert(std::upper_bound(first.begin(), first.end(), place), place);
  if (first.size() > kShown) first.pop_back();
}

void OddPlaces::add_block(std::uint64_t row, std::size_t channel, std::uint64_t n) {
  const bool known =
      std::any_of(first.begin(), first.end(), [&](const auto& place) { return place.second == channel; });
  if (!known && n > 0) add(row, channel);
  count += n - (!known && n > 0 ? 1 : 0);
}

void OddPlaces::say(std::string_view code, std::string_view sentence,
                    const std::function<std::string(std::uint64_t, std::size_t)>& place_of, Findings& findings) const {
  for (const auto& [row, channel] : first) findings.add(code, sentence, place_of(row, channel));
  if (count > first.size()) findings.add(code, sentence, "", count - first.size());
}

void say_apart(const std::vector<std::string>& names, const Turns& turns, Findings& findings) {
  constexpr double kApart = 0.02;  // of a turn: closer stamps are those of one instant
  for (std::size_t k = 1; k < turns.behind_s.size(); ++k) {
    const double behind = turns.behind_s[k];
    if (std::fabs(behind) > kApart * turns.period_s)
      findings.add("stamps_apart", "channels of one row never share a stamp: they were sampled one after the other",
                   fmt::format("{} {} {} {}", printable(names[k]), duration_text(std::fabs(behind)),
                               behind > 0 ? "behind" : "before", printable(names[0])));
  }
  const double period = turns.period_s;
  if (findings.find("stamps_apart") == nullptr || !(period > 0)) return;  // one row has no period
  const auto four_digits = [](double value) {
    const double unit = std::pow(10, 3 - std::floor(std::log10(value)));
    return shortest(std::round(value * unit) / unit);
  };
  findings.add("stamps_apart", "", {}, 0)
      .help.push_back({"A replay interpolates each by its own stamps to one grid.",
                       {{"resample_hz", period > 1 ? "1/" + four_digits(period) : four_digits(1 / period)}}});
}

}  // namespace libchar
