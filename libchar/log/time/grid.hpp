#pragma once
// From rows with stamps to samples on a uniform grid, streaming: missing samples are put in as NaN (never
// interpolated), doubled and backward rows are dropped, rollovers are unwrapped, and everything is counted.
// The interval comes from stamp_model.hpp, the rate from stamp_sketch.hpp; what becomes of a
// stamp that does not fit is decided in time_repairs.cpp.

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "libchar/core/numeric/whole.hpp"
#include "libchar/log/detail/lossy_packets.hpp"
#include "libchar/log/detail/row_source.hpp"
#include "libchar/log/read.hpp"
#include "libchar/log/time/clock_behind.hpp"
#include "libchar/log/time/clock_breaks.hpp"
#include "libchar/log/time/recent_stamps.hpp"
#include "libchar/log/time/stamp_model.hpp"
#include "libchar/log/time/stamp_sketch.hpp"
#include "libchar/log/time/time_repairs.hpp"

namespace libchar {

// Rows without a value of any channel that is read, in a table of slow and fast channels (a temperature
// once a second in rows of 200 Hz): the slow channel has rows, and a clock, of its own.

/// Steps between values, and those of them over blank rows: values missing at random leave steps of one, two,
/// three intervals, and two over a blank; a clock has one step, over blanks as well. Few blanks must show it clearly.
bool keeps_own_clock(std::vector<double> steps, std::vector<double> over_blanks, double blank_share);

class OwnRows {
 public:
  /// Takes the next rows while nothing is decided; true once it is: by the first rows, or at the end of the log.
  bool decide(const RowBlock& rows);
  bool decided() const { return decided_; }
  void decide_at_end();
  /// The rows have a clock of their own: blank ones are to be left out.
  bool apart() const { return apart_; }

 private:
  void judge();
  std::vector<double> steps_, over_blanks_;  // of rows with a value
  std::int64_t last_ = 0;
  std::size_t rows_ = 0, kept_ = 0;
  bool last_blank_ = false, decided_ = false, apart_ = false;
};

/// The same of each channel among the first rows of a table.
class ChannelClocks {
 public:
  /// Rows [from, to); without stamps the rows themselves count.
  void look(const RowBlock& rows, std::size_t from, std::size_t to);
  /// Rows for each value of a channel with a clock of its own, 1 of the others.
  double every(std::size_t channel) const;

 private:
  struct Values {
    std::vector<double> steps, over_blanks;
    std::int64_t last = 0;
    std::size_t rows = 0, count = 0;
    bool blank = false;
  };
  std::vector<Values> channels_;
  std::size_t rows_ = 0;
};

bool blank_row(const RowBlock& rows, std::size_t row);

/// Takes the rows without a value out of the block, and says how many there were.
std::size_t leave_out_blank_rows(RowBlock& rows);

/// Rows written twice, with their stamp and all their values. Where values change from row to row that is no chance:
/// the copy is no sample, also where it took the place of the next row.
class CopiedRows {
 public:
  /// Of a log's first rows, in file order.
  void look(const RowBlock& rows);
  void decide();
  /// Takes copies out of the next block; where the first of them stood, and how many there were.
  struct Left {
    std::size_t first = 0, count = 0;
  };
  Left leave_out(RowBlock& rows);

 private:
  /// The row before, across blocks.
  struct Before {
    std::vector<double> values;
    std::int64_t stamp = 0;
    bool any = false;
  };
  bool as_before(const RowBlock& rows, std::size_t row, const Before& before) const;
  static void keep_last(const RowBlock& rows, Before& before);
  struct Pairs {
    std::size_t all = 0, alike = 0;  ///< of neighbours; with the same values
  };
  Pairs one_stamp_, unlike_;
  Before looked_at_, passed_;
  bool any_ = false;
};

/// Samples on their way to the sink: long runs as they stand in a block, others assembled first.
class GridOutput {
 public:
  explicit GridOutput(BlockSink& sink) : sink_(sink) {}
  void begin(const LogInfo& so_far);
  void rows(const RowBlock& block, std::size_t from, std::size_t to);
  void missing(std::uint64_t count);
  void flush();
  std::uint64_t delivered() const { return delivered_; }

 private:
  void deliver(const std::vector<const double*>& channels, std::size_t rows);

  BlockSink& sink_;
  std::vector<std::vector<double>> staging_;
  std::size_t staged_ = 0;
  std::uint64_t delivered_ = 0;
};

inline constexpr std::int64_t kMostNs = std::int64_t{1} << 62U;  ///< of a stamp, and between two of a log
inline constexpr std::size_t kRowsAhead = 16;                    ///< rows looked at before a late stamp is called a gap

/// Places rows on the grid and passes them to the sink in order.
class TimeGrid {
 public:
  TimeGrid(const RowSource& source, const ReadOptions& options, BlockSink& sink, Findings& warnings);

  /// Takes the block's rows (its buffers come back for reuse). Returns false when the window's end has been reached.
  bool push(RowBlock& block);
  /// The rest, and what is now known of the time base.
  void finish(LogInfo& info);
  const ChannelClocks& clocks() const { return clocks_.channels; }

 private:
  struct Pending {
    RowBlock block;
    std::uint64_t rows_before = 0;
    std::size_t done = 0;
    bool own = false;  ///< without the rows that are left out
  };
  void leave_out(Pending& item);
  void begin();
  bool ready(bool end);
  std::size_t rows_to_learn() const;
  void learn();
  std::vector<std::int64_t> first_stamps();
  void spread_lossy_packets(const std::vector<std::int64_t>& stamps);
  void drop_wild_start(const std::vector<std::int64_t>& stamps);
  void leave_out_first_rate(const std::vector<std::int64_t>& stamps);
  void refuse_without_axis(const std::vector<std::int64_t>& stamps);
  void say_pattern(const StampModel& found);
  void look_behind(const std::vector<std::int64_t>& stamps, StampModel& found);
  double even_interval();
  void judge_rate_change();
  void refuse_bursts() const;
  std::optional<RateChange> lasting_change(bool odd) const;
  void process(bool end);
  std::size_t process_rows(Pending& front, std::size_t count);
  bool take_regular(const std::int64_t* time, std::size_t n);
  std::size_t take_one_by_one(Pending& front, std::size_t from, std::size_t to, std::size_t ahead, std::size_t& run);
  bool place_in_window(std::int64_t stamp);
  bool between_samples(const Pending& front, std::size_t row, std::int64_t stamp);
  void watch_step(const Pending& front, std::size_t row, std::int64_t step);
  void without_stamps(Pending& front);
  /// The stamp, when it and its distance from the first leave room for every sum and difference in
  /// 64 bits. Throws Error(input) else.
  std::int64_t checked(const Pending& front, std::size_t row, std::int64_t stamp) const;
  enum class Verdict { keep, drop };
  Verdict decide(const Pending& front, std::size_t row, std::int64_t& stamp, std::size_t ahead);
  Verdict place_late_row(const Pending& front, std::size_t row, std::int64_t gap, std::int64_t& stamp);
  Verdict pass_gap(const Pending& front, std::size_t row, std::int64_t step, std::int64_t gap, std::size_t left);
  Verdict drop_wild(const Pending& front, std::size_t row);
  Verdict backward(const Pending& front, std::size_t row, std::int64_t& stamp);
  [[noreturn]] void refuse_backward() const;
  void refuse_many_backward() const;
  bool is_restart(std::int64_t stamp, const ClockWrap& wrap) const;
  void unwrap(const Pending& front, std::size_t row, const ClockWrap& wrap, std::int64_t& stamp);
  bool next_row(const Pending*& at, std::size_t& item, std::size_t& row) const;
  bool next_lies_before(const Pending& front, std::size_t row, std::int64_t stamp) const;
  std::int64_t lag(const Pending& front, std::size_t row, std::int64_t stamp, std::size_t ahead,
                   std::size_t at_once) const;
  std::vector<double> lags_ahead(const Pending& front, std::size_t row, std::int64_t stamp, std::size_t ahead,
                                 std::size_t at_once = 0) const;
  RowsAtOnce rows_at_once(const Pending& front, std::size_t row) const;
  std::int64_t place_behind(std::int64_t gap) const;
  Verdict hung(const Pending& front, std::size_t row, std::size_t at_once, std::int64_t gap, std::int64_t& stamp);
  std::int64_t packet_lag(const Pending& front, std::size_t row, std::int64_t stamp, std::size_t ahead) const;
  bool rows_go_on(const Pending& front, std::size_t row, std::size_t ahead) const;
  /// A gap of so many steps, of which so many samples lie in the window.
  void leave_missing(std::uint64_t samples, std::int64_t steps);
  std::string place(const Pending& front, std::size_t row) const;
  [[noreturn]] void fail(const Pending& front, std::size_t row, std::string code, std::string what,
                         std::string hint = "") const;

  struct Step {
    Step() = default;
    explicit Step(const StampModel& found)
        : model(found),
          ns(found.ns),
          longest(static_cast<std::int64_t>(std::min(found.longest_step, 9e18))),
          shortest(std::max<std::int64_t>(
              1, clamped_whole<std::int64_t>(std::ceil(std::min((even() ? 0.95 : 0.75) * ns, 9e18))))),
          coarse(found.pattern != StampPattern::steps) {}
    bool even() const { return model.packets.scatter_ns > 0; }  ///< inside packets
    bool starts_packet(std::int64_t step) const {
      return model.packets.rows > 0 && (step > longest || (even() && step < shortest));
    }
    StampModel model;
    double ns = 0;
    std::int64_t longest = 0, shortest = 1;  ///< regular ones
    bool coarse = false;                     ///< stamps do not tell rows apart, one by one
    bool steady = false;                     ///< nearly all steps are alike: what stands between two is no sample
  };
  struct Window {
    std::int64_t from_ns = 0, to_ns = 0;  ///< after the first stamp
    bool begun = false;                   ///< its own rows say the interval
    bool over = false;
    bool other_rate = false;  ///< what stands in front of it runs at another
  };
  struct Last {
    bool any = false, ended = false;      ///< ended: no rows come behind those that wait
    std::int64_t first = 0;               ///< stamp of the first row
    std::int64_t stamp = 0, as_read = 0;  ///< unwrapped, and as the file has it
    std::int64_t wrap = 0;                ///< what rollovers have added
    std::int64_t index = -1;              ///< on the grid, from the first row of the file
    std::int64_t row = -1;                ///< of those on the grid
    std::string end_of_block;             ///< place of the last row of the block in front
  };
  struct Counts {
    std::uint64_t rows = 0, used = 0, dropped = 0, outside = 0;  ///< rows: the sum of the others
    std::uint64_t gaps = 0, missing = 0;
  };
  const RowSource& source_;
  const ReadOptions& options_;
  GridOutput output_;
  Findings& warnings_;
  std::deque<Pending> pending_;
  std::vector<RowBlock> spare_;
  std::uint64_t waiting_ = 0;  ///< rows
  bool stamped_ = false, began_ = false, learned_ = false;
  Step step_;
  Window window_;
  Last last_;
  Counts counts_;
  RateWatch watch_;
  Bursts bursts_;
  BackwardRows backward_;
  EvenClock behind_;
  std::optional<std::int64_t> start_ns_;
  struct Clocks {
    OwnRows rows;
    ChannelClocks channels;
    CopiedRows copies;
    PacketRows packets;
  } clocks_;
  struct Recent {
    RecentStamps rows;
    PacketStarts packets;
    std::int64_t last_at_once = -1;  ///< of the rows that a logger wrote when it hung, as `Last::row`
  } recent_;
  StampSketch sketch_;
};

}  // namespace libchar
