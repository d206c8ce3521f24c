// DADEV(t, tau): the deviation of the window of W samples around t. Windows are independent of each
// other, O(N W log W / step) at octaves.

#include <fmt/format.h>

#include <algorithm>

#include "libchar/allan/allan_deviation.hpp"
#include "libchar/core/numeric/whole.hpp"
#include "libchar/core/parallel/parallel.hpp"
#include "libchar/core/refusal.hpp"

namespace libchar {
namespace {

constexpr std::uint64_t kShortestWindow = 8, kMostWindows = 1000000;

void check_window(std::uint64_t samples, std::uint64_t window, std::uint64_t step) {
  if (window < kShortestWindow)
    throw usage_error("E0871", "`dynamic`")
        .says("a window needs at least {} samples", kShortestWindow)
        .got(std::to_string(window));
  if (window > samples)
    throw usage_error("E0871", "`dynamic`")
        .says("the window is longer than the record of {} samples", samples)
        .got(std::to_string(window));
  if ((samples - window) / step >= kMostWindows)
    throw usage_error("E0871", "`dynamic`")
        .says("more than {} windows; a longer step makes fewer", kMostWindows)
        .got(std::to_string(step));
}

}  // namespace

DynamicDeviation dynamic_deviation(std::span<const double> record, double dt_s, const DynamicOptions& dynamic,
                                   const AllanOptions& options) {
  const std::uint64_t window = dynamic.window,
                      step = dynamic.step > 0 ? dynamic.step : std::max<std::uint64_t>(1, window / 2);
  check_window(record.size(), window, step);
  DynamicDeviation out;
  out.type = options.type;
  out.windows.resize(detail::in_memory((record.size() - window) / step + 1));
  std::vector<char> empty(out.windows.size());
  parallel::for_each(0, out.windows.size(), [&](std::size_t k) {
    const std::uint64_t from = k * step;
    DynamicWindow& result = out.windows[k];
    result.from_s = static_cast<double>(from) * dt_s;
    result.to_s = static_cast<double>(from + window) * dt_s;
    try {
      result.curve = allan_deviation(record.subspan(detail::in_memory(from), detail::in_memory(window)), dt_s, options);
    } catch (const Error& error) {
      if (error.problem().kind != ErrorKind::numeric) throw;
      empty[k] = 1;
    }
  });
  const auto lost = std::count(empty.begin(), empty.end(), 1);
  if (static_cast<std::size_t>(lost) == out.windows.size())
    throw numeric_error("E0401")
        .says("no window of the record gives a deviation: too few samples are there")
        .hint("a longer window may");
  if (lost > 0) out.notes.push_back(fmt::format("{} of {} windows hold too few samples", lost, out.windows.size()));
  return out;
}

}  // namespace libchar
