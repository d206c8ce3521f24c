// The same dirty data in every format: the same samples, counts, warnings and codes. And of every log that is accepted
// the account of its rows: rows in = rows used + rows dropped with a reason + rows outside the window.

#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstring>
#include <fstream>
#include <map>

#include "libchar/core/error.hpp"
#include "libchar/core/text/decimal.hpp"
#include "libchar/log/read.hpp"
#include "tests/support/shared.hpp"

using namespace libchar;

namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Rows of stamp, x, y.
using DirtyRows = std::vector<std::array<double, 3>>;

std::string dirty_bytes(const DirtyRows& rows) {
  std::string bytes(rows.size() * 24, '\0');
  std::memcpy(bytes.data(), rows.data(), bytes.size());
  return bytes;
}

std::vector<std::string> in_all_formats(const DirtyRows& rows, const test::TemporaryFolder& folder) {
  const std::string csv = (folder / "a.csv").string(), npy = (folder / "a.npy").string(),
                    raw = (folder / "a.f64").string();
  {
    std::ofstream file(csv);
    file << "t[s],x,y\n";
    for (const auto& row : rows) file << shortest(row[0]) << ',' << shortest(row[1]) << ',' << shortest(row[2]) << '\n';
  }
  {
    std::string header = "{'descr': [('t_s', '<f8'), ('x', '<f8'), ('y', '<f8')], 'fortran_order': False, 'shape': (" +
                         std::to_string(rows.size()) + ",), }";
    header.resize(181, ' ');
    header += '\n';
    std::ofstream(npy, std::ios::binary) << std::string("\x93NUMPY\x01\x00\xB6\x00", 10) << header << dirty_bytes(rows);
  }
  std::ofstream(raw, std::ios::binary) << dirty_bytes(rows);
  std::ofstream(raw + ".json")
      << R"({"dtype": "f64", "endian": "little", "channels": [{"name": "t", "unit": "s"}, {"name": "x"}, {"name": "y"}]})";
  return {csv, npy, raw};
}

/// What became of a log: its samples bit by bit, warnings with counts, or the code of the error.
struct Fate {
  std::string code;
  std::map<std::string, std::uint64_t> warnings;
  std::vector<std::vector<double>> samples;
  double rate_hz = 0;
};

std::uint64_t counted(const LogInfo& info, const char* code) {
  const Finding* const warning = info.warnings.find(code);
  return warning == nullptr ? 0 : warning->count;
}

void check_account_of(const LogInfo& info) {
  CHECK(info.rows == info.rows_used + info.rows_dropped + info.rows_outside);
  CHECK(info.rows_dropped == counted(info, "duplicate_timestamp") + counted(info, "backward_timestamp"));
  CHECK(info.samples == info.rows_used + info.time.missing_samples);
}

Fate fate_of(const std::string& path, const ReadOptions& options = {}) {
  Fate fate;
  try {
    const Recording recording = read_recording(path, options);
    check_account_of(recording.info);
    for (const Finding& warning : recording.info.warnings.list()) fate.warnings[warning.code] = warning.count;
    fate.samples = recording.samples;
    fate.rate_hz = recording.info.time.rate_hz;
  } catch (const Error& error) {
    fate.code = error.problem().code;
    INFO(error.what());
    CHECK(error.problem().where.rfind(path, 0) == 0);
    CHECK_FALSE(fate.code.empty());
  }
  return fate;
}

bool same_bits(const std::vector<std::vector<double>>& a, const std::vector<std::vector<double>>& b) {
  if (a.size() != b.size()) return false;
  for (std::size_t c = 0; c < a.size(); ++c) {
    if (a[c].size() != b[c].size()) return false;
    for (std::size_t i = 0; i < a[c].size(); ++i)
      if (a[c][i] != b[c][i] && !(std::isnan(a[c][i]) && std::isnan(b[c][i]))) return false;
  }
  return true;
}

DirtyRows regular(std::size_t n) {
  DirtyRows rows;
  for (std::size_t i = 0; i < n; ++i)
    rows.push_back({0.01 * static_cast<double>(i), std::sin(static_cast<double>(i)), static_cast<double>(i % 7) + 0.5});
  return rows;
}

struct Dirt {
  const char* what;
  void (*make)(DirtyRows& rows);
  const char* code;     ///< of the error, "" = it is read
  const char* warning;  ///< "" = none
  std::uint64_t count;
};

const std::vector<Dirt> kDirt = {
    {"clean", [](DirtyRows&) {}, "", "", 0},
    {"a NaN sample", [](DirtyRows& r) { r[5][1] = kNan; }, "", "missing_cell", 1},
    {"NaN samples",
     [](DirtyRows& r) {
       for (std::size_t i = 0; i < 40; ++i) r[i][i % 2 + 1] = kNan;
     },
     "", "missing_cell", 40},
    {"an infinity", [](DirtyRows& r) { r[5][1] = kInfinity; }, "", "infinite_value", 1},
    {"infinities",
     [](DirtyRows& r) {
       r[5][1] = kInfinity;
       r[6][2] = -kInfinity;
     },
     "", "infinite_value", 2},
    {"a column of NaN",
     [](DirtyRows& r) {
       for (auto& row : r) row[1] = kNan;
     },
     "", "no_finite_value", 1},
    {"columns of NaN",
     [](DirtyRows& r) {
       for (auto& row : r) row[1] = row[2] = kNan;
     },
     "E0318", "", 0},
    {"a constant channel",
     [](DirtyRows& r) {
       for (auto& row : r) row[1] = 3;
     },
     "", "", 0},
    {"a railed channel",
     [](DirtyRows& r) {
       for (std::size_t i = 0; i < r.size(); ++i) r[i][1] = std::min(0.5, r[i][1]);
     },
     "", "", 0},
    {"denormals",
     [](DirtyRows& r) {
       r[5][1] = 5e-324;
       r[6][1] = -2e-310;
     },
     "", "", 0},
    {"the ends of a double",
     [](DirtyRows& r) {
       r[5][1] = 1.7976931348623157e308;
       r[6][1] = -r[5][1];
     },
     "", "", 0},
    {"a NaN stamp", [](DirtyRows& r) { r[5][0] = kNan; }, "E0313", "", 0},
    {"a stamp of 1e300 s", [](DirtyRows& r) { r[5][0] = 1e300; }, "E0314", "", 0},
    {"a stamp of 2^62 ns", [](DirtyRows& r) { r[5][0] = 4611686018.427387904; }, "E0314", "", 0},
    {"a stamp of -2^62 ns", [](DirtyRows& r) { r[5][0] = -4611686018.427387904; }, "E0314", "", 0},
    {"a span beyond 2^62 ns",
     [](DirtyRows& r) {
       for (auto& row : r) row[0] -= 4.6e9;
       r[70][0] = 4.6e9;
     },
     "E0316", "", 0},
    {"a stamp held back", [](DirtyRows& r) { r[5][0] = r[4][0]; }, "", "held_stamp", 1},
    {"a doubled row", [](DirtyRows& r) { r.insert(r.begin() + 5, r[4]); }, "", "duplicate_timestamp", 1},
    {"a step back", [](DirtyRows& r) { r[5][0] = r[2][0]; }, "", "backward_timestamp", 1},
    {"a gap",
     [](DirtyRows& r) {
       for (std::size_t i = 50; i < r.size(); ++i) r[i][0] += 1;
     },
     "", "gap", 1},
    {"equal stamps",
     [](DirtyRows& r) {
       for (auto& row : r) row[0] = 1;
     },
     "E0315", "", 0},
    {"falling stamps",
     [](DirtyRows& r) {
       for (auto& row : r) row[0] = -row[0];
     },
     "E0315", "", 0},
    {"a log behind the other",
     [](DirtyRows& r) {
       const DirtyRows again = r;
       r.insert(r.end(), again.begin(), again.end());
     },
     "E0317", "", 0},
    {"no rows", [](DirtyRows& r) { r.clear(); }, "E0322", "", 0},
};

}  // namespace

TEST_CASE("the same dirty data in each format are read alike, counted alike and refused alike") {
  for (const Dirt& dirt : kDirt) {
    DirtyRows rows = regular(100);
    dirt.make(rows);
    const test::TemporaryFolder folder;
    const auto files = in_all_formats(rows, folder);
    const Fate first = fate_of(files[0]);
    INFO(dirt.what << ": " << first.code);
    CHECK(first.code == dirt.code);
    if (*dirt.warning != '\0') CHECK(first.warnings.at(dirt.warning) == dirt.count);
    if (*dirt.code == '\0' && *dirt.warning == '\0') CHECK(first.warnings.empty());
    for (const std::string& file : files) {
      const Fate fate = fate_of(file);
      INFO(file << ": " << fate.code);
      CHECK(fate.code == first.code);
      CHECK(fate.warnings == first.warnings);
      CHECK(same_bits(fate.samples, first.samples));
      CHECK(fate.rate_hz == first.rate_hz);
    }
  }
}

TEST_CASE("rows in are rows used, dropped with a reason, or outside the window: every log that is accepted") {
  std::size_t accepted = 0;
  for (const char* place : {"known/badinputs/csv", "known/badinputs/npy", "known/badinputs/raw", "npy", "."}) {
    for (const auto& entry : std::filesystem::directory_iterator(test::fixture(place))) {
      const std::string suffix = entry.path().extension().string();
      if (suffix != ".csv" && suffix != ".npy" && suffix != ".f64") continue;
      INFO(entry.path());
      ReadOptions options;
      for (const auto& [from, to] : {std::pair<double, double>{0, 9e9}, {0.015, 9e9}, {0, 0.035}, {0.011, 0.042}}) {
        options.from_s = from > 0 ? std::optional(from) : std::nullopt;
        options.to_s = to < 9e9 ? std::optional(to) : std::nullopt;
        for (const std::size_t block : {std::size_t{1}, std::size_t{64}, std::size_t{1} << 21U}) {
          if (block == 1 && entry.file_size() > 10'000) continue;
          options.block_bytes = block;
          try {
            check_account_of(read_recording(entry.path().string(), options).info);
            ++accepted;
          } catch (const Error&) {
            // what is refused has no account
          }
        }
      }
    }
  }
  CHECK(accepted > 300);
}
