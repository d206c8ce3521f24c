#include "libchar/log/inspection.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "libchar/core/error.hpp"
#include "libchar/core/parallel/parallel.hpp"
#include "libchar/core/text/readable.hpp"
#include "libchar/core/text/shown.hpp"
#include "libchar/core/text/text.hpp"
#include "libchar/log/between_channels.hpp"
#include "libchar/log/recording_json.hpp"

namespace libchar {
namespace {

// Channels are measured beside each other; each by one thread, so that nothing depends on their number.
class Meters final : public BlockSink {
 public:
  Meters(int threads, bool traced) : threads_(threads), traced_(traced) {}

  void begin(const LogInfo& so_far) override {
    meters_.resize(so_far.channels.size());
    traces_.resize(traced_ ? meters_.size() : 0);
    arena_.limit_to(threads_);
  }
  void block(const SampleBlock& samples) override {
    arena_.run([&] {
      parallel::for_each(0, meters_.size(), [&](std::size_t c) {
        meters_[c].push({samples.channels[c], samples.rows});
        if (traced_) traces_[c].push({samples.channels[c], samples.rows});
      });
    });
  }
  /// Once: the meter goes, as those of many channels take more than all that they say.
  ChannelQuality quality(std::size_t channel, double rate_hz) {
    const QualityMeter meter = std::move(meters_[channel]);
    return meter.finish(rate_hz);
  }
  std::vector<Trace> traces() const {
    std::vector<Trace> out;
    for (const TraceMeter& one : traces_) out.push_back(one.finish(kSmall));
    return out;
  }

 private:
  static constexpr std::size_t kSmall = 100;  // blocks of a trace as wide as a word or two
  int threads_;
  bool traced_;
  parallel::Threads arena_;
  std::vector<QualityMeter> meters_;
  std::vector<TraceMeter> traces_;
};

Inspection inspect_rows(const std::string& path, const ReadOptions& options, Progress& progress, bool traces) {
  Meters meters(options.threads, traces);
  Inspection inspection;
  inspection.info = read_log(path, options, meters, progress);
  for (std::size_t c = 0; c < inspection.info.channels.size(); ++c)
    inspection.quality.push_back(meters.quality(c, inspection.info.time.rate_hz));
  inspection.traces = meters.traces();
  judge_together(inspection.info.channels, [&](std::size_t c) -> ChannelQuality& { return inspection.quality[c]; });
  return inspection;
}

// What a log holds, where one of its topics has to be chosen before anything can be read.
Inspection list_topics(const std::string& path, const ReadOptions& options) {
  Inspection listing;
  listing.info = log_listing(path, options);
  return listing;
}

}  // namespace

Inspection inspect(const std::string& path, const ReadOptions& options, Progress& progress, bool traces) {
  try {
    return inspect_rows(path, options, progress, traces);
  } catch (const Error& error) {
    if (error.problem().code != kTopicNotChosen) throw;
  }
  return list_topics(path, options);
}

bool is_listing(const LogInfo& info) { return !info.topics.empty() && info.channels.empty(); }

std::string summary_line(const LogInfo& info) {
  const TimeBase& time = info.time;
  if (is_listing(info))
    return fmt::format("{}: {}, choose one", printable(info.file), plural(info.topics.size(), "topic"));
  std::string line = fmt::format("{}: {}, ", printable(info.file), plural(info.channels.size(), "channel"));
  if (time.rate_hz > 0) {
    line += detail::frequency_text(time.rate_hz, 6);
    line += time.from_stamps ? fmt::format(" (jitter {})", duration_text(time.jitter_s, 2)) : " (given)";
    line += ", " + duration_text(static_cast<double>(info.samples) / time.rate_hz);
  } else {
    line += plural(info.samples, "sample") + ", rate unknown";
  }
  line += ", " + plural(time.gaps, "gap");
  if (time.missing_samples > 0) line += fmt::format(" ({})", plural(time.missing_samples, "missing sample"));
  return line;
}

Json inspection_json(const std::vector<Inspection>& inspections) {
  Json document = Json::object();
  document["format"] = "inspect";
  document["version"] = 1;
  document["recordings"] = Json::array();
  for (const Inspection& inspection : inspections)
    document["recordings"].push_back(recording_json(inspection.info, inspection.quality, inspection.traces));
  return document;
}

}  // namespace libchar
