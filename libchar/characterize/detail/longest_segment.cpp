#include "libchar/characterize/detail/channel_stage.hpp"
#include "libchar/core/refusal.hpp"
#include "libchar/log/channel_names.hpp"
#include "libchar/spectrum/welch.hpp"

namespace libchar {
namespace {

constexpr std::uint64_t kQuicklySetUp = std::uint64_t{1} << 20U;

struct Nothing final : BlockSink {
  void begin(const LogInfo&) override {}
  void block(const SampleBlock&) override {}
};

}  // namespace

void refuse_longer_segment(const std::string& path, const ReadOptions& reading, std::uint64_t samples, double seconds,
                           Progress& progress) {
  if ((samples == 0 && !(seconds > 0)) || read_once(path)) return;
  if (samples == 0) {
    const double rate_hz = read_log_head(path, reading).time.rate_hz;
    if (!(rate_hz > 0)) return;  // the reader says so
    samples = segment_samples(seconds, rate_hz);
  }
  if (samples <= kQuicklySetUp) return;
  ReadOptions counted = reading;
  counted.hash = false;
  Nothing nothing;
  const std::uint64_t longest = read_log(path, counted, nothing, progress).samples;
  if (samples <= longest) return;
  throw usage_error("E0875", "`segment`")
      .says("a segment of {} samples is longer than the record of {}", samples, longest)
      .hint("the longest that fits has {}", longest);
}

}  // namespace libchar
