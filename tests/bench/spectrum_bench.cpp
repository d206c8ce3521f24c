// Run time of the transforms and of Welch's method, in ns a sample: best of several runs, interleaved.
//   build/tests/bench/spectrum_bench [samples]

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <functional>
#include <random>
#include <string>
#include <vector>

#include "libchar/spectrum/fft.hpp"
#include "libchar/spectrum/spectrum.hpp"
#include "libchar/spectrum/welch.hpp"
#include "libchar/spectrum/welch_sums.hpp"
#include "tests/support/kernels.hpp"

using namespace libchar;

namespace {

double seconds(const std::function<void()>& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

struct Entry {
  std::string name;
  std::function<void()> work;
  double best = 1e300;
};

}  // namespace

int main(int argc, char** argv) {
  const std::size_t n = argc > 1 ? std::strtoull(argv[1], nullptr, 10) : 10'000'000;
  std::vector<double> x(n);
  std::mt19937_64 generator(1);
  std::normal_distribution<double> normal;
  for (double& v : x) v = 9.81 + normal(generator);

  std::vector<double> copy(n);
  RealFft fft(n);
  Dct dct(n);
  double sink = 0;
  std::vector<Entry> entries;
  entries.push_back({"copy of the record", [&] {
                       std::copy(x.begin(), x.end(), copy.begin());
                       sink += copy[n / 2];
                     }});
  entries.push_back({"real FFT of the record (with the copy into it)", [&] {
                       std::copy(x.begin(), x.end(), fft.input().begin());
                       sink += fft.transform()[1].real();
                     }});
  entries.push_back({"cosine transform of the record", [&] { sink += dct.transform(x)[1]; }});
  for (const std::uint64_t segment : {std::uint64_t{1} << 8U, std::uint64_t{1} << 12U, std::uint64_t{1} << 14U,
                                      std::uint64_t{1} << 16U, std::uint64_t{1} << 20U, n / 4})
    for (const Detrend detrend : {Detrend::constant, Detrend::linear}) {
      WelchOptions options;
      options.segment = segment;
      options.detrend = detrend;
      options.threads = 1;
      const std::string what =
          fmt::format("segment {:>8}, {} detrend", segment, detrend == Detrend::constant ? "constant" : "linear");
      entries.push_back({"welch, " + what, [&, options] { sink += welch(x, 100, options).value[1]; }});
      if (detrend == Detrend::linear || segment != std::uint64_t{1} << 16U) continue;
      entries.push_back({"stream, " + what + ", pushed by 4096", [&, options] {
                           WelchStream stream(options);
                           for (std::size_t i = 0; i < n; i += 4096)
                             stream.push({x.data() + i, std::min<std::size_t>(4096, n - i)});
                           sink += stream.finish(100).value[1];
                         }});
      WelchOptions all = options;
      all.threads = 0;
      entries.push_back({"welch, " + what + ", all threads", [&, all] { sink += welch(x, 100, all).value[1]; }});
    }

  for (int round = 0; round < 5; ++round)
    for (Entry& entry : entries) entry.best = std::min(entry.best, seconds(entry.work));
  fmt::print("{} samples, one thread unless said, best of 5 (sink {:.3g})\n", n, sink);
  for (const Entry& entry : entries)
    fmt::print("{:>8.2f} ns/sample   {}\n", entry.best / static_cast<double>(n) * 1e9, entry.name);
  test::print_kernels("spectrum");
}
