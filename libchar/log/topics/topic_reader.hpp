#pragma once
// The contract of formats that hold several streams (bags, flight logs, containers of arrays): a
// reader lists its topics, is told which fields of one topic to read, and delivers their rows.
// Choice of topic and channels, the time column, what is no sample, digests and progress are common
// (topic_rows.hpp); repairs and the grid are those of every format.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "libchar/core/finding.hpp"
#include "libchar/log/detail/row_source.hpp"
#include "libchar/log/recording.hpp"
#include "libchar/log/time/time_column.hpp"

namespace libchar {

class TopicReader {
 public:
  virtual ~TopicReader() = default;

  /// All streams of the file, those too whose fields cannot be read (`why_not`), in the file's order.
  virtual const std::vector<LogTopic>& topics() const = 0;

  /// What was understood of the file, in words ("MCAP, profile ros2, chunks zstd").
  virtual std::vector<std::string> dialect() const { return {}; }

  /// The fields that are channels unless somebody chooses: all, or all but what is no sample
  /// (covariances, sequence numbers).
  virtual std::vector<std::size_t> usual_fields(std::size_t topic) const {
    std::vector<std::size_t> all(topics()[topic].fields.size());
    for (std::size_t i = 0; i < all.size(); ++i) all[i] = i;
    return all;
  }

  /// The name of the stamps that rows of this topic bring ("header.stamp", "log time"), in ns; ""
  /// when they bring none and a field may be the time, as in a table.
  virtual std::string stamps(std::size_t topic) const = 0;

  /// A rate that the file says of this topic, where there are no stamps; 0 when it says none.
  virtual double stated_rate_hz(std::size_t topic) const {
    static_cast<void>(topic);
    return 0;
  }

  /// The first values of a field, for the rule that finds a time column; asked only where `stamps` is "".
  virtual FirstValues first_values(std::size_t topic, std::size_t field) {
    static_cast<void>(topic);
    static_cast<void>(field);
    return {};
  }

  /// Called once, before the first row: what `next` is to deliver. `time` is a field that holds stamps, in that unit
  /// (exact where they are integers); absent when rows bring stamps of their own or there are none.
  virtual void select(std::size_t topic, const std::vector<std::size_t>& fields, std::optional<std::size_t> time,
                      StampUnit unit) = 0;

  /// Appends up to `most` rows to a block whose columns (one a field, in the order of `select`)
  /// and, where there are stamps, time_ns are empty; sets block.rows. False at the end. Values as
  /// they are: infinities and NaN are looked at by the caller. What is lost of the file (a cut end,
  /// a broken chunk, a dropout) is counted in `warnings`, never an end without a word.
  virtual bool next(RowBlock& block, std::size_t most, Findings& warnings) = 0;

  /// Findings that need totals, and what was found lost while topics were listed: asked for after a
  /// listing too, without a `select`.
  virtual void finish(Findings& warnings) { static_cast<void>(warnings); }

  /// Bytes of the file consumed so far, for progress.
  virtual std::uint64_t bytes_read() const = 0;
};

}  // namespace libchar
