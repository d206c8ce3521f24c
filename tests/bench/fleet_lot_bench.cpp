// How often a lot's intervals cover, how often devices, batches and lots that are alike are called unlike, and what a
// hundred thousand devices take. Usage: fleet_lot_bench [lots = 2000] [devices = 100000] [parts = cbdtznks: coverage,
// batches, differences of two lots, temperatures, zone rules of charts, what is not detected, terms beside a random
// walk that is not, squares against their information] [FOLDER] With a folder: a fleet of that many devices with all of
// its results is written there, for `sensorchar fleet merge` to be measured.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "libchar/core/file/sha256.hpp"
#include "libchar/core/parallel/parallel.hpp"
#include "libchar/fit/noise_fit.hpp"
#include "libchar/fit/record/power_bins.hpp"
#include "libchar/fleet/detail/result_store.hpp"
#include "libchar/fleet/plan.hpp"
#include "libchar/lot/fleet_lot.hpp"
#include "libchar/report/html/fleet_report.hpp"
#include "tests/lot/made_fleet.hpp"

namespace {

using namespace libchar;

constexpr DeviceQuantity kQuantities[] = {DeviceQuantity::white_noise, DeviceQuantity::bias_instability,
                                          DeviceQuantity::random_walk, DeviceQuantity::turn_on_bias};

struct Tally {
  int lots = 0, mean = 0, spread = 0;
};

bool holds(const Interval& i, double value) { return i.low <= value && value <= i.high; }

void print_rate(const std::string& what, int count, int of, const std::string& expected) {
  const double share = static_cast<double>(count) / of;
  fmt::print("  {:<58} {:6.2f} % ± {:.2f}   expected {}\n", what, 100 * share,
             100 * std::sqrt(share * (1 - share) / of), expected);
}

void coverage(const std::string& title, const test::MadeLot& made, int lots) {
  Tally tally[4];
  int named = 0;
  for (int i = 0; i < lots; ++i) {
    const FleetLot lot = fleet_lot(test::made_lot(made, 1000000 + static_cast<std::uint64_t>(i)));
    named += lot.outlying > 0;
    for (const QuantityLot& q : lot.quantities) {
      if (q.of_kind || !q.figures) continue;
      const bool bias = q.quantity == DeviceQuantity::turn_on_bias;
      const std::size_t k = bias ? 3 : static_cast<std::size_t>(q.quantity);
      ++tally[k].lots;
      tally[k].mean += holds(q.figures->mean_ci95, bias ? made.bias : made.mean[k]);
      tally[k].spread += holds(q.figures->spread_ci95, bias ? made.bias_spread : made.spread[k]);
    }
  }
  fmt::print("{}: {} lots of {} devices\n", title, lots, made.devices);
  for (std::size_t k = 0; k < 4; ++k) {
    print_rate(title_of(kQuantities[k]) + ", mean in its interval", tally[k].mean, tally[k].lots, "95 %");
    print_rate(title_of(kQuantities[k]) + ", spread in its interval", tally[k].spread, tally[k].lots, "95 %");
  }
  print_rate("lots in which a device is named", named, lots, "at most 1 %");
}

bool any_difference(const FleetComparison& c) {
  for (const LotDifference& d : c.differences)
    if (d.mean_differs || d.spread_differs) return true;
  return false;
}

void comparisons(std::size_t devices, int lots) {
  test::MadeLot made, other;
  made.devices = other.devices = devices;
  other.mean[0] *= 1.03;
  other.spread[1] *= 1.5;
  int alike = 0, mean = 0, spread = 0, covered = 0;
  for (int i = 0; i < lots; ++i) {
    const auto seed = 5000000 + 3 * static_cast<std::uint64_t>(i);
    const auto a = test::made_lot(made, seed);
    alike += any_difference(compare_lots(a, test::made_lot(made, seed + 1)));
    const FleetComparison c = compare_lots(a, test::made_lot(other, seed + 2));
    mean += c.differences[0].mean_differs;
    covered += holds(c.differences[0].change_ci95, 1.03);
    spread += c.differences[1].spread_differs;
  }
  fmt::print("two lots of {} devices each, 16 tests in all\n", devices);
  print_rate("lots alike, any difference", alike, lots, "at most 5 %");
  print_rate("white noise 3 % larger (spread 5 %), found", mean, lots, "");
  print_rate("the ratio in its interval", covered, lots, "95 %");
  print_rate("bias instability with 1.5 times the spread, found", spread, lots, "");
}

void batches(int lots) {
  int alarms = 0, tests = 0;
  for (int i = 0; i < lots; ++i) {
    test::MadeLot made;
    made.devices = 20;
    std::vector<DeviceRecord> records;
    for (int b = 0; b < 6; ++b) {
      made.batch = std::to_string(b);
      made.prefix = made.batch + "-";
      test::append(records,
                   test::made_lot(made, 9000000 + 6 * static_cast<std::uint64_t>(i) + static_cast<std::uint64_t>(b)));
    }
    for (const QuantityLot& q : fleet_lot(records).quantities)
      if (!q.of_kind && q.batch_difference) {
        ++tests;
        alarms += q.batch_difference->p < 0.05;
      }
  }
  fmt::print("six batches of 20 devices\n");
  print_rate("batches alike, p below .05", alarms, tests, "5 %");
}

/// Slopes of the bias over temperature: of each device, their mean and spread, and how the bias repeats beside them.
void temperatures(const std::string& title, std::size_t devices, const test::MadeTemperatures& how, int lots) {
  test::MadeLot made;
  made.devices = devices;
  made.channels = {"gyro_x"};
  int device = 0, of_devices = 0, mean = 0, spread = 0, repeat = 0, bias = 0, bias_spread = 0;
  for (int i = 0; i < lots; ++i) {
    const auto drawn = test::made_temperature_lot(made, how, 11000000 + static_cast<std::uint64_t>(i));
    for (const QuantityLot& q : fleet_lot(drawn.records).quantities) {
      if (q.quantity == DeviceQuantity::turn_on_bias) {
        repeat += holds(q.repeats->within_ci95, how.scatter);
        bias += holds(q.figures->mean_ci95, made.bias);
        bias_spread += holds(q.figures->spread_ci95, made.bias_spread);
      }
      if (q.quantity != DeviceQuantity::temperature_coefficient) continue;
      mean += holds(q.figures->mean_ci95, how.slope);
      spread += holds(q.figures->spread_ci95, how.slope_spread);
      for (std::size_t d = 0; d < devices; ++d) device += holds(q.temperatures->slopes[d].ci95, drawn.slope[d]);
      of_devices += static_cast<int>(devices);
    }
  }
  fmt::print("temperature coefficients by recordings {}: {} lots of {} devices\n", title, lots, devices);
  print_rate("a device's coefficient in its interval", device, of_devices, "95 %");
  print_rate("their mean in its interval", mean, lots, "95 %");
  print_rate("their spread in its interval", spread, lots, "95 %");
  print_rate("repeatability of the bias in its interval", repeat, lots, "95 %");
  print_rate("mean of the bias in its interval", bias, lots, "95 %");
  print_rate("spread of the bias in its interval", bias_spread, lots, "95 %");
}

/// Charts of a process that stays, and of four that do not.
void charts(std::size_t values, int count) {
  const char* const kinds[] = {"stays", "shifts by 1.5 sigma half-way", "drifts by 3 sigma", "one value 6 sigma off"};
  fmt::print("control charts of {} values\n", values);
  for (int kind = 0; kind < 4; ++kind) {
    test::Gaussian gauss(31 + static_cast<std::uint64_t>(kind));
    int alarm = 0, any = 0;
    std::array<int, kZoneRules> signal{}, rule_alarm{};
    double chance = 0;
    for (int i = 0; i < count; ++i) {
      std::vector<double> x(values);
      for (std::size_t k = 0; k < values; ++k) {
        const double at = static_cast<double>(k) / static_cast<double>(values);
        x[k] = gauss() + (kind == 1 && at >= 0.5 ? 1.5 : kind == 2 ? 3 * at : 0.0);
      }
      if (kind == 3) x[values / 3] = 6;
      const ZoneFindings zones = control_chart(x).zones;
      alarm += zones.alarm;
      bool some = false;
      for (std::size_t r = 0; r < kZoneRules; ++r) {
        signal[r] += zones.rule[r].signals > 0;
        rule_alarm[r] += zones.rule[r].alarm;
        some = some || zones.rule[r].signals > 0;
      }
      any += some;
      chance = zones.any_by_chance;
    }
    print_rate(std::string("process ") + kinds[kind] + ": alarm", alarm, count, kind == 0 ? "at most 1 %" : "");
    print_rate("  any signal", any, count, kind == 0 ? fmt::format("{:.0f} %", 100 * chance) : "");
    for (std::size_t r = 0; r < kZoneRules; ++r)
      fmt::print("    {:<20} signal {:5.1f} %, alarm {:5.2f} %\n", name_of(static_cast<ZoneRule>(r)),
                 100.0 * signal[r] / count, 100.0 * rule_alarm[r] / count);
  }
}

/// Fits of records of 8192 samples of white noise with a second term, as devices of a lot of this
/// mean and spread have them.
std::vector<Coefficient> fits_of_lot(Term term, double mean, double spread, std::size_t count) {
  constexpr std::size_t kSamples = 8192, kChunk = 50;
  const bool walk = term == Term::walk;
  FitOptions options;
  options.second_opinion = options.remedies = false;
  std::vector<Coefficient> out(count);
  parallel::for_each(0, count / kChunk, [&](std::size_t c) {
    test::NoiseSource source(kSamples, 1, 4711 + c);
    test::Gaussian gauss(99 + c);
    for (std::size_t i = c * kChunk; i < (c + 1) * kChunk; ++i) {
      const double truth = mean * std::exp(spread * gauss());
      const std::vector<double> y = source.record(1, walk ? 0 : truth, walk ? truth : 0);
      out[i] = fit_power_bins(power_bins(y, 1), 1, kSamples, nullptr, options)[term];
    }
  });
  return out;
}

/// A lot's records, each with one of the fits.
std::vector<DeviceRecord> lot_of_fits(const std::vector<Coefficient>& fits, Term term, std::size_t devices,
                                      test::Gaussian& gauss) {
  test::MadeLot made;
  made.devices = devices;
  made.channels = {"gyro_x"};
  std::vector<DeviceRecord> records = test::made_lot(made, 1);
  for (DeviceRecord& r : records) {
    Characterization one;
    ChannelResult& channel = one.channels.emplace_back();
    channel.channel = {"gyro_x", "deg/s"};
    channel.quality.samples = 8192;
    channel.fit.emplace();
    const auto k = static_cast<std::size_t>(gauss.uniform() * static_cast<double>(fits.size()));
    channel.fit->term[static_cast<std::size_t>(term)] = fits[k];
    r.channels = record_of(one).channels;
  }
  return records;
}

/// How squares of devices that are alike scatter, against what the information at the truth says.
void squares(Term term) {
  for (const double times : {0.5, 1.0, 1.5, 2.0, 4.0}) {
    const double c = times * (term == Term::walk ? 3.3e-3 : 0.063), truth = c * c;
    double count = 0, bias = 0, square = 0, near = 0, by_information = 0, skewness = 0, third = 0;
    const std::vector<Coefficient> fits = fits_of_lot(term, c, 0, 12000);
    for (const Coefficient& fit : fits) bias += (fit.in_all->square - truth) / 12000;
    for (const Coefficient& fit : fits) {
      const SquareInAll& q = *fit.in_all;
      const double off = q.square - truth - bias;
      ++count;
      square += off * off;
      third += off * off * off;
      if (std::abs(q.square / truth - 1) > 0.2) continue;
      ++near;
      by_information += q.sd * q.sd;
      skewness += q.skewness;
    }
    const double sd = std::sqrt(square / count), r = std::sqrt(by_information / near) / truth;
    fmt::print(
        "{} {:.2g}: sd/square {:.3f} by information; variance {:.3f} times ({:.3f} taken), skewness {:.2f} ({:.2f} by "
        "information), bias {:+.3f} sd ± .009\n",
        title_of(quantity_of(term)), c, r, sd * sd / (r * r * truth * truth), 1 + 0.55 * r / (1 + 1.5 * r),
        third / count / (sd * sd * sd), skewness / near, bias / sd);
  }
}

/// Lots of which some devices are not detected or doubtful.
void left_out_lots(Term term, int lots) {
  for (const double spread : {0.1, 0.3})
    for (const double times : {4.0, 2.0, 1.5, 1.0}) {
      // In units of what half of the records detect.
      const double mean = times * (term == Term::walk ? 3.3e-3 : 0.063);
      const std::vector<Coefficient> fits = fits_of_lot(term, mean, spread, 12000);
      const auto found =
          std::count_if(fits.begin(), fits.end(), [](const Coefficient& c) { return c.status == Status::detected; });
      fmt::print("{}, spread {}: detected in {:.0f} % of devices\n", title_of(quantity_of(term)), spread,
                 100.0 * static_cast<double>(found) / static_cast<double>(fits.size()));
      for (const std::size_t devices : {8, 20, 200}) {
        test::Gaussian gauss(61);
        int with_mean = 0, in_mean = 0, in_spread = 0, of_all = 0;
        double sum_mean = 0, sum_spread = 0;
        for (int i = 0; i < lots; ++i)
          for (const QuantityLot& q : fleet_lot(lot_of_fits(fits, term, devices, gauss)).quantities) {
            if (!q.figures || q.quantity != quantity_of(term)) continue;
            ++with_mean;
            of_all += !q.left_out;
            in_mean += holds(q.figures->mean_ci95, mean);
            in_spread += holds(q.figures->spread_ci95, spread);
            sum_mean += std::log(q.figures->mean / mean);
            sum_spread += q.figures->spread;
          }
        if (with_mean == 0) continue;
        fmt::print(
            "{} devices: {} of {} lots have figures, {} of them of all devices; off by {:+.1f} %, spread {:.3f}\n",
            devices, with_mean, lots, of_all, 100 * sum_mean / with_mean, sum_spread / with_mean);
        print_rate("true mean in its interval", in_mean, with_mean, "95 %");
        print_rate("true spread in its interval", in_spread, with_mean, "95 %");
      }
    }
}

/// Fits of 1000 s at 50 Hz with N = .005, B = .004 and this K, which is found in some of them.
std::vector<NoiseFit> neighbour_fits(double walk, std::size_t count) {
  constexpr std::size_t kSamples = 50000, kChunk = 50;
  FitOptions options;
  options.second_opinion = options.remedies = false;
  std::vector<NoiseFit> out(count);
  parallel::for_each(0, count / kChunk, [&](std::size_t c) {
    test::NoiseSource source(kSamples, 50, 815 + c);
    for (std::size_t i = c * kChunk; i < (c + 1) * kChunk; ++i) {
      const std::vector<double> y = source.record(5e-3, 4e-3, walk);
      out[i] = fit_power_bins(power_bins(y, 50), 50, kSamples, nullptr, options);
    }
  });
  return out;
}

/// The record of a device that has `own` times the noise of the record that was fitted.
RecordedChannel channel_of_fit(const NoiseFit& fit, double own) {
  Characterization one;
  ChannelResult& channel = one.channels.emplace_back();
  channel.channel = {"gyro_x", "deg/s"};
  channel.quality.samples = fit.samples;
  channel.fit = fit;
  RecordedChannel out = record_of(one).channels[0];
  for (RecordedValue& v : out.values) {
    for (double* x : {&v.value, &v.ci95.low, &v.ci95.high, &v.upper95}) *x *= own;
    if (!v.in_all) continue;
    for (double* x : {&v.in_all->square, &v.in_all->sd}) *x *= own * own;
  }
  return out;
}

/// Lots of fits of three terms: does the mean of one hold the truth whose neighbour is there and
/// not detected in most of them?
void neighbour_lots(double walk, int lots) {
  constexpr double kTruth[] = {5e-3, 4e-3};
  const std::vector<NoiseFit> fits = neighbour_fits(walk, 4000);
  const auto found = std::count_if(fits.begin(), fits.end(),
                                   [](const NoiseFit& fit) { return fit[Term::walk].status == Status::detected; });
  fmt::print("K = {}: detected in {:.0f} % of records\n", walk,
             100.0 * static_cast<double>(found) / static_cast<double>(fits.size()));
  test::Gaussian gauss(7);
  for (const std::size_t devices : {20, 60, 200})
    for (const double spread : {0.0, 0.1, 0.3}) {
      Tally tally[2];
      for (int i = 0; i < lots; ++i) {
        test::MadeLot made;
        made.devices = devices;
        made.channels = {"gyro_x"};
        std::vector<DeviceRecord> records = test::made_lot(made, 1);
        for (DeviceRecord& r : records) {
          const auto k = static_cast<std::size_t>(gauss.uniform() * static_cast<double>(fits.size()));
          r.channels = {channel_of_fit(fits[k], std::exp(spread * gauss()))};
        }
        for (const QuantityLot& q : fleet_lot(records).quantities) {
          const auto t = static_cast<std::size_t>(q.quantity);
          if (!q.figures || t > 1) continue;
          ++tally[t].lots;
          tally[t].mean += holds(q.figures->mean_ci95, kTruth[t]);
          tally[t].spread += holds(q.figures->spread_ci95, spread);
        }
      }
      const std::string what = fmt::format("{} devices, spread {}: ", devices, spread);
      for (int t = 0; t < 2; ++t) {
        const std::string term = t == 0 ? "N" : "B";
        print_rate(what + "mean of " + term, tally[t].mean, std::max(tally[t].lots, 1), "95 %");
        print_rate(what + "spread of " + term, tally[t].spread, std::max(tally[t].lots, 1), "95 %");
      }
    }
}

test::MadeLot large_lot(std::size_t devices) {
  test::MadeLot made;
  made.devices = devices;
  made.channels = {"accel_x", "accel_y", "accel_z", "gyro_x", "gyro_y", "gyro_z"};
  return made;
}

/// As a worker writes it, but not flushed to the disk one by one.
void write_result(const std::filesystem::path& folder, const DeviceRecord& record) {
  const std::string text = device_record_text(record);
  Sha256 hash;
  hash.update(text);
  std::filesystem::create_directories(folder);
  std::ofstream(folder / kRecordFile, std::ios::binary) << hash.finish() << '\n' << text;
}

void write_fleet(std::size_t devices, const std::filesystem::path& folder) {
  FleetPlan plan;
  for (const DeviceRecord& r : test::made_lot(large_lot(devices), 1)) {
    Sha256 hash;
    hash.update(r.device);
    FleetUnit unit;
    unit.device = plan.devices.size();
    unit.log = "/data/line7/" + r.log;
    unit.sha256 = hash.finish();
    unit.id = unit_id(unit);
    plan.devices.push_back({r.device, r.type, r.batch, "", unit.log, unit.sha256, {}, ""});
    write_result(folder / "results" / result_folder(unit.id), r);
    plan.units.push_back(std::move(unit));
  }
  write_plan(plan, folder);
}

void size_of_a_fleet(std::size_t devices) {
  auto from = std::chrono::steady_clock::now();
  const auto lap = [&](const std::string& what) {
    const auto now = std::chrono::steady_clock::now();
    fmt::print("  {:<30} {:6.2f} s\n", what, std::chrono::duration<double>(now - from).count());
    from = std::chrono::steady_clock::now();
  };
  fmt::print("{} devices of six channels\n", devices);
  std::vector<std::string> lines;
  for (const DeviceRecord& r : test::made_lot(large_lot(devices), 1)) lines.push_back(device_record_text(r));
  lap("records made and written");
  std::vector<DeviceRecord> records;
  for (const std::string& line : lines) records.push_back(parse_device_record(line, "fleet"));
  lap("records read");
  const FleetLot lot = fleet_lot(records);
  lap("the lot");
  const auto folder = std::filesystem::temp_directory_path() / "libchar-fleet-lot-bench";
  const auto files = write_fleet_report({records, &lot, "", {}, {}}, folder, true);
  lap("page, document, tables");
  for (const std::string& file : files)
    fmt::print("  {:<30} {:6.1f} MB\n", std::filesystem::path(file).filename().string(),
               static_cast<double>(std::filesystem::file_size(file)) / 1e6);
  std::filesystem::remove_all(folder);
}

}  // namespace

int main(int argc, char** argv) {
  const int lots = argc > 1 ? std::atoi(argv[1]) : 2000;
  const std::size_t devices = argc > 2 ? static_cast<std::size_t>(std::atol(argv[2])) : 100000;
  const std::string parts = argc > 3 ? argv[3] : "cbdtznks";
  const auto asked = [&](char part) { return lots > 0 && parts.find(part) != std::string::npos; };
  test::MadeLot few, equal;
  few.devices = 8;
  for (double& s : equal.spread) s = 0;
  equal.bias_spread = 0;
  if (asked('c')) {
    coverage("a lot", {}, lots);
    coverage("a small lot", few, lots);
    coverage("devices without a spread", equal, lots);
  }
  if (asked('b')) batches(lots / 4);
  if (asked('d'))
    for (const std::size_t n : {5, 30, 200}) comparisons(n, lots);
  if (asked('t')) {
    for (const std::size_t n : {8, 20, 200}) temperatures("at -20, 25, 60 and 25 °C", n, {}, lots);
    temperatures("at three temperatures, slopes hardly differ", 20, {.at_c = {-20, 25, 60}, .slope_spread = 1e-4},
                 lots);
    temperatures("at three temperatures, slopes differ much", 20, {.at_c = {-20, 25, 60}, .slope_spread = 2e-3}, lots);
  }
  if (asked('z'))
    for (const std::size_t n : {8, 20, 50, 200, 1000, 10000}) charts(n, n > 1000 ? lots : 10 * lots);
  if (asked('n'))
    for (const Term term : {Term::flicker, Term::walk}) left_out_lots(term, lots);
  if (asked('s'))
    for (const Term term : {Term::flicker, Term::walk}) squares(term);
  if (asked('k'))
    for (const double walk : {0.0, 2.5e-4, 5e-4, 1e-3}) neighbour_lots(walk, lots);
  if (argc > 4)
    write_fleet(devices, argv[4]);
  else if (devices > 0)
    size_of_a_fleet(devices);
  return 0;
}
