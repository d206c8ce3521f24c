#include "libchar/log/convert.hpp"

#include <algorithm>
#include <memory>
#include <span>

#include "libchar/core/file/output_files.hpp"
#include "libchar/core/file/whole_file.hpp"
#include "libchar/core/refusal.hpp"

namespace libchar {
namespace {

// Writes what it is given; `known` is what an earlier reading found, which is better than what the first rows say.
class Writing final : public BlockSink {
 public:
  Writing(const std::string& to, const WriteOptions& options, const LogInfo* known)
      : to_(to), options_(options), known_(known) {}

  void begin(const LogInfo& so_far) override {
    writer_ = open_log_writer(to_, known_ != nullptr ? *known_ : so_far, options_);
  }
  void block(const SampleBlock& samples) override {
    columns_.clear();
    for (const double* channel : samples.channels) columns_.emplace_back(channel, samples.rows);
    writer_->write(columns_);
  }
  LogWriter& writer() { return *writer_; }

 private:
  const std::string& to_;
  const WriteOptions& options_;
  const LogInfo* known_;
  std::unique_ptr<LogWriter> writer_;
  std::vector<std::span<const double>> columns_;
};

struct Nothing final : BlockSink {
  void begin(const LogInfo&) override {}
  void block(const SampleBlock&) override {}
};

void write_whole(Writing& sink, const Recording& recording) {
  sink.begin(recording.info);
  SampleBlock all;
  all.rows = static_cast<std::size_t>(recording.info.samples);
  for (const auto& channel : recording.samples) all.channels.push_back(channel.data());
  sink.block(all);
}

LogInfo known_beforehand(const std::string& from, ReadOptions reading, Progress& progress) {
  reading.hash = false;
  Nothing nothing;
  return read_log(from, reading, nothing, progress);
}

// The rows of a table that joins the rows of several clocks are no instants of any of them.
void refuse_without_grid(const LogInfo& log) {
  if (log.channels.size() < 2 ||
      !std::all_of(log.channels.begin(), log.channels.end(), [](const Channel& one) { return one.every > 1; }))
    return;
  const auto fastest = std::min_element(log.channels.begin(), log.channels.end(),
                                        [](const Channel& a, const Channel& b) { return a.every < b.every; });
  throw input_error("E0341", log.file)
      .says("each channel has rows, and a clock, of its own: no grid holds the samples of all")
      .hint("`channels` {} writes one of them", fastest->name);
}

void check_paths(const std::string& from, const std::string& to, const WriteOptions& options) {
  for (const char* suffix : {"", ".json", ".yaml", ".yml"})
    for (const char* other : {"", ".json"}) refuse_same_file(from + suffix, to + other);
  check_log_output(to, options);
}

}  // namespace

Conversion convert_log(const std::string& from, const std::string& to, const ConvertOptions& options,
                       Progress& progress) {
  check_paths(from, to, options.writing);
  // Stamps want the rate before the first row, and the rate is best known after the last.
  const bool stamps = writes_stamps(to, options.writing), once = read_once(from);
  LogInfo known;
  if (stamps && !once) known = known_beforehand(from, options.reading, progress);
  Writing sink(to, options.writing, stamps && !once ? &known : nullptr);
  Conversion out;
  if (stamps && once) {
    const Recording recording = read_recording(from, options.reading, progress);
    write_whole(sink, recording);
    out.log = recording.info;
  } else {
    out.log = read_log(from, options.reading, sink, progress);
  }
  refuse_without_grid(out.log);
  if (options.only_without_warnings && !out.log.warnings.empty()) return out;
  LogWriter& writer = sink.writer();
  writer.refine(out.log);
  progress.update(1, "writing " + to);  // the last chance to be stopped
  writer.finish();
  out.files = writer.files();
  out.losses = writer.losses();
  return out;
}

}  // namespace libchar
