// Any 64-bit stamps, extremes included, as a .csv and as a .npy file of the same numbers: both are
// refused, or both give the same samples at the same instants, whatever the blocks.

#include <cmath>
#include <vector>

#include "libchar/log/read.hpp"
#include "tests/fuzz/fuzz_support.hpp"
#include "tests/support/memory_log.hpp"

using namespace libchar;

namespace {

struct Enough {};

// What the sink sees, of the first samples: a gap can be long.
struct Seen final : BlockSink {
  void begin(const LogInfo&) override {}
  void block(const SampleBlock& samples) override {
    fuzz::expect(samples.first == rows, "blocks that do not follow each other");
    for (std::size_t i = 0; i < samples.rows; ++i) {
      if (++rows == 5000) throw Enough{};
      for (const double* channel : samples.channels)
        text += std::isnan(channel[i]) ? "." : fuzz::bits(channel[i]) + " ";
    }
  }
  std::uint64_t rows = 0;
  std::string text;
};

std::string outcome(const std::string& bytes, const char* format, std::size_t block_bytes) {
  const test::MemoryLog file(bytes);
  ReadOptions options;
  options.format = format;
  options.threads = 1;
  options.block_bytes = block_bytes;
  options.hash = false;
  options.time_column = format == std::string("csv") ? "t" : "c0";
  options.channels = {format == std::string("csv") ? "a" : "c1"};  // text alone may be of several kinds
  options.time_unit = "ns";
  Seen seen;
  std::string end;
  try {
    const LogInfo info = read_log(file.path(), options, seen);
    fuzz::expect(info.samples == seen.rows, "samples that were not delivered");
    end = "rows " + std::to_string(info.rows) + " samples " + std::to_string(info.samples) + " rate " +
          fuzz::bits(info.time.rate_hz) + " start " + std::to_string(info.time.start_ns.value_or(0)) + " gaps " +
          std::to_string(info.time.gaps);
    for (const Finding& warning : info.warnings.list()) end += " " + warning.code + " " + std::to_string(warning.count);
  } catch (const Error& error) {
    fuzz::said(error);
    return "refused " + error.problem().code;  // how much was seen before depends on the block
  } catch (const Enough&) {
    end = "enough";
  }
  return seen.text + end;
}

std::string as_csv(const std::vector<std::int64_t>& cells) {
  std::string text = "t,a\n";
  for (std::size_t i = 0; i + 1 < cells.size(); i += 2)
    text += std::to_string(cells[i]) + "," + std::to_string(cells[i + 1]) + "\n";
  return text;
}

std::string as_npy(const std::vector<std::int64_t>& cells) {
  std::string header =
      "{'descr': '<i8', 'fortran_order': False, 'shape': (" + std::to_string(cells.size() / 2) + ", 2), }";
  header.resize(117, ' ');
  header += '\n';
  std::string bytes = "\x93NUMPY";
  bytes += {'\1', '\0', static_cast<char>(header.size()), '\0'};
  bytes += header;
  return bytes.append(reinterpret_cast<const char*>(cells.data()), cells.size() / 2 * 16);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fuzz::Input input(data, size);
  const std::size_t block_bytes = 1 + input.byte() * input.byte();
  // Each stamp is the one before and a step, or a stamp of its own: fuzzers find equal steps hard to invent.
  std::vector<std::int64_t> cells;
  std::uint64_t stamp = 0, step = 10000000;
  while (!input.empty() && cells.size() < 600) {
    const unsigned choice = input.byte();
    if (choice >= 224) step = input.take<std::uint64_t>();
    if (choice >= 192 && choice < 224) step = input.take<std::uint32_t>();
    if (choice == 128) stamp = input.take<std::uint64_t>();
    if (choice == 129) stamp = std::uint64_t{1} << 63U;
    if (choice == 130) stamp = (std::uint64_t{1} << 63U) - 1;
    if (choice == 131) stamp -= 3 * step;
    if (choice != 132) stamp += step;
    cells.push_back(static_cast<std::int64_t>(stamp));
    cells.push_back(static_cast<std::int64_t>(choice));
  }
  if (cells.empty()) return 0;
  const std::string csv = as_csv(cells), npy = as_npy(cells);
  constexpr std::size_t kWhole = std::size_t{1} << 21U;
  const std::string whole = outcome(csv, "csv", kWhole);
  fuzz::expect_same(".csv in blocks", whole, outcome(csv, "csv", block_bytes));
  const std::string binary = outcome(npy, "npy", kWhole);
  fuzz::expect_same(".npy in blocks", binary, outcome(npy, "npy", block_bytes));
  fuzz::expect_same(".csv and .npy", whole, binary);
  return 0;
}
