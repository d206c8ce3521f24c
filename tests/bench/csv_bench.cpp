// Speed of reading CSV: finding out the dialect, the parser alone, the whole of read_log with a sink that does nothing,
// and what they are measured against (memcpy of the bytes, a plain std::from_chars loop), on 7 columns of numbers
// written in several ways.
//   csv_bench [megabytes [block_bytes]]
#include <fmt/format.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <unistd.h>

#include <charconv>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <random>
#include <string>
#include <vector>

#include "libchar/log/csv/head/dialect.hpp"
#include "libchar/log/csv/rows/rows.hpp"
#include "libchar/log/csv/unpacker.hpp"
#include "libchar/log/quality.hpp"
#include "libchar/log/read.hpp"
#include "tests/support/kernels.hpp"

using namespace libchar;

namespace {

double wall() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }
double cpu() {
  rusage usage{};
  ::getrusage(RUSAGE_SELF, &usage);
  const auto seconds = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
  };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

// How the numbers of a file are written.
struct Style {
  const char* name;
  const char* number = "{:.9g}";
  bool counts = false;         // integers
  bool decimal_comma = false;  // with ; between the fields
  bool blanks = false;         // in front of every value
  bool quotes = false;         // around every value
  int missing = 0;             // one empty cell in so many rows
  bool plain() const { return !decimal_comma && !quotes && missing == 0 && !blanks; }
};

constexpr Style kStyles[] = {{"shortest", "{}"},
                             {"%.9g"},
                             {"%.6f", "{:.6f}"},
                             {.name = "counts", .counts = true},
                             {.name = "comma", .decimal_comma = true},
                             {.name = "1/1000 gone", .missing = 1000},
                             {.name = "1/20 gone", .missing = 20},
                             {.name = "quoted", .quotes = true},
                             {.name = "blanks", .blanks = true}};

std::string cell(const Style& style, double x) {
  const std::string number =
      style.counts ? fmt::format("{}", std::lround(x * 16384)) : fmt::format(fmt::runtime(style.number), x);
  return (style.blanks ? " " : "") + (style.quotes ? '"' + number + '"' : number);
}

// Seven columns: t[s] and six noisy channels.
std::string make(const Style& style, std::size_t bytes) {
  std::mt19937_64 random(7);
  std::normal_distribution<double> noise(0, 0.01);
  const auto written = [&](std::string line) {
    if (style.decimal_comma)
      for (char& c : line) c = c == ',' ? ';' : c == '.' ? ',' : c;
    return line + '\n';
  };
  std::string text = written("t[s],gx[rad/s],gy[rad/s],gz[rad/s],ax[m/s^2],ay[m/s^2],az[m/s^2]");
  text.reserve(bytes + 512);
  for (std::size_t row = 0; text.size() < bytes; ++row) {
    std::string line = fmt::format("{:.3f}", static_cast<double>(row) * 0.005);
    for (int c = 0; c < 6; ++c) {
      const double x = noise(random) + (c == 5 ? 9.81 : 0);
      const bool gone = c == 2 && style.missing > 0 && row % static_cast<std::size_t>(style.missing) == 0;
      line += gone ? "," : "," + cell(style, x);
    }
    text += written(line);
  }
  return text;
}

struct Null final : BlockSink {
  void begin(const LogInfo&) override {}
  void block(const SampleBlock& block) override { rows += block.rows; }
  std::uint64_t rows = 0;
};

template <typename Work>
double best_of(int n, Work work) {
  double best = 1e9;
  for (int i = 0; i < n; ++i) {
    const double start = cpu();
    work();
    best = std::min(best, cpu() - start);
  }
  return best;
}

double plain_loop(const std::string& text) {
  const char* p = text.data() + text.find('\n') + 1;
  const char* const end = text.data() + text.size();
  double sum = 0;
  while (p < end) {
    double value = 0;
    const auto [stop, status] = std::from_chars(p, end, value);
    if (status != std::errc()) break;
    sum += value;
    p = stop + 1;
  }
  return sum;
}

}  // namespace

int main(int count, char** arguments) {
  const std::size_t megabytes = count > 1 ? static_cast<std::size_t>(std::atoi(arguments[1])) : 100;
  fmt::print("{:<12} {:>10} {:>12} {:>12} {:>12} {:>12} {:>12} {:>10} {:>8}\n", "style", "memcpy", "from_chars",
             "parse_rows", "read_log", "read_log", "no hash", "parse/", "dialect");
  fmt::print("{:<12} {:>10} {:>12} {:>12} {:>12} {:>12} {:>12} {:>10} {:>8}\n", "", "GB/s", "MB/s core", "MB/s core",
             "MB/s wall", "MB/s cpu", "MB/s cpu", "from_ch.", "ms");
  volatile double keep = 0;
  for (const Style& style : kStyles) {
    const std::string text = make(style, megabytes << 20U);
    const double size = static_cast<double>(text.size());
    std::vector<char> copy(text.size());
    const double copying = best_of(3, [&] { std::memcpy(copy.data(), text.data(), text.size()); });
    const double plain = style.plain() ? best_of(3, [&] { keep = plain_loop(text); }) : std::nan("");

    ReadOptions options;
    if (count > 2) options.block_bytes = static_cast<std::size_t>(std::atoi(arguments[2]));
    csv::Dialect dialect;
    const double sniffing = best_of(3, [&] {
      LogInfo info;
      keep = static_cast<double>(csv::packing_of(std::string_view(text).substr(0, csv::kPackingBytes)));
      dialect = csv::understand(std::string_view(text).substr(0, csv::kHeadBytes), false, options, info);
    });
    csv::Plan plan;
    plan.dialect = &dialect;
    plan.target = {csv::Plan::kTime, 0, 1, 2, 3, 4, 5};
    plan.channels = 6;
    csv::ParsedChunk chunk;
    std::size_t rows = 0;
    const double parsing = best_of(3, [&] {
      rows = 0;
      for (std::size_t at = dialect.data_offset; at < text.size();) {
        std::size_t end = std::min(text.size(), at + options.block_bytes);
        end = text.rfind('\n', end - 1) + 1;
        csv::parse_rows(std::string_view(text).substr(at, end - at), plan, chunk);
        rows += chunk.rows.rows;
        at = end;
      }
    });

    const int file = ::memfd_create("bench", 0);
    if (::write(file, text.data(), text.size()) != static_cast<ssize_t>(text.size())) return 1;
    const std::string path = fmt::format("/proc/self/fd/{}", file);
    options.format = "csv";
    double walls = 1e9, cpus = 1e9, unhashed = 1e9;
    for (int i = 0; i < 3; ++i) {
      Null sink;
      const double w = wall(), c = cpu();
      const LogInfo read = read_log(path, options, sink);
      walls = std::min(walls, wall() - w);
      cpus = std::min(cpus, cpu() - c);
      if (read.rows != rows) return 1;
    }
    options.hash = false;
    unhashed = best_of(3, [&] {
      Null sink;
      read_log(path, options, sink);
    });
    ::close(file);
    fmt::print("{:<12} {:>10.2f} {:>12.0f} {:>12.0f} {:>12.0f} {:>12.0f} {:>12.0f} {:>10.2f} {:>8.2f}\n", style.name,
               size / copying * 1e-9, size / plain * 1e-6, size / parsing * 1e-6, size / walls * 1e-6,
               size / cpus * 1e-6, size / unhashed * 1e-6, plain / parsing, sniffing * 1e3);
  }

  std::mt19937_64 random(1);
  std::normal_distribution<double> noise(0, 1);
  std::vector<double> x(1 << 22U), grid(1 << 22U);
  for (std::size_t i = 0; i < x.size(); ++i) {
    x[i] = noise(random);
    grid[i] = std::round(x[i] / 0.05) * 0.05;
  }
  for (const auto& [name, data] :
       {std::pair<const char*, const std::vector<double>&>{"continuous", x}, {"on a grid", grid}}) {
    const double seconds = best_of(3, [&, &samples = data] {
      QualityMeter meter;
      meter.push(samples);
      keep = meter.finish().mean;
    });
    fmt::print("quality meter, {} samples: {:.2f} ns/sample\n", name, seconds / static_cast<double>(x.size()) * 1e9);
  }
  test::print_kernels("csv");
}
