// CSV as a source of rows: chunks of whole lines, parsed side by side ahead of the caller (chunk_pipeline.hpp) or, with
// one thread, inside next(); here they become rows with warnings, and every byte and cell is accounted for.

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <stdexcept>
#include <system_error>
#include <utility>
#include <vector>

#include "libchar/core/parallel/thread_limit.hpp"
#include "libchar/core/refusal.hpp"
#include "libchar/core/text/pattern.hpp"
#include "libchar/core/text/spelling.hpp"
#include "libchar/core/text/text.hpp"
#include "libchar/log/csv/chunk_pipeline.hpp"
#include "libchar/log/csv/chunk_reader.hpp"
#include "libchar/log/csv/head/dialect.hpp"
#include "libchar/log/csv/head/header.hpp"
#include "libchar/log/csv/head/plan.hpp"
#include "libchar/log/csv/head/study.hpp"
#include "libchar/log/csv/json_rows.hpp"
#include "libchar/log/csv/long_table.hpp"
#include "libchar/log/csv/rows/rows.hpp"
#include "libchar/log/detail/channel_choice.hpp"
#include "libchar/log/detail/format.hpp"
#include "libchar/log/detail/odd_values.hpp"
#include "libchar/log/detail/row_source.hpp"
#include "libchar/log/tables/table_reader.hpp"
#include "libchar/log/topics/joined_topics.hpp"
#include "libchar/log/write/writers.hpp"

namespace libchar {
namespace {

// Long tables made wide: rows that say whose they are (sensor, time, x, y) become rows with the channels of all.

/// Rows of one stamp become one row; with `cycles` a turn of all groups does, at the stamp of its
/// first. What a group does not say at a stamp is missing.
class Pivot {
 public:
  Pivot() = default;
  Pivot(std::size_t channels, std::size_t groups, bool timed, bool cycles);
  bool active() const { return groups_ > 0; }
  /// Of the channels of all groups, in their order; all unless `keep` is called.
  const std::vector<std::size_t>& kept() const { return kept_; }
  void keep(std::vector<std::size_t> some) { kept_ = std::move(some); }

  /// Replaces the rows of `block`, whose groups these are, by those that are complete.
  void widen(RowBlock& block, const std::vector<std::uint32_t>& groups);
  /// The last row, at the end of the file; false when there is none.
  bool flush(RowBlock& block);

 private:
  void begin(RowBlock& out);
  void emit(RowBlock& out);

  std::size_t channels_ = 0, groups_ = 0;
  bool timed_ = false, cycles_ = false, any_ = false;
  std::vector<double> values_;
  std::vector<std::size_t> kept_;
  std::vector<bool> filled_;
  std::int64_t stamp_ = 0;
  std::uint64_t line_ = 0;
};

Pivot::Pivot(std::size_t channels, std::size_t groups, bool timed, bool cycles)
    : channels_(channels),
      groups_(groups),
      timed_(timed),
      cycles_(cycles || !timed),
      values_(channels * groups, kMissing),
      kept_(channels * groups),
      filled_(groups, false) {
  std::iota(kept_.begin(), kept_.end(), std::size_t{0});
}

void Pivot::begin(RowBlock& out) {
  out.rows = 0;
  out.columns.resize(kept_.size());
  for (auto& column : out.columns) column.clear();
  out.time_ns.clear();
  out.line_offset.clear();
  out.first_line = line_;
}

void Pivot::emit(RowBlock& out) {
  for (std::size_t c = 0; c < kept_.size(); ++c) out.columns[c].push_back(values_[kept_[c]]);
  if (timed_) out.time_ns.push_back(stamp_);
  out.line_offset.push_back(static_cast<std::uint32_t>(line_ - out.first_line));
  ++out.rows;
  std::fill(values_.begin(), values_.end(), kMissing);
  std::fill(filled_.begin(), filled_.end(), false);
  any_ = false;
}

void Pivot::widen(RowBlock& block, const std::vector<std::uint32_t>& groups) {
  RowBlock out;
  if (!any_) line_ = block.first_line;
  begin(out);
  for (std::size_t i = 0; i < block.rows; ++i) {
    const std::uint32_t group = groups[i];
    const std::int64_t stamp = timed_ ? block.time_ns[i] : 0;
    if (any_ && (filled_[group] || (!cycles_ && stamp != stamp_))) emit(out);
    if (!any_) {
      any_ = true;
      stamp_ = stamp;
      line_ = block.first_line + (block.line_offset.empty() ? i : block.line_offset[i]);
    }
    filled_[group] = true;
    for (std::size_t c = 0; c < channels_; ++c) values_[group * channels_ + c] = block.columns[c][i];
  }
  block = std::move(out);
}

bool Pivot::flush(RowBlock& block) {
  if (!any_) return false;
  begin(block);
  emit(block);
  return true;
}

}  // namespace

namespace csv {
namespace {

class CsvSource final : public RowSource {
 public:
  CsvSource(const std::string& path, const ReadOptions& options)
      : options_(options), chunks_(path, options.block_bytes, options.hash) {
    begin(path == "-" ? "standard input" : path, options);
  }
  CsvSource(std::unique_ptr<Unpacker> text, const std::string& name, const ReadOptions& options)
      : options_(options), chunks_(std::move(text), name, options.block_bytes) {
    begin(name, options);
  }
  CsvSource(const CsvSource&) = delete;
  CsvSource& operator=(const CsvSource&) = delete;

  const LogInfo& info() const override { return info_; }

  bool several_clocks() const override {
    if (!pivot_.active() || dialect_.groups.size() < 2 || dialect_.cycles) return false;
    return std::none_of(dialect_.filters.begin(), dialect_.filters.end(),
                        [this](const RowFilter& filter) { return filter.column == dialect_.group_column; });
  }
  std::optional<SortedRows> sorted_by() const override {
    if (chunks_.packed() || dialect_.group_column >= 0 || !dialect_.filters.empty()) return std::nullopt;
    return csv::sorted_by(stretches_of(info_.file, dialect_), dialect_);
  }

  /// Where all rows of one group come before those of the next, which are read side by side.
  bool groups_in_blocks() const { return dialect_.sorted; }
  std::vector<JoinedRows> each_group(const std::string& path, const ReadOptions& options) const;

  bool next(RowBlock& block, Findings& warnings) override {
    warnings.merge(std::exchange(pending_, {}));
    if (problem_) throw Error(*problem_);
    while (take(current_)) {
      if (odd_.footer && (current_.rows.rows > 0 || current_.filtered > 0 || current_.problem))
        throw Error(*odd_.footer);
      account(warnings);
      std::swap(block, current_.rows);
      if (pivot_.active()) pivot_.widen(block, current_.groups);
      if (current_.problem) problem_ = located(*current_.problem);
      if (current_.footer) hold_footer();
      if (block.rows > 0) return true;
      if (problem_) throw Error(*problem_);
    }
    reached_end_ = true;
    return std::exchange(flushed_, true) ? false : pivot_.flush(block);
  }

  void finish(Findings& warnings) override {
    if (finished_) return;
    finished_ = true;
    if (pipeline_) pipeline_->stop();
    if (reached_end_) check_account();
    warnings.merge(std::exchange(pending_, {}));
    refuse_many_bad_rows();
    add(warnings, "bad_row", "rows that cannot be read: left out, or missing where there are no stamps", odd_.bad);
    add(warnings, "blank_line", "blank lines skipped", odd_.blank);
    add(warnings, "comment_line", "comment lines between the rows skipped", odd_.comment);
    add(warnings, "footer_line", "lines of words after the last row left out", odd_.footers);
    add(warnings, "repeated_header", "repeated header lines skipped", odd_.repeated);
    add(warnings, "mixed_line_ends", "line ends of another kind than the first, accepted", odd_.mixed_end);
    add(warnings, "infinite_value", kInfiniteValues, odd_.infinite);
    add(warnings, "number_out_of_range", kNumbersOutOfRange, odd_.overflow);
    add(warnings, "number_too_small", kNumbersTooSmall, odd_.too_small);
    if (odd_.missing.count > 0)
      add(warnings, "missing_cell", missing_cells(read_channels_, missing_per_channel_), odd_.missing);
    if (chunks_.nul_tail() > 0)
      warnings.add("nul_tail",
                   fmt::format("the file ends in {} NUL bytes (cut by a power failure?): dropped{}", chunks_.nul_tail(),
                               chunks_.cut_bytes() > 0 ? " with the line they cut off" : ""),
                   place_name(next_line_, 1));
    chunks_.finish(warnings);
    if (chunks_.packed_cut())
      warnings.add("compressed_cut",
                   "the file ends inside of what is packed (cut?): the whole rows up to there are read",
                   place_name(next_line_, 1));
    if (filtered_ > 0) info_.dialect.push_back(fmt::format("{} of other kinds left out", plural(filtered_, "row")));
    if (inexact_ > 0)
      info_.dialect.push_back(fmt::format("{} integers beyond 2^53 rounded to the nearest double", inexact_));
  }

  std::string place(const RowBlock& block, std::size_t i, std::uint64_t) const override {
    return spot_name(line_of(block, i), 1);
  }
  std::string where(const RowBlock& block, std::size_t i, std::uint64_t) const override {
    if (chunks_.made()) return fmt::format("{} ({})", info_.file, spot_name(line_of(block, i), 1));
    return dialect_.time.column <= 0 ? fmt::format("{}:{}:1", info_.file, line_of(block, i))
                                     : fmt::format("{}:{}", info_.file, line_of(block, i));
  }
  std::uint64_t bytes_read() const override {
    return chunks_.packed() ? chunks_.stored_read() : dialect_.data_offset + consumed_;
  }
  std::uint64_t bytes_total() const override { return chunks_.size(); }

  std::string sha256() override {
    if (pipeline_) pipeline_->stop();
    return chunks_.finish_hash();
  }

 private:
  void begin(const std::string& name, const ReadOptions& options) {
    info_.file = name;
    const std::string_view head = chunks_.head();
    if (head.empty() && chunks_.packed() && !chunks_.made())
      throw input_error("E0329", info_.file)
          .says("the compressed data end before their first byte of text")
          .hint("copy the file again");
    info_.format = chunks_.format();
    if (chunks_.made()) {
      options_.delimiter = ",";
      options_.decimal = "point";
      if (chunks_.headed()) options_.header = "yes";
    }
    dialect_ = understand(head, chunks_.whole(), options_, info_);
    if (chunks_.whole() && dialect_.data_offset >= head.size())
      throw input_error("E0322", info_.file).says("no data rows");
    if (dialect_.sorted && (chunks_.made() || name == "standard input")) refuse_blocks();
    if (dialect_.group_column >= 0)
      plan_groups(options);
    else
      read_channels_ = columns_planned(options);
    missing_per_channel_.assign(plan_.channels, 0);
    fractional_.assign(plan_.channels, 0);
    pending_ = std::exchange(info_.warnings, {});
    info_.rows = expected_rows(head);
    chunks_.start(dialect_);
    next_line_ = dialect_.first_data_line - (chunks_.headed() ? 1 : 0);
    info_.bytes = chunks_.size();
    if (chunks_.packed()) info_.dialect.emplace_back(chunks_.packing());
    info_.first_line = next_line_;
    const int threads = std::clamp(options.threads > 0 ? options.threads : processors_given(), 1, 32);
    const bool small = chunks_.whole() && chunks_.size() < (std::size_t{1} << 18U) && options.threads <= 0;
    if (threads > 1 && !small) read_ahead(threads);
  }

  // The channels of each group: "Gyroscope_x", or the group alone where there is one.
  std::vector<Channel> columns_planned(const ReadOptions& options) {
    plan_ = plan_columns(dialect_, options, info_);
    return info_.channels;
  }

  // Words that name columns choose columns; others choose among the channels that the groups make of these.
  void plan_groups(const ReadOptions& options) {
    ReadOptions columns = options, made = options;
    std::vector<std::string> names;
    for (const Column& column : dialect_.columns) names.push_back(column.name);
    columns.channels.clear();
    made.channels.clear();
    for (const std::string& word : options.channels) {
      const bool names_column =
          std::any_of(names.begin(), names.end(), [&](const auto& name) { return matches(word, name); });
      (names_column ? columns : made).channels.push_back(word);
    }
    read_channels_ = columns_planned(columns);
    group_channels();
    if (made.channels.empty()) return;
    TableColumns table;
    for (const Channel& channel : info_.channels) table.names.push_back(channel.name);
    pivot_.keep(choose_channels(table, made, info_.file));
    std::vector<Channel> kept;
    for (const std::size_t c : pivot_.kept()) kept.push_back(info_.channels[c]);
    info_.channels = std::move(kept);
    const auto group = [this](std::size_t channel) { return channel / plan_.channels; };
    if (group(pivot_.kept().front()) == group(pivot_.kept().back())) only_group(group(pivot_.kept().front()));
  }

  // The rows of others say nothing then.
  void only_group(std::size_t group) {
    if (dialect_.cycles) return;
    dialect_.filters.push_back({dialect_.group_column, dialect_.groups[group], false});
  }

  void group_channels() {
    std::vector<Channel> wide;
    for (const std::string& group : dialect_.groups)
      for (const Channel& channel : read_channels_) {
        wide.push_back(channel);
        wide.back().name = plan_.channels == 1 ? group : group + "_" + channel.name;
      }
    info_.channels = std::move(wide);
    pivot_ = Pivot(plan_.channels, dialect_.groups.size(), dialect_.time.column >= 0, dialect_.cycles);
  }

  void read_ahead(int threads) {
    try {
      pipeline_ = std::make_unique<ChunkPipeline>(chunks_, plan_, threads);
    } catch (const std::system_error&) {
      // No thread is to be had: parsed inside next(), then.
    }
  }

  static std::uint64_t line_of(const RowBlock& block, std::size_t i) {
    return block.first_line + (block.line_offset.empty() ? i : block.line_offset[i]);
  }

  [[noreturn]] void refuse_blocks() const {
    throw usage_error("E0328", info_.file)
        .says("the rows of one kind come after those of another, and are not side by side: " +
              first_names(dialect_.groups))
        .hint("`where` {} reads one of them", shell_word(options_.kinds.group_by + "=" + dialect_.groups[0]));
  }

  // As many rows as there would be if all were as long as those in the head.
  std::uint64_t expected_rows(std::string_view head) const {
    const std::string_view body = head.substr(std::min(dialect_.data_offset, head.size()));
    const auto lines = static_cast<std::uint64_t>(
        std::count(body.begin(), body.end(), dialect_.line_end == LineEnd::cr ? '\r' : '\n'));
    if (chunks_.packed()) return chunks_.whole() ? lines : 0;
    if (body.empty() || chunks_.size() <= dialect_.data_offset) return 0;
    return static_cast<std::uint64_t>(static_cast<double>(chunks_.size() - dialect_.data_offset) /
                                      static_cast<double>(body.size()) * static_cast<double>(lines));
  }

  // Of a table that is damaged all over nothing should be trusted.
  void refuse_many_bad_rows() const {
    constexpr std::uint64_t kFew = 10;
    if (odd_.bad.count <= kFew || odd_.bad.count * 10 <= rows_ + odd_.bad.count) return;
    throw input_error("E0335", fmt::format("{}:{}", info_.file, odd_.bad.spots[0].line))
        .says("{} of {} rows cannot be read, more than one in ten", odd_.bad.count, rows_ + odd_.bad.count)
        .hint(
            "`channels` '!NAME' leaves out a column of words, `delimiter` and `decimal` say how the cells are written; "
            "of "
            "lines of several kinds grep WORD FILE | sensorchar inspect - reads one");
  }

  // Every byte of the file and every cell of its rows went somewhere; anything else is a defect of this reader.
  void check_account() const {
    const std::uint64_t bytes = dialect_.data_offset + total_.bytes + chunks_.nul_tail() + chunks_.cut_bytes();
    if (!total_.balanced() || bytes != chunks_.bytes_read() || total_.cells != rows_ * plan_.target.size())
      throw std::logic_error("CSV reader: the account of bytes and cells does not balance");
  }

  void add(Findings& warnings, std::string_view code, std::string_view message, const Tally& tally) const {
    for (const Spot& spot : tally.spots) warnings.add(code, message, spot_name(spot.line, spot.column), 1);
    if (tally.count > tally.spots.size()) warnings.add(code, message, "", tally.count - tally.spots.size());
  }

  std::string spot_name(std::uint64_t line, std::uint64_t column) const {
    return chunks_.made() ? fmt::format("{} {}", chunks_.row_name(), line) : place_name(line, column);
  }

  // From lines of the chunk to lines of the file.
  void collect(Tally& sum, const Tally& part) const {
    for (const Spot& spot : part.spots) sum.add(next_line_ + spot.line, spot.column);
    sum.count += part.count - part.spots.size();
  }

  void account(Findings& warnings) {
    ParsedChunk& chunk = current_;
    chunk.rows.first_line = next_line_;
    chunk_line_ = next_line_;
    if (dialect_.clock_period_ns > 0) pass_midnight(chunk.rows);
    collect(odd_.bad, chunk.bad);
    collect(odd_.blank, chunk.blank);
    collect(odd_.comment, chunk.comment);
    collect(odd_.repeated, chunk.repeated);
    collect(odd_.footers, chunk.footers);
    collect(odd_.mixed_end, chunk.mixed_end);
    collect(odd_.infinite, chunk.infinite);
    collect(odd_.overflow, chunk.overflow);
    collect(odd_.too_small, chunk.too_small);
    collect(odd_.missing, chunk.missing);
    if (dialect_.line_end == LineEnd::cr && !cr_noted_) {
      cr_noted_ = true;
      warnings.add("carriage_return_line_ends", "lines end in a lone carriage return (old Macintosh)",
                   place_name(1, dialect_.has_header ? dialect_.header.size() + 1 : 1));
    }
    if (chunk.unended)
      warnings.add("no_final_newline",
                   "the last line has no line end: if the file was cut, its last number may be cut too",
                   place_name(next_line_ + chunk.unended->line, chunk.unended->column));
    if (chunk.cut)
      warnings.add("no_final_newline", "the file ends in the middle of a row: the row is left out",
                   place_name(next_line_ + chunk.cut->line, chunk.cut->column));
    for (std::size_t c = 0; c < plan_.channels; ++c) {
      missing_per_channel_[c] += chunk.missing_per_channel[c];
      fractional_[c] |= chunk.fractional[c];
      for (std::size_t k = c; k < info_.channels.size(); k += plan_.channels)
        info_.channels[k].integer = fractional_[c] == 0;
    }
    inexact_ += chunk.inexact_integers;
    next_line_ += chunk.lines;
    rows_ += chunk.rows.rows;
    filtered_ += chunk.filtered;
    consumed_ += chunk.account.bytes;
    total_.add(chunk.account);
  }

  // A time of day begins again at midnight, one without hours every hour.
  void pass_midnight(RowBlock& rows) {
    const std::int64_t period = dialect_.clock_period_ns;
    for (std::size_t i = 0; i < rows.rows; ++i) {
      std::int64_t& stamp = rows.time_ns[i];
      if (stamp + days_ns_ < last_clock_ns_ - period / 2) days_ns_ += period;
      stamp += days_ns_;
      last_clock_ns_ = stamp;
    }
  }

  Problem located(const RowProblem& found) const {
    Problem out = found.problem;
    const std::uint64_t line = chunk_line_ + found.spot.line;
    out.where = chunks_.made() ? fmt::format("{} ({} {})", info_.file, chunks_.row_name(), line)
                               : at(info_.file, line, found.spot.column, current_offset_ + found.byte);
    return out;
  }

  // A few lines of words behind the last row end a file, if there was a table and no row follows.
  void hold_footer() {
    constexpr std::uint64_t kFewestRows = 10, kMostLines = 40;
    if (!odd_.footer) odd_.footer = located(*current_.footer);
    if (rows_ < kFewestRows || odd_.footers.count > kMostLines) problem_ = odd_.footer;
  }

  bool take(ParsedChunk& chunk) { return pipeline_ ? pipeline_->next(chunk, current_offset_) : take_inline(chunk); }

  bool take_inline(ParsedChunk& chunk) {
    const bool any = chunks_.next(raw_);
    chunks_.hash(raw_);
    if (!any) return false;
    parse_rows(raw_.text(), plan_, chunk);
    current_offset_ = raw_.offset;
    return true;
  }

  ReadOptions options_;
  LogInfo info_;
  Dialect dialect_;
  Plan plan_;
  std::vector<Channel> read_channels_;  // before they are made wide
  Pivot pivot_;
  ChunkReader chunks_;
  Findings pending_;
  RawChunk raw_;
  ParsedChunk current_;
  std::optional<Problem> problem_;
  struct {
    Tally bad, blank, comment, repeated, mixed_end, infinite, overflow, too_small, missing, footers;
    std::optional<Problem> footer;  ///< why the first of these is no row
  } odd_;
  std::int64_t days_ns_ = 0, last_clock_ns_ = 0;
  std::vector<std::uint64_t> missing_per_channel_;
  std::vector<std::uint32_t> fractional_;
  Account total_;
  std::uint64_t next_line_ = 1, chunk_line_ = 1, current_offset_ = 0, consumed_ = 0, rows_ = 0, inexact_ = 0,
                filtered_ = 0;
  bool cr_noted_ = false, finished_ = false, reached_end_ = false, flushed_ = false;
  std::unique_ptr<ChunkPipeline> pipeline_;  // ends before what it reads
};

// A reader for each group, of those of its channels that are asked for.
std::vector<JoinedRows> CsvSource::each_group(const std::string& path, const ReadOptions& options) const {
  std::vector<JoinedRows> out;
  for (std::size_t g = 0; g < dialect_.groups.size(); ++g) {
    JoinedRows one;
    one.name = dialect_.groups[g];
    ReadOptions some = options;
    some.kinds.group_by.clear();
    some.kinds.where.push_back(options.kinds.group_by + "=" + one.name);
    some.hash = options.hash && out.empty();
    some.channels.clear();
    for (std::size_t k = 0; k < pivot_.kept().size(); ++k) {
      if (pivot_.kept()[k] / plan_.channels != g) continue;
      one.channels.push_back(info_.channels[k].name);
      some.channels.push_back(read_channels_[pivot_.kept()[k] % plan_.channels].name);
    }
    if (one.channels.empty()) continue;
    one.rows = std::make_unique<CsvSource>(path, some);
    out.push_back(std::move(one));
  }
  return out;
}

std::unique_ptr<RowSource> open(const std::string& path, const ReadOptions& options) {
  auto source = std::make_unique<CsvSource>(path, options);
  if (!source->groups_in_blocks()) return source;
  return join_rows(source->each_group(path, options), options);
}

}  // namespace

std::unique_ptr<RowSource> open_text(std::unique_ptr<Unpacker> text, const std::string& name,
                                     const ReadOptions& options) {
  return std::make_unique<CsvSource>(std::move(text), name, options);
}

namespace {

// Text is what CSV may be: no control characters in front.
bool sniff(const std::string&, std::string_view first_bytes) {
  const std::string_view front = first_bytes.substr(0, 4096);
  return !front.empty() && std::none_of(front.begin(), front.end(), [](char c) {
    return static_cast<unsigned char>(c) < 0x20 && c != '\t' && c != '\n' && c != '\r' && c != '\f';
  });
}

}  // namespace
}  // namespace csv

Format csv_format() {
  Format row;
  row.about.name = "csv";
  row.about.text = true;
  row.about.title = "CSV";
  row.about.suffixes = {".csv", ".tsv", ".txt", ".dat", ".lvm"};
  row.about.otherwise = "`-`";
  row.about.written_suffixes = {".csv"};
  row.about.writes_stamps = true;
  row.about.from_pipes = true;
  row.sniff = csv::sniff;
  row.open = csv::open;
  row.write = write_csv;
  return row;
}

Format jsonl_format() {
  Format row = csv_format();
  row.about.name = "jsonl";
  row.about.title = "JSON lines";
  row.about.suffixes = {".jsonl", ".ndjson"};
  row.about.otherwise = "what begins with an object";
  row.about.units = "as suffixes";
  row.about.written_suffixes = {};
  row.about.from_pipes = false;
  row.sniff = [](const std::string&, std::string_view front) { return csv::is_json_rows(front); };
  row.write = nullptr;
  return row;
}

}  // namespace libchar
