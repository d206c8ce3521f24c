#pragma once
// What a lot needs to know of one characterized device, in one line of JSON: a hundred thousand of them are read in
// seconds.
//
//   DeviceRecord record = record_of(characterize("imu7.csv"));
//   record.device = "imu7";
//   file << device_record_text(record) << '\n';

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "libchar/characterize/characterization.hpp"
#include "libchar/core/coefficient.hpp"
#include "libchar/core/document/enum_table.hpp"
#include "libchar/core/document/fields.hpp"
#include "libchar/core/noise_terms.hpp"
#include "libchar/core/not_known.hpp"

namespace libchar {
// The quantities that are compared from device to device.

/// What is known of a channel: the first five are the terms of core/noise_terms.hpp, in their order.
enum class DeviceQuantity : std::uint8_t {
  white_noise,
  bias_instability,
  random_walk,
  quantization,
  rate_ramp,
  gauss_markov_sigma,
  gauss_markov_time,
  turn_on_bias,             ///< mean of the samples
  temperature_coefficient,  ///< the linear one, at the mean temperature
};
template <>
inline constexpr auto enum_table<DeviceQuantity> =
    enum_words<DeviceQuantity,
               "white_noise bias_instability random_walk quantization rate_ramp gauss_markov_sigma gauss_markov_time "
               "turn_on_bias temperature_coefficient">;
inline constexpr std::size_t kDeviceQuantities = enum_table<DeviceQuantity>.size();

DeviceQuantity quantity_of(Term term);
std::optional<Term> term_of(DeviceQuantity quantity);
/// Never negative, and known by a relative uncertainty: compared as logarithm.
bool in_logarithm(DeviceQuantity quantity);
/// "White noise", "Turn-on bias"…
std::string title_of(DeviceQuantity quantity);
/// Of its values, for a channel in `channel_unit`; the thermometer's unit is K or °C.
std::string unit_of(DeviceQuantity quantity, std::string_view channel_unit);

/// One quantity of a channel; NaN: not known.
struct RecordedValue {
  DeviceQuantity quantity = DeviceQuantity::white_noise;
  Status status = Status::detected;
  double value = kNone;               ///< none where it is not detected
  Interval ci95 = {kNone, kNone};     ///< high infinite: no upper end
  double sd = kNone;                  ///< of ln(value) where the quantity is compared as logarithm, else of the value
  double upper95 = kNone;             ///< of what is not detected
  std::optional<SquareInAll> in_all;  ///< of a noise term, where it says more than value and sd (core/coefficient.hpp)
  bool operator==(const RecordedValue&) const;
};

struct RecordedChannel {
  std::string name, unit;
  double rate_hz = 0, duration_s = 0;
  std::uint64_t samples = 0, missing = 0;
  double mean = kNone;  ///< of the samples
  bool fitted = false;
  double p = kNone;                   ///< goodness of fit
  std::vector<RecordedValue> values;  ///< in the order of the enum, none twice; a term that was not fitted has none
  std::vector<Finding> findings;      ///< the worst first
  const RecordedValue* find(DeviceQuantity quantity) const;
  /// A bad finding concerns the quantity: its value is not that of the sensor.
  bool is_spoilt(DeviceQuantity quantity) const;
  bool operator==(const RecordedChannel&) const;
};

struct DeviceRecord {
  std::string device, type, batch;
  std::optional<double> temperature_c;  ///< at which it was recorded
  std::string log, sha256;              ///< the file, and its digest
  std::string settings;                 ///< what it was characterized with, by a name of the caller's
  /// What of the settings can make results differ; "": all of them. Not in the text: who has the settings knows it.
  std::string analysis;
  std::string program;  ///< version that characterized it
  std::string report;   ///< folder of its own report, relative to the page of the lot; "": none
  std::string limits;   ///< verdict on its data sheet; "": none was held against it
  std::string problem;  ///< why its log could not be characterized; "": it was
  /// What was dirty in its log and what was done; and what is known of the channels, where none could be fitted.
  std::vector<Finding> findings;
  bool awaited = false;  ///< `problem` is that the result is not there yet; not in the text
  std::vector<RecordedChannel> channels;
  bool operator==(const DeviceRecord&) const = default;
};

/// What a lot looks at. Device, type, batch, settings and report are the caller's to fill; the mean of a phase is not a
/// bias.
DeviceRecord record_of(const Characterization& result, SampleKind data = SampleKind::rate);

/// Of logs side by side: each is a device that is called as its file is (names_of_logs). Throws Error(input) for one
/// recording twice.
std::vector<DeviceRecord> records_of(std::span<const Characterization> results, SampleKind data = SampleKind::rate);

/// Once all channels of a recording are in its record. A single channel in °C among others is a thermometer: its mean
/// is the temperature of a recording that says none, and it has no turn-on bias and no temperature coefficient itself.
/// Where nothing was fitted, `problem` says why.
void finish_record(DeviceRecord& record);

/// Where its log was read and nothing in it could be fitted: why, in a sentence; else "".
std::string why_nothing_fitted(const DeviceRecord& record);

/// The coefficient again, as far as the record holds it, in the unit that `factor` converts to.
Coefficient coefficient_of(const RecordedValue& value, double factor = 1);

/// What a line says, with its schema.
const Fields<DeviceRecord>& device_record_fields();
/// One line of JSON without its newline: {"format":"device-record",…}. Every number reads back to the same double.
std::string device_record_text(const DeviceRecord& record);
/// Keys that are not known are left alone. Throws Error(input) with `path`, line, column and key.
DeviceRecord parse_device_record(std::string_view text, const std::string& path);

}  // namespace libchar
