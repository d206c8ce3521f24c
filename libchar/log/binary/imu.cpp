// The .imu files of the SMAC and EPFL tools (read.imu of the R packages avar, gmwm and wv): records
// of a time in seconds and six increments, three of angle and three of velocity, without a header.
// Which instrument wrote them decides the type and the scales, and must be told. rate = round(1 /
// mean step of the times); value = increment · rate · scale.

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "libchar/core/refusal.hpp"
#include "libchar/log/binary/rows.hpp"
#include "libchar/log/detail/format.hpp"

namespace libchar {
namespace {

constexpr double kDegree = std::numbers::pi / 180;
constexpr std::size_t kStampsLookedAt = 1000;

struct Preset {
  std::string_view name;
  NumberType type = NumberType::i32;
  double gyro_rad = 0, accel_m_s = 0;  // of one unit of an increment
};

constexpr std::array<Preset, 6> kPresets = {{
    {"IMAR", NumberType::i32, 0.1 / 3600 * kDegree, 0.00152588 / 1000},
    {"LN200", NumberType::i32, 1.0 / 2097152, 1.0 / 16384},
    {"LN200IG", NumberType::i32, 1.0 / 524288, 1.0 / 16384},
    {"IXSEA", NumberType::f64, 1.0 / 3600 * kDegree, 0.001},
    {"NAVCHIP_INT", NumberType::i32, 0.00000625, 0.0000390625},
    {"NAVCHIP_FLT", NumberType::f64, 1.0 / 3600 * kDegree, 0.001},
}};

std::string preset_names(NumberType type, bool all) {
  std::vector<std::string_view> names;
  for (const Preset& preset : kPresets)
    if (all || preset.type == type) names.push_back(preset.name);
  return fmt::format("{}", fmt::join(names, ", "));
}

const Preset& find_preset(const std::string& path, const std::string& wanted) {
  for (const Preset& preset : kPresets)
    if (preset.name == wanted) return preset;
  const std::string all = preset_names(NumberType::i32, true);
  if (wanted.empty())
    throw usage_error("E0468", path)
        .says("has no header; say which instrument wrote it")
        .hint("`preset` one of " + all);
  throw usage_error("E0468", path).says("no preset of .imu files").got(wanted).hint("use one of " + all);
}

std::uint64_t record_bytes(NumberType type) { return sizeof(double) + 6 * size_of(type); }

double stamp_of(const BinaryFile& file, std::uint64_t row, NumberType type) {
  std::array<std::byte, sizeof(double)> bytes{};
  file.read(row * record_bytes(type), bytes);
  double value = 0;
  read_numbers(bytes.data(), bytes.size(), {NumberType::f64, false}, {&value, 1});
  return value;
}

// Do the times rise as those of a sensor do, at the beginning and over the whole?
bool times_rise(const BinaryFile& file, NumberType type) {
  const std::uint64_t rows = file.size() / record_bytes(type);
  if (rows < 2) return false;
  double before = stamp_of(file, 0, type);
  const auto sane = [](double t) { return std::abs(t) < 1e10; };
  if (!sane(before)) return false;
  for (std::uint64_t row = 1; row < std::min<std::uint64_t>(rows, kStampsLookedAt); ++row) {
    const double stamp = stamp_of(file, row, type);
    if (!sane(stamp) || !(stamp > before) || stamp - before > 1000) return false;
    before = stamp;
  }
  const double last = stamp_of(file, rows - 1, type);
  return sane(last) && last > stamp_of(file, 0, type);
}

[[noreturn]] void refuse_times(const BinaryFile& file, const Preset& preset) {
  const NumberType other = preset.type == NumberType::i32 ? NumberType::f64 : NumberType::i32;
  throw input_error("E0469", file.path())
      .says("does not fit the preset: in records of {} bytes its times do not rise", record_bytes(preset.type))
      .got(std::string(preset.name))
      .hint(times_rise(file, other) ? "they rise as those of " + preset_names(other, false)
                                    : "is it a .imu file of increments?");
}

double rate_of(const BinaryFile& file, const Preset& preset) {
  const std::uint64_t rows = file.size() / record_bytes(preset.type);
  const double span = stamp_of(file, rows - 1, preset.type) - stamp_of(file, 0, preset.type);
  const double rate = std::round(static_cast<double>(rows - 1) / span);
  if (!(rate >= 1))
    throw input_error("E0469", file.path())
        .says("its times say less than half a record per second; increments need their whole rate");
  return rate;
}

BinaryLayout layout_of(const BinaryFile& file, const Preset& preset, double rate) {
  static constexpr std::array<const char*, 6> kNames = {"gyro_x", "gyro_y", "gyro_z", "accel_x", "accel_y", "accel_z"};
  BinaryLayout layout;
  const std::uint64_t record = record_bytes(preset.type);
  layout.rows = file.size() / record;
  layout.data_bytes = layout.rows * record;
  layout.named = true;
  layout.columns.push_back({"t", "s", {NumberType::f64, false}, 0, record, 1, 0});
  for (std::size_t c = 0; c < kNames.size(); ++c)
    layout.columns.push_back({kNames[c],
                              c < 3 ? "rad/s" : "m/s^2",
                              {preset.type, false},
                              sizeof(double) + c * size_of(preset.type),
                              record,
                              rate * (c < 3 ? preset.gyro_rad : preset.accel_m_s),
                              0});
  if (const std::uint64_t rest = file.size() % record; rest > 0)
    layout.warnings.add("trailing_bytes", "bytes after the last whole record were left out",
                        fmt::format("byte {}", layout.data_bytes), rest);
  return layout;
}

std::unique_ptr<RowSource> open_imu(const std::string& path, const ReadOptions& options) {
  auto file = std::make_unique<BinaryFile>(path);
  const Preset& preset = find_preset(path, options.unsaid.preset);
  if (file->size() == 0) throw input_error("E0322", path).says("the file is empty");
  if (!times_rise(*file, preset.type)) refuse_times(*file, preset);
  const double rate = rate_of(*file, preset);
  BinaryLayout layout = layout_of(*file, preset, rate);
  LogInfo info;
  info.format = "imu";
  info.dialect = {
      fmt::format("preset {}, increments of {} times {} a second", preset.name, name_of(preset.type), rate)};
  return open_binary_rows(std::move(file), std::move(layout), std::move(info), options);
}

bool sniff_imu(const std::string& path, std::string_view) { return path.ends_with(".imu"); }

}  // namespace

Format imu_format() {
  Format row;
  row.about.name = "imu";
  row.about.title = "SMAC and EPFL increments";
  row.about.suffixes = {".imu"};
  row.sniff = sniff_imu;
  row.open = open_imu;
  return row;
}

}  // namespace libchar
