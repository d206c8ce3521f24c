#pragma once
// The estimates of a replay as a log.

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "libchar/log/write.hpp"
#include "libchar/replay/replay.hpp"

namespace libchar {

/// Writes time (seconds from the recording's first sample), truth and estimates to a log while they
/// are made: the columns t, one a true input (missing without a reference), one a label and input.
/// The suffix of the path says the format. Give it to a replay as `ReplayWorkspace::estimates`.
class EstimatesWriter final : public EstimateSink {
 public:
  EstimatesWriter(std::string path, bool overwrite);

  void begin(const std::vector<std::string>& labels,
             const std::vector<InputResult>& inputs,
             double rate_hz,
             double start_s,
             std::uint64_t instants) override;
  void block(const std::vector<std::vector<double>>& columns) override;
  /// The files that `finish` gives their names.
  std::vector<std::string> files() const;
  /// Everything but the names: for who commits the files together with others. Throws Error(output).
  std::vector<WholeFile*> complete() { return writer_->complete(); }
  /// The file gets its name now. Returns the files that were written; throws Error(output).
  std::vector<std::string> finish();

 private:
  std::string path_;
  WriteOptions writing_;
  std::unique_ptr<LogWriter> writer_;
  std::size_t inputs_ = 1, labels_ = 0;
  std::vector<double> missing_, times_;
  double rate_hz_ = 1, start_s_ = 0;
  std::uint64_t done_ = 0;
};

}  // namespace libchar
