// How fast binary logs stream, beside a plain pread of the same bytes. Usage: binary_read_bench [MILLIONS OF DOUBLES]

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <random>
#include <vector>

#include "libchar/log/detail/format.hpp"
#include "libchar/log/write.hpp"

namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

void write_file(const std::string& path, std::size_t rows, const char* order, const char* dtype) {
  libchar::LogInfo info;
  for (const char* name : {"c0", "c1", "c2", "c3", "c4", "c5"}) info.channels.push_back({name, "", false});
  libchar::WriteOptions options;
  options.overwrite = true;
  options.order = order;
  options.dtype = dtype;
  const auto writer = libchar::open_log_writer(path, info, options);
  std::mt19937_64 random(1);
  std::vector<double> block(65536);
  for (double& x : block) x = static_cast<double>(random() >> 11U) * 0x1p-53;
  for (std::size_t at = 0; at < rows; at += block.size()) {
    const std::span<const double> column(block.data(), std::min(block.size(), rows - at));
    writer->write(std::vector<std::span<const double>>(6, column));
  }
  writer->finish();
}

double plain_read(const std::string& path) {
  const int file = ::open(path.c_str(), O_RDONLY);
  std::vector<char> block(std::size_t{4} << 20U);
  const auto start = Clock::now();
  while (::read(file, block.data(), block.size()) > 0) {
  }
  const double took = seconds_since(start);
  ::close(file);
  return took;
}

double stream(const std::string& path, const libchar::ReadOptions& options) {
  const auto start = Clock::now();
  const auto source = libchar::find_format("npy")->open(path, options);
  libchar::RowBlock block;
  libchar::Findings warnings;
  while (source->next(block, warnings)) {
  }
  if (options.hash) source->sha256();
  return seconds_since(start);
}

}  // namespace

int main(int argc, char** argv) {
  const std::size_t rows = (argc > 1 ? std::strtoull(argv[1], nullptr, 10) : 60) * 1'000'000 / 6;
  const std::string path = (std::filesystem::temp_directory_path() / "libchar-bench.npy").string();
  fmt::print("{} rows of 6 channels; best of 3, GB/s of file (file cached)\n{:<24}{:>8}{:>8}{:>12}{:>12}\n", rows,
             "file", "read()", "all", "1 channel", "all + hash");
  for (const char* dtype : {"f64", "f32"}) {
    for (const char* order : {"interleaved", "planar"}) {
      write_file(path, rows, order, dtype);
      const double gigabytes = static_cast<double>(std::filesystem::file_size(path)) * 1e-9;
      libchar::ReadOptions all, one, hashed;
      all.hash = one.hash = false;
      one.channels = {"c3"};
      const auto best = [&](auto measure) { return gigabytes / std::min({measure(), measure(), measure()}); };
      fmt::print("{:<24}{:>8.2f}{:>8.2f}{:>12.2f}{:>12.2f}\n", fmt::format("npy {} {}", dtype, order),
                 best([&] { return plain_read(path); }), best([&] { return stream(path, all); }),
                 best([&] { return stream(path, one); }), best([&] { return stream(path, hashed); }));
    }
  }
  std::filesystem::remove(path);
}
