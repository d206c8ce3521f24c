#include "tests/support/kernels.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <memory>
#include <numeric>
#include <random>

#include "libchar/allan/allan_deviation.hpp"
#include "libchar/allan/allan_pyramid.hpp"
#include "libchar/benchmark/turns.hpp"
#include "libchar/characterize/characterization.hpp"
#include "libchar/core/numeric/moments.hpp"
#include "libchar/fusion/detail/delay_search.hpp"
#include "libchar/log/csv/head/dialect.hpp"
#include "libchar/log/csv/rows/rows.hpp"
#include "libchar/log/quality.hpp"
#include "libchar/simulate/detail/flicker.hpp"
#include "libchar/simulate/random.hpp"
#include "libchar/spectrum/welch_sums.hpp"

using namespace libchar;

namespace test {
namespace {

constexpr std::size_t kSamples = std::size_t{1} << 17U;

const std::vector<double>& samples() {
  static const std::vector<double> made = [] {
    std::vector<double> out(kSamples);
    std::mt19937_64 random(7);
    std::normal_distribution<double> noise(9.81, 0.01);
    for (double& x : out) x = noise(random);
    return out;
  }();
  return made;
}

Kernel of_samples(std::string name, std::function<double()> run) {
  return {std::move(name), kSamples * sizeof(double), std::move(run)};
}

/// Rows of seven columns, of which `used` are read.
Kernel csv_rows(std::string name, int used) {
  auto text = std::make_shared<std::string>("t,a,b,c,d,e,f\n");
  for (std::size_t i = 0; i + 6 <= kSamples / 4; i += 6)
    *text +=
        fmt::format("{:.3f},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g}\n", static_cast<double>(i) * .005, samples()[i],
                    samples()[i + 1], samples()[i + 2], samples()[i + 3], samples()[i + 4], samples()[i + 5]);
  LogInfo info;
  const std::string_view head = std::string_view(*text).substr(0, std::size_t{1} << 16U);
  auto dialect = std::make_shared<csv::Dialect>(csv::understand(head, false, ReadOptions{}, info));
  csv::Plan plan;
  plan.dialect = dialect.get();
  plan.target.assign(7, csv::Plan::kSkip);
  plan.target[0] = csv::Plan::kTime;
  std::iota(plan.target.begin() + 1, plan.target.begin() + 1 + used, 0);
  plan.channels = static_cast<std::size_t>(used);
  const std::size_t size = text->size();
  text->append(csv::kPadding, '\0');
  auto chunk = std::make_shared<csv::ParsedChunk>();
  return {std::move(name), size, [=] {
            csv::parse_rows(std::string_view(*text).substr(dialect->data_offset, size - dialect->data_offset), plan,
                            *chunk);
            return chunk->rows.columns[0].back() + static_cast<double>(chunk->rows.rows);
          }};
}

std::vector<Kernel> csv_kernels() {
  return {csv_rows("rows of seven columns", 6), csv_rows("rows of which two columns are read", 1),
          of_samples("quality", [] {
            QualityMeter meter;
            meter.push(samples());
            return meter.finish().difference_sd;
          })};
}

std::vector<Kernel> allan_kernels() {
  const auto deviation = [](DeviationType type) {
    return [type] {
      AllanOptions options;
      options.type = type;
      options.threads = 1;
      options.taus_s = {64};
      options.grid = TauGrid::list;
      return allan_deviation(samples(), 1, options).points.at(0).deviation;
    };
  };
  return {of_samples("pyramid of all octaves",
                     [] {
                       AllanPyramid pyramid;
                       pyramid.push(samples());
                       return pyramid.finish(1).points.back().deviation;
                     }),
          of_samples("moments",
                     [] {
                       Moments moments;
                       moments.push(samples());
                       return moments.variance();
                     }),
          of_samples("extremes of a plot",
                     [] {
                       TraceMeter meter;
                       meter.push(samples());
                       return meter.finish().high.front();
                     }),
          of_samples("second differences of the phase", deviation(DeviationType::oadev)),
          of_samples("third differences of the phase", deviation(DeviationType::ohdev))};
}

Kernel welch_kernel(std::string name, WelchOptions options) {
  options.threads = 1;
  return of_samples(std::move(name), [options] {
    WelchStream stream(options);
    stream.push(samples());
    return stream.finish(1).value[1];
  });
}

std::vector<Kernel> spectrum_kernels() {
  WelchOptions halves;
  halves.segment = std::uint64_t{1} << 13U;
  WelchOptions whole = halves, line = halves;
  whole.overlap = 0.25;
  line.detrend = Detrend::linear;
  return {welch_kernel("half segments", halves), welch_kernel("segments, mean removed", whole),
          welch_kernel("segments, line removed", line)};
}

std::vector<Kernel> noise_kernels() {
  const auto out = std::make_shared<std::vector<double>>(kSamples);
  return {of_samples("normal deviates",
                     [out] {
                       DeviateStream({1, 0, Purpose::truth}).fill_normal(*out);
                       return out->back();
                     }),
          of_samples("flicker filter", [out, filter = design_flicker(0)] {
            *out = samples();
            FlickerStream(filter).run(*out);
            return out->back();
          })};
}

std::vector<Kernel> fusion_kernels() {
  constexpr std::size_t kDimension = 5, kStarts = 2000;
  return {{"nearest stretches", kStarts * kDimension * sizeof(double),
           [search = std::make_shared<fusion::DelaySearch>(kDimension, 8, kStarts)] {
             return search->nearest(samples().data(), kStarts, samples().data() + kStarts + 100).front().distance;
           }}};
}

}  // namespace

std::vector<Kernel> kernels_of(std::string_view group) {
  return group == "csv"        ? csv_kernels()
         : group == "allan"    ? allan_kernels()
         : group == "spectrum" ? spectrum_kernels()
         : group == "noise"    ? noise_kernels()
                               : fusion_kernels();
}

KernelTime time_of(Kernel kernel, int rounds) {
  const auto timed = [](const auto& work, double& best) {
    const double before = thread_seconds();
    work();
    best = std::min(best, thread_seconds() - before);
  };
  constexpr double kNone = 1e9;
  KernelTime out{std::move(kernel), kNone};
  const auto kinds = static_cast<std::size_t>(detail::instructions_there()) + 1;
  out.seconds.assign(kinds, kNone);
  out.results.resize(kinds);
  std::vector<char> from(out.kernel.bytes, 'a'), to(out.kernel.bytes);
  for (int round = 0; round < rounds; ++round) {
    for (std::size_t i = 0; i < kinds; ++i) {
      const detail::UseInstructions use(detail::kAllInstructions[i]);
      timed([&] { out.results[i] = out.kernel.run(); }, out.seconds[i]);
    }
    timed([&] { std::memcpy(to.data(), from.data(), from.size()); }, out.copy_s);
    from[0] = to.back();
  }
  return out;
}

void print_kernels(std::string_view group) {
  constexpr const char* kNames[] = {"any", "AVX2"};
  fmt::print("\n{:<36} {:>12} {:>10} {:>12} {:>10}\n", "kernel", "instructions", "MB/s", "of memcpy", "x any");
  for (const Kernel& kernel : kernels_of(group)) {
    const KernelTime time = time_of(kernel);
    for (std::size_t i = 0; i < time.seconds.size(); ++i)
      fmt::print("{:<36} {:>12} {:>10.0f} {:>12.3f} {:>10.2f}\n", i == 0 ? kernel.name : "", kNames[i],
                 static_cast<double>(kernel.bytes) / time.seconds[i] * 1e-6, time.copy_s / time.seconds[i],
                 time.seconds[0] / time.seconds[i]);
  }
}

}  // namespace test
