#include "libchar/log/time/column_choice.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "libchar/core/error.hpp"
#include "libchar/core/text.hpp"

namespace libchar {
namespace {

// "time_us" -> {"time", "us"}; "Time [ns]" -> {"time", "ns"}.
std::pair<std::string, std::string> split_unit(std::string_view name) {
  std::string text = ascii_lower(name);
  if (!text.empty() && (text.back() == ']' || text.back() == ')')) text.pop_back();
  const std::size_t at = text.find_last_of("_[( ");
  if (at == std::string::npos) return {text, ""};
  std::string stem = text.substr(0, at);
  stem.erase(stem.find_last_not_of("_[( ") + 1);
  return {stem, text.substr(at + 1)};
}

std::optional<std::size_t> find_column(const std::vector<std::string>& names,
                                       const std::string& wanted) {
  const auto found = std::find(names.begin(), names.end(), wanted);
  if (found != names.end()) return static_cast<std::size_t>(found - names.begin());
  if (wanted.size() < 2 || wanted[0] != 'c') return std::nullopt;
  std::size_t index = 0;
  const auto [end, status] =
      std::from_chars(wanted.data() + 1, wanted.data() + wanted.size(), index);
  const bool position =
      status == std::errc() && end == wanted.data() + wanted.size() && index < names.size();
  return position ? std::optional(index) : std::nullopt;
}

[[noreturn]] void refuse_unknown(const std::vector<std::string>& names,
                                 const std::string& wanted,
                                 const std::string& what,
                                 const std::string& file,
                                 const ReadOptions& options) {
  throw Error({ErrorKind::usage,
               "E0320",
               file,
               "has no " + what,
               wanted,
               channel_hint(wanted, names, options)});
}

}  // namespace

std::string channel_hint(const std::string& wanted,
                         const std::vector<std::string>& names,
                         const ReadOptions& options) {
  const std::size_t shown = std::min<std::size_t>(names.size(), 12);
  const std::string all = fmt::format(
      "{}{}",
      fmt::join(names.begin(), names.begin() + static_cast<std::ptrdiff_t>(shown), ", "),
      shown < names.size() ? ", …" : "");
  if (std::find(options.names.begin(), options.names.end(), wanted) != options.names.end())
    return "-c chooses by the names in the log, " + all + ", and --names then name what was chosen";
  const auto near = nearest(wanted, names);
  return near ? fmt::format("did you mean {}?", *near) : "it has " + all;
}

bool is_time_name(std::string_view name) {
  static const std::vector<std::string> kStems = {"t", "time", "timestamp", "stamp", "timestamps"};
  const auto known = [&](const std::string& text) {
    return std::find(kStems.begin(), kStems.end(), text) != kStems.end();
  };
  const auto [stem, unit] = split_unit(name);
  return known(ascii_lower(name)) || (known(stem) && (unit.empty() || nanoseconds_in(unit) != 0 ||
                                                      unit == "sec" || unit == "stamp"));
}

std::string time_unit_of_name(std::string_view name) {
  const std::string unit = split_unit(name).second;
  if (unit == "sec") return "s";
  return nanoseconds_in(unit) != 0 ? unit : "";
}

std::int64_t nanoseconds_in(std::string_view unit) {
  if (unit == "s") return 1'000'000'000;
  if (unit == "ms") return 1'000'000;
  if (unit == "us") return 1'000;
  return unit == "ns" ? 1 : 0;
}

std::string guess_time_unit(double first, double step, bool integer) {
  // A calendar stamp of our time is 1.x e9 s, e12 ms, e15 us, e18 ns.
  const double size = std::abs(first);
  if (size > 1e17) return "ns";
  if (size > 1e14) return "us";
  if (size > 1e11) return "ms";
  if (!integer) return "s";
  if (step >= 5e4) return "ns";  // relative counts: what gives a rate between 1 Hz and 20 kHz
  if (step >= 50) return "us";
  return step > 1 || size > 2e9 ? "ms" : "s";
}

ColumnChoice choose_columns(const std::vector<std::string>& names,
                            bool named,
                            const ReadOptions& options,
                            const std::string& file) {
  ColumnChoice choice;
  if (options.time_column == "auto") {
    if (named) {
      const auto found = std::find_if(names.begin(), names.end(), is_time_name);
      if (found != names.end()) choice.time = static_cast<std::size_t>(found - names.begin());
    }
  } else if (options.time_column != "none") {
    choice.time = find_column(names, options.time_column);
    if (!choice.time)
      refuse_unknown(names, options.time_column, "column of this name for the time", file, options);
  }
  std::vector<bool> wanted(names.size(), options.channels.empty());
  for (const std::string& name : options.channels) {
    const auto index = find_column(names, name);
    if (!index) refuse_unknown(names, name, "channel of this name", file, options);
    if (index == choice.time)
      throw Error({ErrorKind::usage,
                   "E0320",
                   file,
                   "the time column cannot be a channel too",
                   name,
                   "--time-column none reads it as a channel"});
    wanted[*index] = true;
  }
  for (std::size_t i = 0; i < names.size(); ++i)
    if (wanted[i] && choice.time != i) choice.values.push_back(i);
  if (choice.values.empty())
    throw Error(
        {ErrorKind::input, "E0310", file, "has no channel besides its time column", "", ""});
  return choice;
}

}  // namespace libchar
