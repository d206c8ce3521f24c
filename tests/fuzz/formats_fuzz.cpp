// Any samples written as .csv, .npy and raw, and read back in blocks of any size: the same bits each way.

#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <vector>

#include "libchar/log/read.hpp"
#include "libchar/log/write.hpp"
#include "tests/fuzz/fuzz_support.hpp"

using namespace libchar;

namespace {

const std::string& folder() {
  static const std::string& path = *new std::string([] {  // outlives the handler of exit
    std::string made = "/dev/shm/libchar-formats-fuzz-" + std::to_string(::getpid());
    std::filesystem::create_directory(made);
    std::atexit([] { std::filesystem::remove_all(folder()); });
    return made;
  }());
  return path;
}

using Columns = std::vector<std::vector<double>>;

void write(const std::string& path, const LogInfo& info, const Columns& columns, WriteOptions options) {
  options.overwrite = true;
  const auto writer = open_log_writer(path, info, options);
  std::vector<std::span<const double>> spans(columns.begin(), columns.end());
  writer->write(spans);
  writer->finish();
}

std::string read_back(const std::string& path, std::size_t block_bytes, double rate_hz) {
  ReadOptions options;
  options.threads = 1;
  options.block_bytes = block_bytes;
  options.hash = false;
  if (path.ends_with(".npy")) options.rate_hz = rate_hz;  // a .npy file has no place for it
  const Recording log = read_recording(path, options);
  std::string all = fuzz::bits(log.info.time.rate_hz);
  for (const auto& channel : log.samples)
    for (const double x : channel) all += " " + (std::isnan(x) ? "nan" : fuzz::bits(x));
  return all;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size < 12) return 0;
  fuzz::Input input(data, size);
  const unsigned choice = input.byte();
  const std::size_t block_bytes = 1 + input.byte() * input.byte();
  const std::size_t width = 1 + choice % 4;
  const bool single = (choice & 16U) != 0;
  Columns columns(width);
  while (!input.empty() && columns.back().size() < 400)
    for (auto& column : columns) {
      const double any = single ? static_cast<double>(input.take<float>()) : input.take<double>();
      column.push_back(std::isfinite(any) ? any : kMissing);
    }
  if (columns[0].size() < 2) return 0;
  LogInfo info;
  info.time.rate_hz = 125;
  if ((choice & 128U) != 0) info.time.start_ns = 1700000000000000000;
  for (std::size_t c = 0; c < width; ++c) info.channels.push_back({"channel_" + std::to_string(c), "m"});
  WriteOptions options;
  options.order = (choice & 32U) != 0 ? "planar" : "interleaved";
  options.big_endian = (choice & 64U) != 0;
  options.dtype = single ? "f32" : "f64";
  std::string first;
  for (const char* name : {"/a.npy", "/a.f64", "/a.csv"}) {
    const std::string path = folder() + name;
    std::string back;
    try {
      write(path, info, columns, options);
      back = read_back(path, block_bytes, info.time.rate_hz);
    } catch (const Error& error) {
      back = fuzz::said(error);
    }
    if (first.empty())
      first = back;
    else
      fuzz::expect_same(name, first, back);
  }
  return 0;
}
