// What holds for logs that are written, read, cut in pieces or full of dirt.

#include <catch2/catch.hpp>
#include <filesystem>

#include "libchar/core/error.hpp"
#include "libchar/log/quality.hpp"
#include "libchar/log/read.hpp"
#include "libchar/log/write.hpp"
#include "tests/properties/generate.hpp"
#include "tests/support/memory_log.hpp"
#include "tests/support/shared.hpp"

using namespace libchar;
using namespace props;

namespace {

Record mostly_finite(std::size_t samples) {
  Record y = *rc::gen::container<Record>(samples, any_finite());
  for (double& v : y)
    if (*rc::gen::inRange(0, 12) == 0) v = std::nan("");
  return y;
}

std::vector<Record> any_columns() {
  const auto channels = static_cast<std::size_t>(*rc::gen::inRange(1, 4));
  const auto rows = static_cast<std::size_t>(*rc::gen::inRange(3, 30));
  std::vector<Record> out;
  for (std::size_t c = 0; c < channels; ++c) {
    out.push_back(mostly_finite(rows));
    out.back()[0] = 1.5;  // a column without any value is another matter
  }
  return out;
}

void write_as(const std::string& path, const std::vector<Record>& columns, const WriteOptions& options = {}) {
  LogInfo info;
  for (std::size_t c = 0; c < columns.size(); ++c) {
    info.channels.emplace_back();
    info.channels.back().name = "x" + std::to_string(c);
  }
  info.time.rate_hz = 128;
  info.samples = columns[0].size();
  WriteOptions writing = options;
  writing.overwrite = true;
  const auto writer = open_log_writer(path, info, writing);
  std::vector<std::span<const double>> spans(columns.begin(), columns.end());
  writer->write(spans);
  writer->finish();
}

std::vector<Record> read_back(const std::string& path) {
  ReadOptions options;
  options.threads = 1;
  return read_recording(path, options).samples;
}

bool same_samples(const std::vector<Record>& a, const std::vector<Record>& b) {
  bool out = a.size() == b.size();
  for (std::size_t c = 0; out && c < a.size(); ++c) {
    out = a[c].size() == b[c].size();
    for (std::size_t i = 0; out && i < a[c].size(); ++i)
      out = (std::isnan(a[c][i]) && std::isnan(b[c][i])) || same_bits({a[c][i]}, {b[c][i]});
  }
  return out;
}

/// Rows of cells that a log may hold, good and bad.
std::string any_table() {
  static const std::vector<std::string> cells = {"1",   "-2.5", "3e7",   "",  "nan", "1e400", "x",      "0.1",
                                                 "007", "1,5",  "\"4\"", "-", "+3",  "0x10",  "1e-400", "5 "};
  std::string out = *rc::gen::element<std::string>("t,a,b\n", "a,b\n", "", "# note\nt[s],a[deg/s]\n");
  const int rows = *rc::gen::inRange(0, 12);
  for (int r = 0; r < rows; ++r) {
    const int columns = *rc::gen::inRange(1, 4);
    for (int c = 0; c < columns; ++c)
      out += (c > 0 ? "," : "") +
             (*rc::gen::inRange(0, 6) > 0 ? std::to_string(r) + "." + std::to_string(c) : *rc::gen::elementOf(cells));
    out += *rc::gen::element<std::string>("\n", "\n", "\n", "\r\n", "");
  }
  return out;
}

struct BlockReading {
  LogInfo info;
  std::vector<Record> samples;
  std::string refused;
};

BlockReading reading_of(const std::string& bytes, std::size_t block, int threads) {
  const test::MemoryLog log(bytes);
  ReadOptions options;
  options.format = "csv";
  options.block_bytes = block;
  options.threads = threads;
  options.rate_hz = 10;
  BlockReading out;
  try {
    Recording recording = read_recording(log.path(), options);
    out.info = std::move(recording.info);
    out.samples = std::move(recording.samples);
  } catch (const Error& error) {
    out.refused = error.problem().code + error.problem().what;
  }
  return out;
}

}  // namespace

TEST_CASE("property: a CSV file reads back to the bits that were written") {
  const test::TemporaryFolder folder;
  holds([&] {
    const std::vector<Record> columns = any_columns();
    const std::string path = (folder / "x.csv").string();
    write_as(path, columns);
    RC_ASSERT(same_samples(read_back(path), columns));
  });
}
TEST_CASE("property: a .npy file reads back to the bits that were written, in either order and byte order") {
  const test::TemporaryFolder folder;
  holds([&] {
    const std::vector<Record> columns = any_columns();
    WriteOptions options;
    options.order = *rc::gen::element<std::string>("interleaved", "planar");
    options.big_endian = *rc::gen::arbitrary<bool>();
    const std::string path = (folder / "x.npy").string();
    write_as(path, columns, options);
    RC_ASSERT(same_samples(read_back(path), columns));
  });
}
TEST_CASE("property: a raw file and its sidecar read back to the bits that were written") {
  const test::TemporaryFolder folder;
  holds([&] {
    const std::vector<Record> columns = any_columns();
    WriteOptions options;
    options.format = "raw";
    options.order = *rc::gen::element<std::string>("interleaved", "planar");
    options.big_endian = *rc::gen::arbitrary<bool>();
    const std::string path = (folder / "x.bin").string();
    write_as(path, columns, options);
    RC_ASSERT(same_samples(read_back(path), columns));
  });
}
TEST_CASE("property: whatever a table holds, it is read or refused in a sentence, and every row is accounted for") {
  holds([] {
    const BlockReading read = reading_of(any_table(), 1 << 16, 1);
    if (!read.refused.empty()) return;
    RC_ASSERT(read.info.rows == read.info.rows_used + read.info.rows_dropped + read.info.rows_outside);
    RC_ASSERT(read.samples.size() == read.info.channels.size());
  });
}
TEST_CASE("property: blocks and threads change nothing of what is read or refused") {
  holds([] {
    const std::string table = any_table();
    const BlockReading whole = reading_of(table, 1 << 16, 1),
                       parts = reading_of(table, static_cast<std::size_t>(*rc::gen::inRange(1, 60)),
                                          *rc::gen::inRange(1, 4));
    RC_ASSERT(parts.refused == whole.refused);
    RC_ASSERT(same_samples(parts.samples, whole.samples));
    RC_ASSERT(parts.info.rows_dropped == whole.info.rows_dropped);
  });
}
TEST_CASE("property: bytes of any kind are read or refused, never both and never neither") {
  holds([] {
    const std::string bytes = *rc::gen::string<std::string>();
    const BlockReading read = reading_of(bytes, 64, 1);
    RC_ASSERT(read.refused.empty() == !read.samples.empty());
  });
}
TEST_CASE("property: the quality of a channel does not depend on the pieces of its record") {
  holds([] {
    const Record y = with_gaps(record(1, 400), 20);
    QualityMeter whole, parts;
    whole.push(y);
    in_pieces(y, [&](std::span<const double> piece) { parts.push(piece); });
    const ChannelQuality a = whole.finish(), b = parts.finish();
    RC_ASSERT(a.samples + a.missing == y.size());
    RC_ASSERT(same_bits({a.mean, a.standard_deviation, a.difference_kurtosis, a.minimum},
                        {b.mean, b.standard_deviation, b.difference_kurtosis, b.minimum}));
    RC_ASSERT(a.longest_stuck == b.longest_stuck);
    RC_ASSERT(a.distinct_values == b.distinct_values);
    RC_ASSERT(a.findings == b.findings);
  });
}
