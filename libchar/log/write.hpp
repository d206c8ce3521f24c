#pragma once
// Writing logs, streaming, in the formats of formats.hpp. What is written reads back to the same bits.

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "libchar/core/file/output_files.hpp"
#include "libchar/log/formats.hpp"
#include "libchar/log/recording.hpp"

namespace libchar {

struct WriteOptions {
  std::string format = "auto";        ///< "auto" (by suffix) or a name of formats.hpp
  std::string dtype = "f64";          ///< npy, raw: "f64" or "f32"
  std::string order = "interleaved";  ///< raw: "interleaved" or "planar" (npy: C order or Fortran order)
  bool big_endian = false;
  bool time_column = true;  ///< csv: write a first column t[s] (t[ns] when the log starts at an
                            ///< absolute stamp), npy: none
  bool overwrite = false;
};

/// A log being written block by block; nothing appears under its name before finish().
class LogWriter {
 public:
  virtual ~LogWriter() = default;
  /// `columns[c]` holds the block of channel c; all of the same length. Missing samples are written
  /// as empty cells / NaN.
  virtual void write(std::span<const std::span<const double>> columns) = 0;
  /// What only the end of reading knew better (the rate); before finish(). CSV has written its
  /// stamps by then and keeps them.
  virtual void refine(const LogInfo& info) { static_cast<void>(info); }
  /// Everything but the names: what is left to write is written. The files, the log first, which
  /// last as long as the writer: for who commits them together with others.
  virtual std::vector<WholeFile*> complete() = 0;
  /// Completes the file (and its sidecar) and gives it its name.
  void finish() { commit_together(complete()); }
  /// The files written, the log first.
  virtual std::vector<std::string> files() const = 0;
  /// What this format cannot hold of this log, in sentences ("units: a .npy file has no place for them").
  virtual std::vector<std::string> losses() const { return {}; }
};

/// Channel names, units, rate and start come from `info`. Throws Error(usage) for an unknown format or suffix.
std::unique_ptr<LogWriter> open_log_writer(const std::string& path, const LogInfo& info,
                                           const WriteOptions& options = {});

/// Throws what opening the writer would for the name, the options and the files that are there,
/// before any work; leaves nothing behind.
void check_log_output(const std::string& path, const WriteOptions& options);

/// The format that `path` and `options` ask for.
LogFormat format_to_write(const std::string& path, const WriteOptions& options);

/// The log will have a column of stamps: its rate has to be known before the first row.
bool writes_stamps(const std::string& path, const WriteOptions& options);

}  // namespace libchar
