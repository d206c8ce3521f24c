#include "libchar/lot/device_record.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "libchar/characterize/limits.hpp"
#include "libchar/characterize/verdict.hpp"
#include "libchar/core/json.hpp"
#include "libchar/core/json_reader.hpp"
#include "libchar/core/schema.hpp"
#include "libchar/core/units.hpp"
#include "libchar/core/version.hpp"
#include "libchar/fit/shaped_curves.hpp"
#include "libchar/lot/detail/record_scanner.hpp"

namespace libchar {
namespace {

bool same_number(double a, double b) {
  return a == b || (std::isnan(a) && std::isnan(b));
}

RecordedValue recorded(DeviceQuantity quantity, const Coefficient& c) {
  RecordedValue out;
  out.quantity = quantity;
  out.status = c.status;
  if (c.value) {
    out.value = *c.value;
    out.ci95 = c.ci95;
    out.sd = c.relative_sd;
  }
  if (c.upper95) out.upper95 = *c.upper95;
  return out;
}

RecordedValue turn_on_bias(const ChannelResult& channel, const NoiseFit& fit) {
  RecordedValue out;
  out.quantity = DeviceQuantity::turn_on_bias;
  out.value = channel.quality.mean;
  out.sd = std::sqrt(mean_noise_variance(fit));
  out.ci95 = {out.value - kNormal95 * out.sd, out.value + kNormal95 * out.sd};
  return out;
}

RecordedValue temperature_coefficient(const TemperatureEffect& effect) {
  RecordedValue out;
  out.quantity = DeviceQuantity::temperature_coefficient;
  if (effect.order == 0) {
    out.status = Status::not_detected;
    return out;
  }
  if (effect.like_drift) out.status = Status::undetermined;
  out.value = effect.coefficient[0];
  out.ci95 = effect.ci95;
  // Of the interval, which knows that the lag is estimated too.
  const double width = effect.ci95.high - effect.ci95.low;
  out.sd = std::isfinite(width) && width > 0 ? width / (2 * kNormal95) : effect.sd;
  return out;
}

RecordedChannel channel_record(const ChannelResult& channel, SampleKind data) {
  RecordedChannel out;
  out.name = channel.channel.name;
  out.unit = channel.channel.unit;
  out.samples = channel.quality.samples;
  out.missing = channel.quality.missing;
  out.problems = channel.problems;
  if (!channel.fit) return out;
  const NoiseFit& fit = *channel.fit;
  out.fitted = true;
  out.rate_hz = fit.rate_hz;
  out.duration_s = fit.duration_s;
  out.p = fit.goodness.p;
  for (std::size_t t = 0; t < kTerms; ++t)
    if (fit.term[t].status != Status::not_fitted)
      out.values.push_back(recorded(quantity_of(static_cast<Term>(t)), fit.term[t]));
  if (fit.gauss_markov && fit.gauss_markov->in_model) {
    out.values.push_back(recorded(DeviceQuantity::gauss_markov_sigma, fit.gauss_markov->sigma));
    out.values.push_back(recorded(DeviceQuantity::gauss_markov_time, fit.gauss_markov->tau_s));
  }
  if (data == SampleKind::rate) out.values.push_back(turn_on_bias(channel, fit));
  if (fit.temperature) out.values.push_back(temperature_coefficient(*fit.temperature));
  return out;
}

Json value_json(const RecordedValue& v) {
  Json out = {{"status", std::string(name_of(v.status))}};
  if (!std::isnan(v.value)) {
    out["value"] = json_number(v.value);
    out["ci95"] = Json::array({json_number(v.ci95.low), json_number(v.ci95.high)});
    out["sd"] = json_number(v.sd);
  }
  if (!std::isnan(v.upper95)) out["upper95"] = json_number(v.upper95);
  return out;
}

Json channel_json(const RecordedChannel& c) {
  Json out = {{"name", json_text(c.name)},
              {"unit", json_text(c.unit)},
              {"samples", c.samples},
              {"missing", c.missing}};
  if (c.fitted) {
    out["rate_hz"] = json_number(c.rate_hz);
    out["duration_s"] = json_number(c.duration_s);
    out["p"] = json_number(c.p);
    out["values"] = Json::object();
    for (const RecordedValue& v : c.values)
      out["values"][std::string(name_of(v.quantity))] = value_json(v);
  }
  for (const std::string& problem : c.problems) out["problems"].push_back(json_text(problem));
  return out;
}

// A record grows keys from version to version of the program: those we do not know are left alone.
MapReader open_level(const Document& node, const std::string& file, std::string path) {
  std::vector<std::string> keys;
  keys.reserve(node.map.size());
  for (const DocumentEntry& entry : node.map) keys.push_back(entry.key);
  return {node, file, std::move(path), std::move(keys)};
}

double end_of(const MapReader& map, const std::vector<Document>& ends, std::size_t k) {
  if (ends[k].kind == Document::Kind::null)
    return k == 0 ? kNone : std::numeric_limits<double>::infinity();
  if (ends[k].kind != Document::Kind::number) map.refuse("ci95", "an end is no number");
  return ends[k].number;
}

RecordedValue read_value(const MapReader& map, DeviceQuantity quantity) {
  RecordedValue out;
  out.quantity = quantity;
  out.status = *find_enum<Status>(map.word("status", words_of<Status>()));
  out.value = map.number_or("value", kNone, in_logarithm(quantity) ? kNotNegative : kAnyNumber);
  out.upper95 = map.number_or("upper95", kNone, kNotNegative);
  out.sd = map.number_or("sd", kNone, kNotNegative);
  if (!map.has("ci95")) return out;
  const std::vector<Document>& ends = map.list("ci95");
  if (ends.size() != 2) map.refuse("ci95", "expected a list of two numbers");
  out.ci95 = {end_of(map, ends, 0), end_of(map, ends, 1)};
  return out;
}

std::vector<RecordedValue> read_values(const MapReader& map) {
  std::vector<RecordedValue> out;
  for (const DocumentEntry& entry : map.node().map)
    if (const auto quantity = find_enum<DeviceQuantity>(entry.key))
      out.push_back(
          read_value(open_level(entry.value, map.file(), map.path_of(entry.key)), *quantity));
  std::sort(out.begin(), out.end(), [](const RecordedValue& a, const RecordedValue& b) {
    return a.quantity < b.quantity;
  });
  return out;
}

RecordedChannel read_record_channel(const MapReader& map) {
  RecordedChannel out;
  out.name = map.text("name");
  out.unit = map.text_or("unit", "");
  out.samples = map.count_or("samples", 0);
  out.missing = map.count_or("missing", 0);
  out.fitted = map.has("values");
  if (map.has("problems")) out.problems = map.texts("problems");
  if (!out.fitted) return out;
  out.rate_hz = map.number("rate_hz", kPositive);
  out.duration_s = map.number("duration_s", kPositive);
  out.p = map.number_or("p", kNone);
  out.values = read_values(open_level(map.require("values"), map.file(), map.path_of("values")));
  return out;
}

}  // namespace

DeviceQuantity quantity_of(Term term) {
  return static_cast<DeviceQuantity>(term);
}

std::optional<Term> term_of(DeviceQuantity quantity) {
  const auto at = static_cast<std::size_t>(quantity);
  return at < kTerms ? std::optional(static_cast<Term>(at)) : std::nullopt;
}

bool in_logarithm(DeviceQuantity quantity) {
  return quantity < DeviceQuantity::turn_on_bias;
}

std::string title_of(DeviceQuantity quantity) {
  if (const auto term = term_of(quantity)) return term_title(*term);
  switch (quantity) {
    case DeviceQuantity::gauss_markov_sigma:
      return "Gauss–Markov deviation";
    case DeviceQuantity::gauss_markov_time:
      return "Gauss–Markov time";
    case DeviceQuantity::turn_on_bias:
      return "Turn-on bias";
    default:
      return "Temperature coefficient";
  }
}

std::string unit_of(DeviceQuantity quantity, std::string_view channel_unit) {
  const std::string unit = channel_unit.empty() ? "U" : std::string(channel_unit);
  if (term_of(quantity)) return term_unit(name_of(quantity), unit);
  if (quantity == DeviceQuantity::gauss_markov_time) return "s";
  return quantity == DeviceQuantity::temperature_coefficient ? unit + "/K" : unit;
}

bool RecordedValue::operator==(const RecordedValue& o) const {
  return quantity == o.quantity && status == o.status && same_number(value, o.value) &&
         same_number(ci95.low, o.ci95.low) && same_number(ci95.high, o.ci95.high) &&
         same_number(sd, o.sd) && same_number(upper95, o.upper95);
}

bool RecordedChannel::operator==(const RecordedChannel& o) const {
  return name == o.name && unit == o.unit && rate_hz == o.rate_hz && duration_s == o.duration_s &&
         samples == o.samples && missing == o.missing && fitted == o.fitted &&
         same_number(p, o.p) && values == o.values && problems == o.problems;
}

const RecordedValue* RecordedChannel::find(DeviceQuantity quantity) const {
  for (const RecordedValue& v : values)
    if (v.quantity == quantity) return &v;
  return nullptr;
}

DeviceRecord record_of(const Characterization& result, SampleKind data) {
  DeviceRecord out;
  out.log = result.log.file;
  out.sha256 = result.log.sha256;
  out.program = version();
  if (result.limits) out.limits = result.limits->verdict;
  for (const ChannelResult& channel : result.channels) {
    out.channels.push_back(channel_record(channel, data));
    if (!channel.fit || !channel.fit->temperature) continue;
    const auto unit = find_unit(channel.fit->temperature->unit);
    if (unit && unit->symbol == "°C") out.temperature_c = channel.fit->temperature->mean;
  }
  return out;
}

Coefficient coefficient_of(const RecordedValue& v) {
  Coefficient out;
  out.status = v.status;
  if (!std::isnan(v.value)) {
    out.value = v.value;
    out.ci95 = v.ci95;
    out.relative_sd = v.sd;
  }
  if (!std::isnan(v.upper95)) out.upper95 = v.upper95;
  return out;
}

std::string device_record_text(const DeviceRecord& record) {
  Json out = {{"format", "device-record"},
              {"version", 1},
              {"device", json_text(record.device)},
              {"type", json_text(record.type)},
              {"batch", json_text(record.batch)},
              {"log", json_text(record.log)},
              {"sha256", record.sha256},
              {"settings", json_text(record.settings)},
              {"program", record.program}};
  if (record.temperature_c) out["temperature_c"] = json_number(record.temperature_c);
  for (const auto& [key, text] : {std::pair("report", &record.report),
                                  std::pair("limits", &record.limits),
                                  std::pair("problem", &record.problem)})
    if (!text->empty()) out[key] = json_text(*text);
  out["channels"] = Json::array();
  for (const RecordedChannel& channel : record.channels)
    out["channels"].push_back(channel_json(channel));
  return with_valid_text(std::move(out)).dump();
}

DeviceRecord parse_device_record(std::string_view text, const std::string& path) {
  if (auto scanned = scan_device_record(text)) return *std::move(scanned);
  return read_device_record(text, path);
}

DeviceRecord read_device_record(std::string_view text, const std::string& path) {
  const Document document = parse_json_document(text, path);
  check_format(document, path, "device-record", 1);
  const MapReader map = open_level(document, path, "");
  DeviceRecord out;
  out.device = map.text("device");
  out.type = map.text_or("type", "");
  out.batch = map.text_or("batch", "");
  out.log = map.text_or("log", "");
  out.sha256 = map.text_or("sha256", "");
  out.settings = map.text_or("settings", "");
  out.program = map.text_or("program", "");
  out.temperature_c = map.maybe_number("temperature_c");
  out.report = map.text_or("report", "");
  out.limits = map.text_or("limits", "");
  out.problem = map.text_or("problem", "");
  const std::vector<Document>& channels = map.list("channels");
  out.channels.reserve(channels.size());
  for (std::size_t i = 0; i < channels.size(); ++i) {
    out.channels.push_back(
        read_record_channel(open_level(channels[i], path, fmt::format("channels[{}]", i))));
    for (std::size_t k = 0; k < i; ++k)
      if (out.channels[k].name == out.channels[i].name)
        map.refuse("channels", "two channels have one name: " + out.channels[i].name);
  }
  return out;
}

}  // namespace libchar
