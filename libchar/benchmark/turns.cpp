#include "libchar/benchmark/turns.hpp"

#include <fmt/format.h>
#include <sys/utsname.h>
#include <unistd.h>

#include <algorithm>
#include <ctime>
#include <fstream>
#include <numeric>
#include <thread>

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
  std::rotate(
      order.begin(), order.begin() + static_cast<std::ptrdiff_t>(round / 2 % count), order.end());
  if (round % 2 == 1) std::reverse(order.begin(), order.end());
  return order;
}

double thread_seconds() {
  return clock_seconds(CLOCK_THREAD_CPUTIME_ID);
}

MachineWatch::MachineWatch()
    : wall_(clock_seconds(CLOCK_MONOTONIC)),
      own_(clock_seconds(CLOCK_PROCESS_CPUTIME_ID)),
      busy_(busy_seconds()) {}

Machine MachineWatch::finish() const {
  Machine out;
  out.processor = processor_name();
  out.cores = std::max(1U, std::thread::hardware_concurrency());
  const auto pages = static_cast<double>(sysconf(_SC_PHYS_PAGES)),
             page = static_cast<double>(sysconf(_SC_PAGESIZE));
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
  return fmt::format(
      "other programs kept {:.1f} of {} processors busy meanwhile: times have wider intervals "
      "than they need",
      machine.others,
      machine.cores);
}

}  // namespace libchar
