#pragma once
// Records of devices drawn from known distributions.

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "libchar/lot/device_record.hpp"
#include "tests/support/noise.hpp"

namespace test {

/// What the devices of a lot are drawn from.
struct MadeLot {
  std::size_t devices = 200;
  std::vector<std::string> channels = {"gyro_x", "gyro_y"};
  double mean[3] = {5e-3, 2e-3, 3e-4};  ///< of N, B, K
  double spread[3] = {0.05, 0.2, 0.3};  ///< relative
  double sd[3] = {0.01, 0.1, 0.25};     ///< relative uncertainty of a device, within a factor of two
  double bias = 0.3, bias_spread = 0.1, bias_sd = 0.002;
  std::string prefix = "imu", type = "mems", batch = "1";
};

inline libchar::RecordedValue made_value(libchar::DeviceQuantity quantity, double mean, double spread, double sd,
                                         Gaussian& gauss) {
  libchar::RecordedValue v;
  v.quantity = quantity;
  v.sd = sd * std::exp2(gauss.uniform() - 0.5);
  const bool logarithm = libchar::in_logarithm(quantity);
  const double device = spread * gauss(), error = v.sd * gauss();
  // A fit finds the square of a coefficient without bias: ln c is too small by v on average.
  v.value = logarithm ? mean * std::exp(device + error - v.sd * v.sd) : mean + device + error;
  v.ci95 = logarithm ? libchar::Interval{v.value * std::exp(-1.96 * v.sd), v.value * std::exp(1.96 * v.sd)}
                     : libchar::Interval{v.value - 1.96 * v.sd, v.value + 1.96 * v.sd};
  return v;
}

inline libchar::DeviceRecord made_device(const MadeLot& lot, std::size_t number, Gaussian& gauss) {
  using libchar::DeviceQuantity;
  libchar::DeviceRecord r;
  r.device = lot.prefix + std::to_string(number);
  r.type = lot.type;
  r.batch = lot.batch;
  r.log = "logs/" + r.device + ".csv";
  r.sha256 = r.device + lot.batch;
  r.settings = "s";
  r.program = "0.1.0";
  r.report = "devices/" + r.device;
  for (const std::string& name : lot.channels) {
    libchar::RecordedChannel c;
    c.name = name;
    c.unit = "deg/s";
    c.rate_hz = 100;
    c.duration_s = 3600;
    c.samples = 360000;
    c.fitted = true;
    c.p = gauss.uniform();
    for (std::size_t t = 0; t < 3; ++t)
      c.values.push_back(made_value(static_cast<DeviceQuantity>(t), lot.mean[t], lot.spread[t], lot.sd[t], gauss));
    c.values.push_back(made_value(DeviceQuantity::turn_on_bias, lot.bias, lot.bias_spread, lot.bias_sd, gauss));
    r.channels.push_back(std::move(c));
  }
  return r;
}

inline std::vector<libchar::DeviceRecord> made_lot(const MadeLot& lot, std::uint64_t seed) {
  Gaussian gauss(seed);
  std::vector<libchar::DeviceRecord> out;
  for (std::size_t i = 0; i < lot.devices; ++i) out.push_back(made_device(lot, i + 1, gauss));
  return out;
}

/// Recordings of each device at temperatures: its turn-on bias moves with them, and scatters
/// whenever it is switched on.
struct MadeTemperatures {
  std::vector<double> at_c = {-20, 25, 60, 25};
  double reference_c = 25;
  double slope = 2e-3, slope_spread = 5e-4;  ///< per K
  double scatter = 0.02;
};

struct TemperatureLot {
  std::vector<libchar::DeviceRecord> records;
  std::vector<double> slope;  ///< of each device and channel, in the order of the devices
};

inline TemperatureLot made_temperature_lot(const MadeLot& lot, const MadeTemperatures& made, std::uint64_t seed) {
  Gaussian gauss(seed);
  TemperatureLot out;
  for (std::size_t i = 0; i < lot.devices; ++i) {
    const libchar::DeviceRecord device = made_device(lot, i + 1, gauss);
    std::vector<double> slopes;
    for (std::size_t c = 0; c < device.channels.size(); ++c) slopes.push_back(made.slope + made.slope_spread * gauss());
    for (std::size_t k = 0; k < made.at_c.size(); ++k) {
      libchar::DeviceRecord again = device;
      again.log += std::to_string(k);
      again.sha256 += std::to_string(k);
      again.temperature_c = made.at_c[k];
      for (std::size_t c = 0; c < again.channels.size(); ++c) {
        libchar::RecordedValue& bias = again.channels[c].values[3];
        bias.value += slopes[c] * (made.at_c[k] - made.reference_c) + made.scatter * gauss() + bias.sd * gauss();
      }
      out.records.push_back(std::move(again));
    }
    out.slope.insert(out.slope.end(), slopes.begin(), slopes.end());
  }
  return out;
}

/// The same device, recorded in rad/s.
inline void to_radians(libchar::DeviceRecord& record) {
  constexpr double factor = std::numbers::pi / 180;
  for (libchar::RecordedChannel& c : record.channels) {
    c.unit = "rad/s";
    for (libchar::RecordedValue& v : c.values) {
      v.value *= factor;
      v.ci95 = {factor * v.ci95.low, factor * v.ci95.high};
      if (!libchar::in_logarithm(v.quantity)) v.sd *= factor;
    }
  }
}

inline void append(std::vector<libchar::DeviceRecord>& to, const std::vector<libchar::DeviceRecord>& more) {
  to.insert(to.end(), more.begin(), more.end());
}

}  // namespace test
