// The main job as a table of contents: read once → per channel keep or stream → curves → fit → intervals.

#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <chrono>

#include "libchar/characterize/detail/channel_stage.hpp"

namespace libchar {
namespace {

// With a segment given nothing needs the whole record; short logs are still kept, because exact forms cost nothing there.
constexpr std::uint64_t kSmallLogBytes = std::uint64_t{64} << 20U;

class Stages : public BlockSink {
 public:
  explicit Stages(CharacterizeOptions& options) : options_(options) {
    const bool whole_record_needed =
        options.wanted.spectrum && options.spectrum.segment == 0 && !(options.segment_s > 0);
    budget_ = whole_record_needed || options.full_overlap
                  ? options.memory_bytes
                  : std::min(options.memory_bytes, kSmallLogBytes);
  }

  void begin(const LogInfo& so_far) override {
    const std::size_t channels = so_far.channels.size();
    if (options_.wanted.spectrum && options_.spectrum.segment == 0 && options_.segment_s > 0)
      options_.spectrum.segment = segment_samples(options_.segment_s, so_far.time.rate_hz);
    for (std::size_t c = 0; c < channels; ++c) stages_.emplace_back(options_);
    arena_.initialize(threads_beside_reading(so_far, options_.reading.threads));
    if (surely_too_long(so_far)) {
      for (ChannelStage& stage : stages_) stage.stop_keeping();
      return;
    }
    // No value takes less than a byte of the file, and no more than the budget is kept.
    const std::uint64_t most =
        std::min(so_far.bytes, budget_ / sizeof(double)) / std::max<std::size_t>(channels, 1);
    for (ChannelStage& stage : stages_) stage.reserve(most);
  }

  void block(const SampleBlock& samples) override {
    kept_bytes_ += samples.rows * samples.channels.size() * sizeof(double);
    const bool too_much = kept_bytes_ > budget_;
    arena_.execute([&] {
      tbb::parallel_for(std::size_t{0}, stages_.size(), [&](std::size_t c) {
        if (too_much) stages_[c].stop_keeping();
        stages_[c].push({samples.channels[c], samples.rows});
      });
    });
  }

  // Feeds only the stages that asked for the second pass.
  void second_pass(const std::string& path, Progress& progress) {
    std::vector<std::size_t> wanted;
    for (std::size_t c = 0; c < stages_.size(); ++c)
      if (stages_[c].needs_second_pass()) wanted.push_back(c);
    if (wanted.empty() || read_once(path)) return;
    struct Again final : BlockSink {
      std::vector<ChannelStage*> stages;
      std::vector<std::size_t> channels;
      int threads = 0;
      tbb::task_arena arena;
      void begin(const LogInfo& so_far) override {
        arena.initialize(threads_beside_reading(so_far, threads));
      }
      void block(const SampleBlock& samples) override {
        arena.execute([&] {
          tbb::parallel_for(std::size_t{0}, stages.size(), [&](std::size_t k) {
            stages[k]->push({samples.channels[channels[k]], samples.rows});
          });
        });
      }
    } again;
    again.threads = options_.reading.threads;
    for (const std::size_t c : wanted) {
      stages_[c].begin_second_pass();
      again.stages.push_back(&stages_[c]);
      again.channels.push_back(c);
    }
    ReadOptions reading = options_.reading;
    reading.hash = false;
    read_log(path, reading, again, progress);
  }

  std::vector<ChannelResult> finish(const LogInfo& log, Progress& progress) {
    std::vector<ChannelResult> results(stages_.size());
    // Two channels at a time: memory stays bounded however many there are.
    const std::size_t group = 2;
    for (std::size_t first = 0; first < stages_.size(); first += group) {
      progress.update(static_cast<double>(first) / static_cast<double>(stages_.size()), "fitting");
      const std::size_t last = std::min(stages_.size(), first + group);
      tbb::parallel_for(first, last, [&](std::size_t c) {
        results[c] = stages_[c].finish(log.channels[c], log.time.rate_hz);
      });
    }
    return results;
  }

 private:
  // Samples that will not be kept in the end need not be kept in the beginning. What is expected may be wrong by a factor; a log
  // that would just fit must not be streamed for that.
  bool surely_too_long(const LogInfo& so_far) const {
    constexpr double kDoubt = 4;
    const bool window = options_.reading.from_s || options_.reading.to_s;
    const double bytes = static_cast<double>(so_far.rows) *
                         static_cast<double>(so_far.channels.size()) * sizeof(double);
    return !window && options_.data != SampleKind::phase &&
           bytes > kDoubt * static_cast<double>(budget_);
  }

  CharacterizeOptions& options_;
  std::uint64_t budget_ = 0, kept_bytes_ = 0;
  tbb::task_arena arena_;
  std::vector<ChannelStage> stages_;
};

}  // namespace

Characterization characterize(const std::string& path,
                              const CharacterizeOptions& given,
                              Progress& progress) {
  const auto start = std::chrono::steady_clock::now();
  AllanCovarianceCache covariances;
  CharacterizeOptions options = given;
  options.fit.covariances = &covariances;
  SpectrumMemory memory;
  options.spectrum.memory = &memory;
  Characterization result;
  Stages stages(options);
  result.log = read_log(path, options.reading, stages, progress);
  stages.second_pass(path, progress);
  result.channels = stages.finish(result.log, progress);
  result.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return result;
}

}  // namespace libchar
