#include "libchar/log/csv/head/stated_rate.hpp"

#include <algorithm>
#include <array>
#include <string>

#include "libchar/core/text/decimal.hpp"
#include "libchar/core/text/text.hpp"
#include "libchar/log/reading_fields.hpp"

namespace libchar::csv {
namespace {

constexpr std::string_view kBetween = " \t:=,;\"'()[]";

// The key in front of the first number of a line, its letters only, and what stands behind.
struct Statement {
  std::string key;
  std::optional<double> number;
  std::string_view unit;
};

Statement statement_in(std::string_view lower) {
  Statement out;
  const std::size_t word = lower.find("rate");
  const std::size_t at =
      lower.find_first_of("0123456789", word == std::string_view::npos ? 0 : word);
  if (at == std::string_view::npos) return out;
  for (const char c : lower.substr(0, at))
    if (c >= 'a' && c <= 'z') out.key += c;
  std::size_t end = at;
  while (end < lower.size() &&
         ((lower[end] >= '0' && lower[end] <= '9') || lower[end] == '.' || lower[end] == '+' ||
          lower[end] == '-' ||
          (lower[end] == 'e' && end + 1 < lower.size() &&
           std::string_view("+-0123456789").find(lower[end + 1]) != std::string_view::npos)))
    ++end;
  std::string text(lower.substr(at, end - at));
  while (!text.empty() && (text.back() == '.' || text.back() == '-')) text.pop_back();
  if (end < lower.size() && lower[end] == ',' && end + 1 < lower.size() && lower[end + 1] >= '0' &&
      lower[end + 1] <= '9' && text.find('.') == std::string::npos &&
      lower.substr(0, at).find(',') == std::string_view::npos) {  // a decimal comma
    const std::size_t stop = std::min(lower.find_first_not_of("0123456789", end + 1), lower.size());
    text += "." + std::string(lower.substr(end + 1, stop - end - 1));
    end = stop;
  }
  out.number = parse_double(text);
  const std::size_t unit = lower.find_first_not_of(kBetween, end);
  if (unit != std::string_view::npos) {
    const std::size_t stop = std::min(lower.find_first_of(kBetween, unit), lower.size());
    out.unit = lower.substr(unit, stop - unit);
  }
  return out;
}

template <std::size_t N>
bool ends_with_any(std::string_view key, const std::array<std::string_view, N>& ends) {
  return std::any_of(
      ends.begin(), ends.end(), [&](std::string_view end) { return key.ends_with(end); });
}

double hertz_of(const Statement& said) {
  static constexpr std::array<std::string_view, 16> kKeys = {"samplerate",
                                                             "samplingrate",
                                                             "samplesrate",
                                                             "outputrate",
                                                             "updaterate",
                                                             "acquisitionrate",
                                                             "scanrate",
                                                             "datarate",
                                                             "samplingfrequency",
                                                             "samplefrequency",
                                                             "samplefreq",
                                                             "samplingfreq",
                                                             "loggingrate",
                                                             "recordingrate",
                                                             "imurate",
                                                             "odr"};
  const bool rate =
      said.key.find("rate") != std::string::npos || said.key.find("frequency") != std::string::npos;
  const double factor = said.unit.starts_with("khz") ? 1e3 : said.unit.starts_with("mhz") ? 1e6 : 1;
  const bool hertz = said.unit.starts_with("hz") || said.unit.starts_with("khz") ||
                     said.unit.starts_with("mhz") || said.unit.starts_with("sps") ||
                     said.unit.starts_with("samples/s");
  if (rate && hertz && said.key.find("baud") == std::string::npos) return *said.number * factor;
  if (hertz || said.unit.empty() || !ends_with_any(said.key, std::array<std::string_view, 1>{"hz"}))
    return (hertz || said.unit.empty()) && ends_with_any(said.key, kKeys) ? *said.number * factor
                                                                          : 0;
  std::string_view key = said.key;  // "Sample Rate (Hz)": 100
  key.remove_suffix(2);
  const double kilo = key.ends_with("k") ? 1e3 : 1;
  if (kilo > 1) key.remove_suffix(1);
  return ends_with_any(key, kKeys) ? *said.number * kilo : 0;
}

double interval_of(const Statement& said) {
  static constexpr std::array<std::string_view, 9> kKeys = {"sampleinterval",
                                                            "samplinginterval",
                                                            "sampleperiod",
                                                            "samplingperiod",
                                                            "deltax",
                                                            "timestep",
                                                            "sampletime",
                                                            "samplingtime",
                                                            "xincrement"};
  std::string_view key = said.key, unit = said.unit;
  double factor = 1;
  if (unit == "ms") factor = 1e-3;
  if (unit == "us" || unit == "µs") factor = 1e-6;
  if (unit == "ns") factor = 1e-9;
  return ends_with_any(key, kKeys) ? *said.number * factor : 0;
}

}  // namespace

std::optional<double> stated_rate_hz(std::string_view line) {
  const std::string lower = ascii_lower(line);
  const Statement said = statement_in(lower);
  if (!said.number || said.key.empty()) return std::nullopt;
  double rate = hertz_of(said);
  if (rate == 0)
    if (const double interval = interval_of(said); interval > 0) rate = 1 / interval;
  if (!(rate >= kRates.lowest && rate <= kRates.highest)) return std::nullopt;
  return rate;
}

std::optional<double> stated_tick_s(std::string_view line) {
  const std::string lower = ascii_lower(line);
  const Statement said = statement_in(lower);
  return said.key == "tscale" && said.number && *said.number > 0 ? said.number : std::nullopt;
}

}  // namespace libchar::csv
