#pragma once
// Who receives what a replay or a fusion makes, in order of time: a log, when it is a ColumnWriter.

#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "libchar/log/write.hpp"

namespace libchar {

struct ColumnSink {
  virtual ~ColumnSink() = default;
  /// Columns and time base of what comes.
  virtual void begin(const LogInfo& columns) = 0;
  virtual void block(std::span<const std::span<const double>> columns) = 0;
};

/// Writes what comes as a log; nothing appears before finish().
class ColumnWriter final : public ColumnSink {
 public:
  ColumnWriter(std::string path, const WriteOptions& writing)
      : path_(std::move(path)), writing_(writing) {}
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

}  // namespace libchar
