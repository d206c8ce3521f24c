// A record as a line of JSON, and from any document, with what is wrong in it by line and key;
// lines as the program writes them are scanned: detail/record_scanner.cpp reads them key by key.
#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "libchar/core/document/coefficient_fields.hpp"
#include "libchar/core/document/document.hpp"
#include "libchar/lot/detail/record_scanner.hpp"
#include "libchar/lot/device_record.hpp"

namespace libchar {
namespace {

bool has_value(const RecordedValue& v) { return !std::isnan(v.value); }

void write_in_all(const Field& row, const RecordedValue& v, std::vector<Entry>& out) {
  if (v.in_all)
    out.push_back({std::string(row.key), std::vector<double>{v.in_all->square, v.in_all->sd, v.in_all->skewness}});
}

void read_in_all(const MapReader& at, std::string_view key, RecordedValue& v) {
  if (!at.has(key)) return;
  const std::vector<double> of = at.numbers(key);
  if (of.size() != 3 || !(of[1] > 0)) at.refuse(key, "expected a square, its standard deviation and its skewness");
  v.in_all = SquareInAll{of[0], of[1], of[2]};
}

// An end that is not known is null.
void write_ends(const Field& row, const RecordedValue& v, std::vector<Entry>& out) {
  out.push_back({std::string(row.key), std::vector<double>{v.ci95.low, v.ci95.high}});
}

void read_ends(const MapReader& at, std::string_view key, RecordedValue& v) {
  if (!at.has(key)) return;
  const std::vector<double> ends = at.numbers(key);
  if (ends.size() != 2) at.refuse(key, "expected a list of two numbers");
  v.ci95 = {ends[0], std::isnan(ends[1]) ? std::numeric_limits<double>::infinity() : ends[1]};
  if (v.ci95.low > v.ci95.high) at.refuse(key, "expected two numbers, the lower first");
}

const Fields<RecordedValue>& value_fields() {
  using T = RecordedValue;
  const FieldText valued = {.written = Written::if_known, .known = when<has_value>};
  static const Fields<T> rows = {
      field<&T::status>("status", {.written = Written::always, .required = true}),
      field<&T::value>("value", valued),
      custom<T, read_ends, write_ends>("ci95", "[low, high]", valued),
      field<&T::sd>("sd", {.range = kNotNegative,
                           .meaning = "relative, but of turn_on_bias and temperature_coefficient",
                           .written = Written::if_known,
                           .known = when<has_value>}),
      custom<T, read_in_all, write_in_all>(
          "square_in_all", "list of numbers",
          {.meaning = "square, its standard deviation and skewness in the model of all terms, none held at zero, where "
                      "they say more than value and sd"}),
      field<&T::upper95>("upper95", {.range = kNotNegative,
                                     .written = Written::if_known,
                                     .known = when<[](const T& v) { return !std::isnan(v.upper95); }>}),
  };
  return rows;
}

bool is_fitted(const RecordedChannel& c) { return c.fitted; }

void write_values(const Field& row, const RecordedChannel& c, std::vector<Entry>& out) {
  Entry values = part_entry(std::string(row.key), {});
  for (const RecordedValue& v : c.values)
    values.below.push_back(part_entry(std::string(name_of(v.quantity)), entries_of(value_fields(), v)));
  out.push_back(std::move(values));
}

void read_values(const MapReader& at, std::string_view key, RecordedChannel& c) {
  c.fitted = at.has(key);
  if (!c.fitted) return;
  for (const char* with : {"rate_hz", "duration_s"}) at.require(with);
  const MapReader values = at.map(key);
  for (const DocumentEntry& entry : values.node().map) {
    const auto quantity = find_enum<DeviceQuantity>(entry.key);
    if (!quantity) continue;
    const MapReader value = values.map(entry.key);
    RecordedValue& v = c.values.emplace_back();
    v.quantity = *quantity;
    read_fields(value_fields(), value, v);
    if (in_logarithm(*quantity)) value.number_or("value", kNone, kNotNegative);
  }
  std::sort(c.values.begin(), c.values.end(),
            [](const RecordedValue& a, const RecordedValue& b) { return a.quantity < b.quantity; });
}

const Fields<RecordedChannel>& channel_fields() {
  using T = RecordedChannel;
  static const Fields<T> rows = [] {
    auto values = custom<T, read_values, write_values>(
        "values", "map", {.meaning = "by quantity", .written = Written::if_known, .known = when<is_fitted>});
    values.field.below = value_fields().rows;
    const FieldText of_fit = {.range = kPositive, .written = Written::if_known, .known = when<is_fitted>};
    return Fields<T>{
        field<&T::name>("name", {.written = Written::always, .required = true}),
        field<&T::unit>("unit", {.written = Written::always}),
        field<&T::samples>("samples", {.written = Written::always}),
        field<&T::missing>("missing", {.written = Written::always}),
        field<&T::mean>("mean", {.meaning = "of the samples",
                                 .written = Written::if_known,
                                 .known = when<[](const T& c) { return !std::isnan(c.mean); }>}),
        field<&T::rate_hz>("rate_hz", of_fit),
        field<&T::duration_s>("duration_s", of_fit),
        field<&T::p>("p", {.meaning = "goodness of fit", .written = Written::if_known, .known = when<is_fitted>}),
        std::move(values),
        list_of<&T::findings>("findings", finding_fields()),
    };
  }();
  return rows;
}

}  // namespace

const Fields<DeviceRecord>& device_record_fields() {
  using T = DeviceRecord;
  static const Fields<T> rows = {
      constant<T>("format", "device-record"),
      constant<T>("version", std::uint64_t{1}),
      field<&T::device>("device", {.written = Written::always, .required = true}),
      field<&T::type>("type", {.written = Written::always}),
      field<&T::batch>("batch", {.written = Written::always}),
      field<&T::log>("log", {.written = Written::always}),
      field<&T::sha256>("sha256", {.meaning = "of the log", .written = Written::always}),
      field<&T::settings>("settings",
                          {.meaning = "name of what it was characterized with", .written = Written::always}),
      field<&T::program>("program", {.meaning = "version that characterized it", .written = Written::always}),
      field<&T::temperature_c>("temperature_c"),
      field<&T::report>("report", {.meaning = "folder of its own report"}),
      field<&T::limits>("limits", {.meaning = "verdict on its data sheet"}),
      field<&T::problem>("problem", {.meaning = "why its log could not be characterized"}),
      list_of<&T::findings>("findings", finding_fields()),
      list_of<&T::channels>("channels", channel_fields(), {.written = Written::always, .required = true}),
  };
  return rows;
}

std::string device_record_text(const DeviceRecord& record) {
  return document_of(device_record_fields(), record).dump();
}

DeviceRecord parse_device_record(std::string_view text, const std::string& path) {
  if (auto scanned = scan_device_record(text)) return *std::move(scanned);
  return read_device_record(text, path);
}

DeviceRecord read_device_record(std::string_view text, const std::string& path) {
  const Document document = parse_json_document(text, path);
  check_format(document, path, "device-record", 1);
  const MapReader map(document, path, "");
  DeviceRecord out;
  read_fields(device_record_fields(), map, out);
  for (std::size_t i = 0; i < out.channels.size(); ++i)
    for (std::size_t k = 0; k < i; ++k)
      if (out.channels[k].name == out.channels[i].name)
        map.refuse("channels", "two channels have one name: " + out.channels[i].name);
  return out;
}

}  // namespace libchar
