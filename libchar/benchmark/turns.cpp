#include "libchar/benchmark/turns.hpp"

#include <fmt/format.h>
#include <sys/utsname.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <fstream>
#include <numeric>
#include <thread>
#include <utility>

#include "libchar/core/numeric/distributions.hpp"

namespace libchar {
namespace {

double clock_seconds(clockid_t clock) {
  timespec now{};
  clock_gettime(clock, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// Processor seconds of everybody since the start of the machine; 0: the system does not say.
double busy_seconds() {
  std::ifstream in("/proc/stat");
  std::string word;
  double user = 0, nice = 0, system = 0;
  if (!(in >> word >> user >> nice >> system)) return 0;
  return (user + nice + system) / static_cast<double>(sysconf(_SC_CLK_TCK));
}

std::string processor_name() {
  std::ifstream in("/proc/cpuinfo");
  for (std::string line; std::getline(in, line);)
    if (line.rfind("model name", 0) == 0) {
      const std::size_t colon = line.find(": ");
      if (colon != std::string::npos) return line.substr(colon + 2);
    }
  return "unknown processor";
}

}  // namespace

std::vector<std::size_t> order_of_round(std::size_t count, std::size_t round) {
  std::vector<std::size_t> order(count);
  std::iota(order.begin(), order.end(), std::size_t{0});
  if (count == 0) return order;
  std::rotate(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(round / 2 % count), order.end());
  if (round % 2 == 1) std::reverse(order.begin(), order.end());
  return order;
}

double thread_seconds() { return clock_seconds(CLOCK_THREAD_CPUTIME_ID); }

MachineWatch::MachineWatch()
    : wall_(clock_seconds(CLOCK_MONOTONIC)), own_(clock_seconds(CLOCK_PROCESS_CPUTIME_ID)), busy_(busy_seconds()) {}

Machine MachineWatch::finish() const {
  Machine out;
  out.processor = processor_name();
  out.cores = std::max(1U, std::thread::hardware_concurrency());
  const auto pages = static_cast<double>(sysconf(_SC_PHYS_PAGES)), page = static_cast<double>(sysconf(_SC_PAGESIZE));
  out.memory_gib = pages * page / (1024.0 * 1024 * 1024);
  utsname names{};
  if (uname(&names) == 0) out.system = fmt::format("{} {}", names.sysname, names.machine);
  out.wall_s = clock_seconds(CLOCK_MONOTONIC) - wall_;
  out.cpu_s = clock_seconds(CLOCK_PROCESS_CPUTIME_ID) - own_;
  if (out.wall_s > 0) out.others = std::max(0.0, busy_seconds() - busy_ - out.cpu_s) / out.wall_s;
  return out;
}

std::string load_sentence(const Machine& machine) {
  if (!(machine.others > 0.1)) return "";
  return fmt::format("other programs kept {:.1f} of {} processors busy: intervals of times are wider than necessary",
                     machine.others, machine.cores);
}

namespace {

constexpr double kOutside = 0.025;  // on either side of an interval

constexpr double kOutsideOfRuns = 0.005, kLeastOfTimes = 0.015;

/// The largest k for which fewer than k of n values lie below the median with at most this probability; 0: none.
std::size_t median_rank(std::size_t n, double outside) {
  const auto trials = static_cast<double>(n);
  std::size_t k = 0;
  while (k < n / 2 && binomial_cdf(static_cast<double>(k), trials, 0.5) <= outside) ++k;
  return k;
}

Figure median_within(std::vector<double> values, double outside) {
  Figure out;
  out.count = values.size();
  if (values.empty()) return out;
  std::sort(values.begin(), values.end());
  const std::size_t n = values.size();
  out.value = n % 2 == 1 ? values[n / 2] : values[n / 2 - 1] + (values[n / 2] - values[n / 2 - 1]) / 2;
  if (const std::size_t k = median_rank(n, outside); k > 0) out.ci95 = {values[k - 1], values[n - k]};
  return out;
}

}  // namespace

Figure median_figure(std::vector<double> values) { return median_within(std::move(values), kOutside); }

Figure time_figure(std::vector<double> values) {
  Figure out = median_within(std::move(values), kOutsideOfRuns);
  out.ci95.low = std::min(out.ci95.low, (1 - kLeastOfTimes) * out.value);
  out.ci95.high = std::max(out.ci95.high, (1 + kLeastOfTimes) * out.value);
  return out;
}

Figure mean_figure(const std::vector<double>& values) {
  Figure out;
  out.count = values.size();
  if (values.empty()) return out;
  const auto n = static_cast<double>(values.size());
  double sum = 0, squares = 0;
  for (const double v : values) sum += v - values[0];
  out.value = values[0] + sum / n;
  for (const double v : values) squares += (v - out.value) * (v - out.value);
  if (values.size() < 2) return out;
  const double half = student_quantile(1 - kOutside, n - 1) * std::sqrt(squares / (n - 1) / n);
  out.ci95 = {out.value - half, out.value + half};
  return out;
}

Figure rms_figure(const std::vector<double>& values) {
  Figure out;
  out.count = values.size();
  if (values.empty()) return out;
  double squares = 0;
  for (const double v : values) squares += v * v;
  out.value = std::sqrt(squares / static_cast<double>(values.size()));
  out.ci95 = chi_square_interval(out.value, static_cast<double>(values.size()), 0.95);
  return out;
}

Figure share_figure(std::size_t hits, std::size_t count) {
  Figure out;
  out.count = count;
  if (count == 0) return out;
  const auto n = static_cast<double>(count);
  const double p = static_cast<double>(hits) / n, z2 = kNormal95 * kNormal95;
  const double centre = (p + z2 / (2 * n)) / (1 + z2 / n);
  const double half = kNormal95 / (1 + z2 / n) * std::sqrt(p * (1 - p) / n + z2 / (4 * n * n));
  out.value = p;
  out.ci95 = {std::max(0.0, centre - half), std::min(1.0, centre + half)};
  return out;
}

bool unresolved(const Figure& a, const Figure& b) { return !(a.ci95.high < b.ci95.low || b.ci95.high < a.ci95.low); }

}  // namespace libchar
