#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <random>

#include "libchar/characterize/characterization.hpp"
#include "libchar/core/error.hpp"
#include "libchar/core/file/sha256.hpp"
#include "libchar/core/file/unfinished_files.hpp"
#include "libchar/fleet/detail/log_seen.hpp"

namespace libchar {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

Recording white_record(std::size_t samples) {
  Recording recording;
  recording.info.channels = {{"x", ""}};
  recording.info.time.rate_hz = 100;
  std::mt19937_64 engine(1);
  std::normal_distribution<double> normal;
  recording.samples.emplace_back();
  for (std::size_t t = 0; t < samples; ++t) recording.samples[0].push_back(normal(engine));
  return recording;
}

double seconds_of(std::size_t samples) {
  const Recording recording = white_record(samples);
  CharacterizeOptions options;
  options.reading.threads = 1;
  characterize(recording, options);  // plans of transforms, pages of memory
  const auto start = Clock::now();
  characterize(recording, options);
  return seconds_since(start);
}

/// A table of one column in the folder for temporary files.
class TemporaryTable {
 public:
  TemporaryTable() {
    std::error_code error;
    const auto folder = std::filesystem::temp_directory_path(error);
    if (error) return;
    descriptor_ = open_nameless(folder);
    if (descriptor_ < 0) return;
    std::string text = "x\n";
    for (int row = 0; row < kRows; ++row) text += fmt::format("{:.9f}\n", std::sin(row));
    const auto size = static_cast<ssize_t>(text.size());
    if (::write(descriptor_, text.data(), text.size()) == size) bytes_ = static_cast<double>(size);
  }
  ~TemporaryTable() {
    if (descriptor_ >= 0) ::close(descriptor_);
  }
  TemporaryTable(const TemporaryTable&) = delete;
  TemporaryTable& operator=(const TemporaryTable&) = delete;
  std::string path() const { return fmt::format("/proc/self/fd/{}", descriptor_); }
  double bytes() const { return bytes_; }

 private:
  static constexpr int kRows = 1 << 17;
  int descriptor_ = -1;
  double bytes_ = 0;
};

/// Reading, parsing and hashing; where no file can be written or read back, as slow as it is anywhere.
double text_byte_seconds() {
  constexpr double kSlow = 20e-9;
  const TemporaryTable table;
  if (table.bytes() == 0) return kSlow;
  CharacterizeOptions options;
  options.reading.threads = 1;
  options.reading.format = "csv";
  options.wanted = {true, false, false, false};
  try {
    const auto start = Clock::now();
    characterize(table.path(), options);
    return seconds_since(start) / table.bytes();
  } catch (const Error&) {
    return kSlow;
  }
}

/// Hashing is most of what a binary log takes.
double binary_byte_seconds() {
  const std::string bytes(std::size_t{1} << 24U, 'x');
  const auto start = Clock::now();
  Sha256 hash;
  hash.update(bytes);
  hash.finish();
  return 1.5 * seconds_since(start) / static_cast<double>(bytes.size());
}

bool is_text(const std::string& format) { return format == "csv"; }

}  // namespace

CostModel measured_cost() {
  constexpr std::size_t kShort = 1U << 12U, kLong = 1U << 18U;
  CostModel out;
  const double few = seconds_of(kShort), many = seconds_of(kLong);
  out.sample_s = std::max(0.0, many - few) / static_cast<double>(kLong - kShort);
  out.fixed_s = few;
  out.text_byte_s = text_byte_seconds();
  out.binary_byte_s = binary_byte_seconds();
  return out;
}

UnitCost CostModel::of(const FleetUnit& unit, const LogInfo& head) const {
  constexpr double kReports = 0.004;                 // s a channel: page, tables, model, and the disk
  constexpr double kProgram = 64e6;                  // bytes: program and libraries
  constexpr double kStageBytes = 30e6, kAtOnce = 8;  // of a channel of many leaves, in one pass
  constexpr double kStretchBytes = 70e6;  // of the channels of a pass, or of a state and the tree that it comes to
  constexpr double kTimesKept = 4;        // the record, its transform, what is written of it
  const double chosen = unit.options->reading.channels.empty()
                            ? static_cast<double>(head.channels.size())
                            : static_cast<double>(unit.options->reading.channels.size());
  double rows = static_cast<double>(head.rows), bytes = static_cast<double>(unit.bytes);
  if (unit.kind == UnitKind::stretch) {
    const double leaves = static_cast<double>(unit.stretch.end_leaf - unit.stretch.first_leaf);
    bytes *= leaves / static_cast<double>(std::max<std::uint64_t>(1, leaves_of(head.rows)));
    rows = leaves * static_cast<double>(kLeafSamples);
  }
  UnitCost out;
  const double samples = unit.kind == UnitKind::join ? 0 : rows * chosen;
  out.seconds = fixed_s * chosen + sample_s * samples + bytes * (is_text(head.format) ? text_byte_s : binary_byte_s) +
                (unit.reports && unit.kind != UnitKind::stretch ? kReports * chosen : 0);
  const double kept = 8 * rows * (chosen + kTimesKept);
  const double all =
      what_needs_all_samples(*unit.options).empty() ? 0 : 1.5 * static_cast<double>(unit.options->memory_bytes);
  const double limit = all + kStageBytes * std::min(chosen, kAtOnce);
  const double needed = unit.kind == UnitKind::log ? std::min(kept, limit) : kStretchBytes;
  out.memory_bytes = static_cast<std::uint64_t>(kProgram + needed);
  return out;
}

}  // namespace libchar
