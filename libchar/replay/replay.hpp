#pragma once
// Every fusion algorithm that a scene can run, on one recording.

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "libchar/core/process/progress.hpp"
#include "libchar/core/process/work.hpp"
#include "libchar/log/write.hpp"
#include "libchar/replay/replay_result.hpp"
#include "libchar/scene/scene.hpp"

namespace libchar {
// Who receives what a replay or a fusion makes, in order of time: a log, when it is a ColumnWriter.

struct ColumnSink {
  virtual ~ColumnSink() = default;
  /// Columns and time base of what comes.
  virtual void begin(const LogInfo& columns) = 0;
  virtual void block(std::span<const std::span<const double>> columns) = 0;
};

/// Writes what comes as a log; nothing appears before finish().
class ColumnWriter final : public ColumnSink {
 public:
  ColumnWriter(std::string path, const WriteOptions& writing) : path_(std::move(path)), writing_(writing) {}
  void begin(const LogInfo& columns) override {
    LogInfo info = columns;
    info.file = path_;
    writer_ = open_log_writer(path_, info, writing_);
  }
  void block(std::span<const std::span<const double>> columns) override { writer_->write(columns); }
  /// Everything but the names: for who commits the files together with others. Throws Error(output).
  std::vector<WholeFile*> complete() { return writer_->complete(); }
  /// Returns the files that were written. Throws Error(output).
  std::vector<std::string> finish() {
    writer_->finish();
    return writer_->files();
  }
  /// The files that `finish` gives their names.
  std::vector<std::string> files() const { return writer_->files(); }
  std::vector<std::string> losses() const { return writer_->losses(); }

 private:
  std::string path_;
  WriteOptions writing_;
  std::unique_ptr<LogWriter> writer_;
};

struct ReplayOptions {
  std::vector<SceneAlgorithm> algorithms;          ///< win over the scene's list; `line` 0
  std::optional<TimeWindow> learning, evaluation;  ///< win over the scene's
  bool published = false;  ///< where no list says what runs: also the published forms, next to the robust ones
  double window_s = 0;     ///< of the window RMS; 0: a fiftieth of the run
  bool allan = true;       ///< Allan deviation of each error
  bool no_skip = false;    ///< do all work, whether an output needs it or not: same numbers
  /// processor time that leave-one-out of one algorithm may take, by the declared cost of its steps; beyond it runs on
  /// stretches of the evaluation, or not at all. Infinite: no limit
  double budget_s = 10;
  bool timing = true;  ///< measure run times and memory; without them the same input gives the same bytes of a report
  std::size_t block = 0;  ///< instants at once; 0: by length. Results do not depend on it
};

/// Resources of a replay apart from its options; they do not change the result.
struct ReplayWorkspace {
  HeapMeter* heap = nullptr;  ///< who can say how much memory an algorithm holds; none: it is not measured
  /// Who wants the estimates; none: they are not kept. Columns: t (seconds from the recording's first sample), the
  /// true inputs (missing without a reference), then label by label, input by input.
  ColumnSink* estimates = nullptr;
};

/// What would be done, in sentences; reads the recording once to know its length and rate.
std::vector<std::string> explain_replay(const Scene& scene, const ReplayOptions& options = {},
                                        Progress& progress = no_progress());

/// Throws Error(input) when the scene does not fit its recording, Error(numeric) when no algorithm can run.
ReplayResult replay(const Scene& scene, const ReplayOptions& options = {}, Progress& progress = no_progress(),
                    const ReplayWorkspace& workspace = {});

// Options of algorithms from the command line: one value, or a row of them that makes an algorithm run several times.

struct Sweep {
  std::string algorithm, option;
  std::vector<double> values;
};

/// "minque.gamma=0.99", "minque.gamma=.9,.99,.999", "perceptron.neurons=3..30" (whole numbers, all of up to twelve,
/// else twelve at about equal ratios). `where` is the option of the command line, for messages. Throws Error(usage):
/// another form, an unknown algorithm or option, a value out of range, more than `most` values.
Sweep parse_sweep(const std::string& text, const std::string& where, std::size_t most = 100);

/// Every algorithm of the list that is swept is listed once for each combination of the values;
/// one that is not in the list is added.
std::vector<SceneAlgorithm> swept(const std::vector<Sweep>& sweeps, const std::vector<SceneAlgorithm>& algorithms);

}  // namespace libchar
