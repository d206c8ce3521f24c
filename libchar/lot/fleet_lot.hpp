#pragma once
// A fleet's devices side by side: what they have in common by type, channel and batch, who does not belong to it, and
// who keeps a data sheet's limits.
//
//   FleetLot lot = fleet_lot(records);
//   for (const QuantityLot& q : lot.quantities) …   // "gyro_x", bias instability: mean, spread, batches, chart
//
// Result and order of everything in it depend on what the records say, not on the order in which they come.

#include <array>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "libchar/core/numeric/interval.hpp"
#include "libchar/core/numeric/random_effects.hpp"
#include "libchar/lot/control_chart.hpp"
#include "libchar/lot/device_record.hpp"
#include "libchar/model/noise_limits.hpp"

namespace libchar {
// What the mean and the spread of those counted say of all devices of a lot, those not detected or doubtful among them.

struct LotCounts;

struct LeftOut {
  double share = 0;    ///< of the devices that have a result: not detected or doubtful
  Interval mean_ci95;  ///< of all of them, in the unit of the values: holds what is possible whichever they are
  /// The mean of those counted is off by this factor at most: too large, of a temperature coefficient too far from
  /// zero.
  double factor = 1;
  double spread_high = 0;  ///< upper end of the spread of all; NaN of a temperature coefficient
};

/// Nothing where all count, and of quantities that are not left out for being small.
std::optional<LeftOut> left_out(DeviceQuantity quantity, const LotCounts& counts, std::span<const double> value,
                                std::span<const double> variance, const RandomEffects& effects);

// Which batch each device of a fleet is of. A batch is of a production lot: a device has one, whatever its recordings
// say.

struct DeviceBatches {
  std::vector<std::size_t> device_of;  ///< of each record; devices are numbered as they come
  /// Of each device: the first, in natural order, of the batches stated by its recordings.
  std::vector<std::string> batch;
  /// Devices with recordings in several, by name and where they count; empty: none.
  std::string note;
};

/// One name and type is one device.
DeviceBatches device_batches(std::span<const DeviceRecord> records);

/// "batch 7", "no batch".
std::string batch_title(const std::string& batch);

struct FleetLotOptions {
  /// Of each type of device; "": of all types not named.
  std::map<std::string, NoiseLimits> limits;
  /// Of naming any device of a fleet without outliers: each quantity of each channel, and of each kind of channels,
  /// gets its share.
  double outlier_probability = 0.01;
  std::size_t worst = 100;  ///< devices in the list of the worst
};

/// How many devices of a group (of a kind: channels of devices) have a value that counts, and why the others have none.
struct LotCounts {
  std::size_t members = 0;
  std::size_t counted = 0;       ///< detected
  std::size_t not_detected = 0;  ///< upper limit only
  std::size_t doubtful = 0;      ///< undetermined or misfit
  std::size_t spoilt = 0;        ///< a bad finding concerns it
  std::size_t no_result = 0;     ///< no fit, or the quantity is not in it
};

/// In the unit of the values: exp of the logarithms for coefficients.
struct LotFigures {
  double mean = 0;
  Interval mean_ci95;
  double spread = 0;  ///< of coefficients relative (standard deviation of the logarithm), of others in their unit
  Interval spread_ci95;
};

/// Of the values, where LotFigures is of their logarithms.
struct ArithmeticFigures {
  double mean = 0;
  Interval mean_ci95;
  double sd = 0;  ///< of the devices
  Interval sd_ci95;
};

/// 0, 2.5, 25, 50, 75, 97.5 and 100 % of the values lie below.
inline constexpr std::array<double, 7> kLotQuantiles = {0, 0.025, 0.25, 0.5, 0.75, 0.975, 1};

struct BatchLot {
  std::string batch;
  LotCounts counts;
  std::optional<LotFigures> figures;
  std::size_t in_figures = 0;  ///< more than `counted` where those not detected or doubtful are in them
  double median = kNone;
};

/// Do batches differ by more than their devices let expect?
struct BatchDifference {
  double between = 0;  ///< standard deviation from batch to batch; relative where the quantity is compared as logarithm
  Interval between_ci95;
  double within = 0;  ///< from device to device in a batch
  double p = 1;       ///< of as large differences of batches that are alike
};

/// Recordings of a device that lie this far apart, in °C, are at several temperatures: a line through their biases has
/// a slope. The slope does not merely show the error of a temperature that is stated to a degree: 1 °C of 10 makes it
/// too small by 2 %.
inline constexpr double kLeastTemperatureSpan = 10;

/// From recording to recording of one device: for a turn-on bias, its repeatability; what temperature does to it is
/// taken out of devices that were recorded at several.
struct RepeatedDevices {
  /// With more recordings that count than it takes for their mean, or their line over temperature; and those.
  std::size_t devices = 0, recordings = 0;
  double within = 0;  ///< as `spread` of LotFigures
  Interval within_ci95;
};

/// A device's bias over the temperatures of its recordings.
struct DeviceSlope {
  std::size_t recording = 0,
              channel = 0;  ///< indices into the records: the device's first recording
  std::size_t recordings = 0;
  Interval temperature_c;
  double value = 0;  ///< per K
  Interval ci95;
};

/// Devices that were recorded at several temperatures. Of a turn-on bias: it is theirs at `reference_c`, by their
/// lines. Of a temperature coefficient: it is the slope of these lines.
struct TemperatureRuns {
  std::size_t devices = 0, recordings = 0;
  Interval range_c;
  double reference_c = 0;     ///< the median of the recordings
  std::size_t elsewhere = 0;  ///< devices whose recordings are all as far from it as that, at one temperature
  double repeatability =
      kNone;  ///< of the bias about the lines: the error of the slopes; NaN: no temperature was there twice
  Interval repeatability_ci95;
  double dof = 0;                    ///< by which it is known
  std::size_t in_one_recording = 0;  ///< devices whose coefficient was found in a recording as well: not mixed in
  std::vector<DeviceSlope> slopes;   ///< of a temperature coefficient, in the order of the devices
};

struct FleetOutlier {
  std::size_t recording = 0,
              channel = 0;    ///< indices into the records: the device's first recording
  bool all_channels = false;  ///< of a kind: the device by all of its channels together, from `channel` on
  double value = 0;           ///< of these the geometric mean
  double ratio = 1;           ///< to the mean of the others, of what is compared as logarithm
  double deviation = 0;       ///< from the others, in standard deviations of that difference
  double p = 1;               ///< of such a large deviation of any device
  std::string sentence;
};

/// One quantity of one channel of all devices of a type, or of all channels of a kind. What was recorded in several
/// units of one quantity is converted to that of most recordings.
struct QuantityLot {
  std::string type, group;  ///< "gyro_x", or "angular_rate in deg/s"
  bool of_kind = false;
  DeviceQuantity quantity = DeviceQuantity::white_noise;
  std::string channel_unit, unit;  ///< of the values
  LotCounts counts;
  std::optional<RandomEffects> effects;  ///< of ln(value) or of the value, as effects_of says
  std::optional<LotFigures> figures;
  std::optional<ArithmeticFigures> arithmetic;  ///< of what is compared as logarithm
  bool of_all = false;                          ///< the figures are also of devices that are not detected or doubtful
  std::optional<LeftOut> left_out;              ///< what figures of those counted say of all
  std::array<double, kLotQuantiles.size()> quantiles{};  ///< of those counted
  Histogram histogram;                                   ///< of ln(value) or of the value
  std::vector<BatchLot> batches;                         ///< in natural order; empty where there is one
  std::optional<BatchDifference> batch_difference;
  std::optional<RepeatedDevices> repeats;
  std::optional<TemperatureRuns> temperatures;
  // Of a channel only, not of a kind:
  std::optional<ControlChart> chart;  ///< by batch and device; its indices are those of `charted`
  std::vector<std::size_t> charted;   ///< recording of each value of the chart
  std::optional<Capability> capability;
  // Of a channel among devices; of a kind the devices by all of their channels, or, where one device has all, its
  // channels:
  bool searched = false;               ///< there are enough to find outliers
  std::vector<FleetOutlier> outliers;  ///< worst first
};

/// A device that is an outlier or fails a limit.
struct WorstDevice {
  std::size_t recording = 0;  ///< its first
  double p = 1;               ///< the least of its reasons'
  double deviation = 0;       ///< in standard deviations, of that reason
  std::vector<std::string> reasons;
};

struct FleetLot {
  std::size_t devices = 0;
  std::vector<std::size_t> order;    ///< recordings by type, batch, device and log; copies of one log are left out
  std::vector<std::size_t> failed;   ///< of these, those that could not be characterized
  std::vector<std::size_t> awaited;  ///< and those whose result is not there yet
  std::vector<std::string> types, batches;         ///< in natural order
  std::vector<std::size_t> batch_of;               ///< of each record, that of its device
  std::vector<QuantityLot> quantities;             ///< kinds first, channel by channel then
  std::vector<WorstDevice> worst;                  ///< the worst first, at most as many as requested
  std::size_t outlying = 0;                        ///< devices that are outliers
  std::size_t failing = 0, open = 0, keeping = 0;  ///< devices, by all limits that hold for them
  std::vector<bool> stands_out, fails;             ///< one per record, that of its device
  std::vector<std::string> notes;                  ///< what was not compared, and why
  std::string verdict;                             ///< a paragraph
  /// What is known of their channels, one for each code: how many devices, and which; no notes.
  std::vector<Finding> findings;
};

/// Of a record, that of its device.
inline const std::string& batch_of(const FleetLot& lot, std::size_t record) {
  return lot.batches[lot.batch_of[record]];
}

/// Throws Error(usage) without any record, and as limits_for does.
FleetLot fleet_lot(std::span<const DeviceRecord> records, const FleetLotOptions& options = {});

// Two lots, or two batches of one, side by side: what differs, by how much, and by more than chance?
//
//   FleetComparison comparison = compare_lots(march, april, {.name_a = "March", .name_b = "April"});

struct CompareLotsOptions {
  std::string name_a = "A", name_b = "B";
  double false_alarm = 0.05;  ///< probability of any difference between lots that are alike
};

/// One quantity of one channel in both lots.
struct LotDifference {
  std::string type, group;  ///< of the channel
  DeviceQuantity quantity = DeviceQuantity::white_noise;
  std::string channel_unit, unit;
  LotCounts counts_a, counts_b;
  LotFigures a, b;
  /// Mean of B over that of A where the quantity is compared as logarithm, else B less A. The interval is of this one
  /// alone.
  double change = 1;
  Interval change_ci95;
  double p_mean = 1, p_spread = 1;  ///< of as large a difference of lots that are alike
  /// The same of any of all tests (Holm): below `false_alarm` the lots differ.
  double p_mean_of_all = 1, p_spread_of_all = 1;
  bool mean_differs = false, spread_differs = false;
  std::string sentence;
};

struct FleetComparison {
  std::string name_a, name_b;
  std::size_t devices_a = 0, devices_b = 0;
  std::size_t tests = 0;
  double false_alarm = 0.05;
  std::vector<LotDifference> differences;  ///< in the order of the groups, whatever the result
  std::vector<std::string> not_compared;   ///< what only one has, or too few of
  std::vector<std::string> notes;          ///< of units; the caller's on how the lots were made
  std::string verdict;
};

/// Throws Error(usage) where a lot has no record, and Error(input) where they have no channel in common.
FleetComparison compare_lots(std::span<const DeviceRecord> a, std::span<const DeviceRecord> b,
                             const CompareLotsOptions& options = {});

}  // namespace libchar
