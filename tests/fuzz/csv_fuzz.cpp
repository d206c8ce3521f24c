// libFuzzer target of the CSV reader: the first two bytes choose block size and options, the rest is the file. It is
// read in small blocks and in one, with one thread and sometimes more: values, counts, warnings and errors must agree.
// The reader itself throws std::logic_error when its account of bytes and cells does not balance.
//   csv_fuzz -max_total_time=60 -max_len=4096 -timeout=5 -rss_limit_mb=1024 corpus
//   fixtures/known/badinputs/csv
#include "tests/fuzz/log_outcome.hpp"
#include "tests/support/memory_log.hpp"

using namespace libchar;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size < 2) return 0;
  const unsigned choice = data[1];
  ReadOptions options;
  options.format = "csv";
  options.header = choice % 8 == 1 ? "yes" : choice % 8 == 2 ? "no" : "auto";
  options.time_column = choice % 8 == 3 ? "none" : "auto";
  options.decimal = choice % 8 == 4 ? "comma" : "auto";
  options.delimiter = choice % 8 == 5 ? ";" : choice % 8 == 6 ? "space" : "auto";
  options.skip_repeated_header = (choice & 8U) != 0;
  options.missing.overflow = (choice & 16U) != 0;
  if ((choice & 32U) != 0) options.rate_hz = 100;
  options.hash = (choice & 64U) != 0;
  const test::MemoryLog log({reinterpret_cast<const char*>(data) + 2, size - 2});
  options.threads = 1;
  const std::string whole = fuzz::outcome(log.path(), options);
  options.block_bytes = data[0] % 64U + 1U + (data[0] >= 192 ? 4000U : 0U);
  options.threads = choice >= 240 ? 3 : 1;
  fuzz::expect_same("whole, and in blocks", whole, fuzz::outcome(log.path(), options));
  return 0;
}
