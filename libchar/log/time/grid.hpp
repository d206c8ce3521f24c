#pragma once
// From rows with stamps to samples on a uniform grid, streaming: missing samples are put in as NaN
// (never interpolated), doubled and backward rows are dropped, rollovers are unwrapped, and
// everything is counted.
// The interval comes from first_interval.hpp, the rate from stamp_sketch.hpp; what becomes of a
// stamp that does not fit is decided in time_repairs.cpp.

#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "libchar/log/detail/row_source.hpp"
#include "libchar/log/read.hpp"
#include "libchar/log/time/first_interval.hpp"
#include "libchar/log/time/stamp_sketch.hpp"
#include "libchar/log/time/time_repairs.hpp"

namespace libchar {

inline constexpr std::int64_t kMostNs = std::int64_t{1}
                                        << 62U;  ///< of a stamp, and between two of a log
inline constexpr std::size_t kRowsAhead =
    16;  ///< rows looked at before a late stamp is called a gap

/// Places rows on the grid and passes them to the sink in order.
class TimeGrid {
 public:
  TimeGrid(const RowSource& source,
           const ReadOptions& options,
           BlockSink& sink,
           Warnings& warnings);

  /// Takes the block's rows (its buffers come back for reuse). Returns false when the window's end
  /// has been reached.
  bool push(RowBlock& block);
  /// The rest, and what is now known of the time base.
  void finish(LogInfo& info);
  bool began() const { return began_; }

 private:
  struct Pending {
    RowBlock block;
    std::uint64_t rows_before = 0;
    std::size_t done = 0;
  };
  void begin();
  void learn();
  void say_pattern(const FirstInterval& found);
  double even_interval();
  void process(bool end);
  void process_rows(Pending& front, std::size_t count);
  bool take_regular(const std::int64_t* time, std::size_t n);
  bool take_one_by_one(
      Pending& front, std::size_t from, std::size_t to, std::size_t ahead, std::size_t& run);
  void without_stamps(Pending& front);
  /// The stamp, when it and its distance from the first leave room for every sum and difference in
  /// 64 bits. Throws Error(input) else.
  std::int64_t checked(const Pending& front, std::size_t row, std::int64_t stamp) const;
  enum class Verdict { keep, drop };
  Verdict decide(const Pending& front, std::size_t row, std::int64_t& stamp, std::size_t ahead);
  void place_late_row(const Pending& front,
                      std::size_t row,
                      std::int64_t step,
                      std::int64_t& stamp);
  void pass_gap(const Pending& front, std::size_t row, std::int64_t step, std::int64_t gap);
  Verdict backward(const Pending& front, std::size_t row, std::int64_t& stamp);
  void unwrap(const Pending& front, std::size_t row, const Rollover& rollover, std::int64_t& stamp);
  std::int64_t lag(const Pending& front,
                   std::size_t row,
                   std::int64_t stamp,
                   std::size_t ahead) const;
  void watch_rate(const Pending& front, std::size_t row, double ratio);
  void emit_rows(const RowBlock& block, std::size_t from, std::size_t to);
  void emit_missing(std::uint64_t count);
  void flush();
  void deliver(const std::vector<const double*>& channels, std::size_t rows);
  std::string place(const Pending& front, std::size_t row) const;
  [[noreturn]] void fail(const Pending& front,
                         std::size_t row,
                         std::string code,
                         std::string what,
                         std::string hint = "") const;

  const RowSource& source_;
  const ReadOptions& options_;
  BlockSink& sink_;
  Warnings& warnings_;
  std::deque<Pending> pending_;
  std::vector<RowBlock> spare_;
  std::uint64_t rows_ = 0, waiting_ = 0;
  bool stamped_ = false, began_ = false, learned_ = false, window_over_ = false;
  bool coarse_ = false;                 ///< stamps do not tell rows apart, one by one
  double dt_ = 0;                       // ns
  std::int64_t limit_ = 0, least_ = 1;  // longest and shortest regular step, ns
  std::int64_t first_stamp_ = 0, last_ = 0, wrap_ = 0, from_ns_ = 0, to_ns_ = 0;
  std::int64_t raw_last_ = 0;  // last_ as the file has it
  bool have_last_ = false;
  std::int64_t index_ = -1;  // grid index of the last row, from the first row of the file
  std::uint64_t delivered_ = 0, gaps_ = 0, missing_ = 0, dropped_in_a_row_ = 0;
  std::uint64_t used_ = 0, dropped_ = 0, outside_ = 0;  // every row of the file is one of these
  std::string first_dropped_;  // where the present run of backward rows began
  std::optional<std::int64_t> start_ns_;
  double last_ratio_ = 1;
  int same_ratio_ = 0;
  std::string ratio_place_, end_of_block_;
  StampSketch sketch_;
  std::vector<std::vector<double>> staging_;
  std::size_t staged_ = 0;
};

}  // namespace libchar
