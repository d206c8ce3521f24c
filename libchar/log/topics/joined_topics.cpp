// Several topics as one table. Topic s samples at t(s, k); where it stands behind the fastest topic by d(s), rows are
// the clusters of t(s, k) - d(s) within half a step of that topic: one sample a topic, and what a topic does not say
// at an instant is missing. d(s) is learnt from the first rows and follows (d += residual / 64) where clocks drift.
#include "libchar/log/topics/joined_topics.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "libchar/core/numeric/median.hpp"
#include "libchar/core/numeric/whole.hpp"
#include "libchar/core/refusal.hpp"
#include "libchar/core/text/spelling.hpp"
#include "libchar/core/text/text.hpp"
#include "libchar/log/detail/channel_choice.hpp"
#include "libchar/log/detail/odd_values.hpp"
#include "libchar/log/topics/topic_rows.hpp"

namespace libchar {
namespace {

constexpr std::size_t kMostTopics = 64, kLearnt = 1025, kRowsPerBlock = 8192;

/// Rows of a topic that are read and not yet taken.
class TopicQueue {
 public:
  explicit TopicQueue(JoinedRows rows)
      : name_(std::move(rows.name)), channels_(std::move(rows.channels)), source_(std::move(rows.rows)) {}

  const std::string& name() const { return name_; }
  const std::string& channel(std::size_t c) const { return channels_[c]; }
  const RowSource& source() const { return *source_; }
  RowSource& source() { return *source_; }

  /// At least n rows stand in front, or all that are left.
  std::size_t have(std::size_t n) {
    if (times_.size() - at_ < n && !ended_) {
      for (auto& values : columns_) drop_front(values);
      drop_front(times_);
      at_ = 0;
    }
    while (times_.size() - at_ < n && !ended_) {
      ended_ = !source_->next(block_, findings_);
      if (ended_) break;
      columns_.resize(block_.columns.size());
      const auto rows = static_cast<std::ptrdiff_t>(block_.rows);
      for (std::size_t c = 0; c < columns_.size(); ++c)
        columns_[c].insert(columns_[c].end(), block_.columns[c].begin(), block_.columns[c].begin() + rows);
      times_.insert(times_.end(), block_.time_ns.begin(), block_.time_ns.begin() + rows);
    }
    return times_.size() - at_;
  }
  /// Is there a row? One whose stamp lies behind that of the next is out of turn and left out.
  bool ready() {
    while (have(2) > 1 && times_[at_] > times_[at_ + 1]) {
      findings_.add("wild_stamp", "stamps that fit neither their neighbours nor the clock: left out",
                    fmt::format("row {} of {}", taken_, printable(name_)));
      pop();
    }
    return times_.size() > at_;
  }
  std::int64_t time() const { return times_[at_]; }
  std::int64_t time(std::size_t i) const { return times_[at_ + i]; }
  double value(std::size_t column) const { return columns_[column][at_]; }
  void pop() {
    ++at_;
    ++taken_;
  }
  Findings& findings() { return findings_; }

 private:
  template <class T>
  void drop_front(std::vector<T>& values) const {
    values.erase(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(at_));
  }
  std::string name_;
  std::vector<std::string> channels_;
  std::unique_ptr<RowSource> source_;
  RowBlock block_;
  std::vector<std::vector<double>> columns_;
  std::vector<std::int64_t> times_;
  std::size_t at_ = 0;
  std::uint64_t taken_ = 0;
  bool ended_ = false;
  Findings findings_;
};

class JoinedTopics final : public RowSource {
 public:
  JoinedTopics(std::vector<TopicQueue> topics, const std::vector<std::string>& left_out, const ReadOptions& options)
      : topics_(std::move(topics)),
        aligned_(topics_.size() > 1 && !options.kinds.own_stamps),
        behind_ns_(topics_.size(), 0),
        lost_(topics_.size(), 0),
        in_row_(topics_.size(), false),
        raw_(topics_.size(), 0) {
    learn();
    describe(options);
    if (!left_out.empty()) info_.dialect.push_back("left out, without stamps: " + first_names(left_out));
  }

  const LogInfo& info() const override { return info_; }
  std::uint64_t bytes_total() const override { return info_.bytes; }
  std::uint64_t bytes_read() const override { return topics_[base_].source().bytes_read(); }
  std::string sha256() override { return topics_[0].source().sha256(); }

  bool next(RowBlock& block, Findings&) override {
    block.rows = 0;
    block.first_line = 0;
    block.line_offset.clear();
    block.time_ns.clear();
    block.columns.resize(info_.channels.size());
    for (auto& column : block.columns) column.clear();
    while (block.rows < kRowsPerBlock) {
      const auto first = earliest();
      if (!first) break;
      const std::int64_t stamp = aligned(*first);
      if (open_ && (in_row_[*first] || stamp > end_ || stamp < begin_))
        close(block);  // and the distances may have changed
      else
        take(*first, stamp);
    }
    if (open_ && !earliest()) close(block);
    return block.rows > 0;
  }

  void finish(Findings& warnings) override {
    Turns turns{std::vector<double>(topics_.size()), step_ns_ / 1e9};
    std::vector<std::string> names;
    for (std::size_t t = 0; t < topics_.size(); ++t) {
      topics_[t].source().finish(topics_[t].findings());
      merge(topics_[t].findings(), warnings);
      names.push_back(topics_[t].name());
      turns.behind_s[t] = behind_ns_[t] / 1e9;
    }
    std::swap(names[0], names[base_]);
    std::swap(turns.behind_s[0], turns.behind_s[base_]);
    if (aligned_) say_apart(names, turns, warnings);
    for (std::size_t t = 0; t < topics_.size(); ++t)
      if (lost_[t] > 0)
        warnings.add("duplicate_timestamp",
                     "rows that share a row of the joined table with another one of their topic or kind: dropped",
                     topics_[t].name(), lost_[t]);
  }

  std::string place(const RowBlock&, std::size_t i, std::uint64_t rows_before) const override {
    return fmt::format("row {}", rows_before + i);
  }

 private:
  /// The median step of each topic, the fastest of them, and how far the others stand behind it.
  void learn() {
    std::vector<double> steps_ns;
    for (TopicQueue& topic : topics_) {
      const std::size_t n = std::min(topic.have(kLearnt), kLearnt);
      steps_ns.push_back(usual_step(topic, n));
    }
    for (std::size_t t = 0; t < steps_ns.size(); ++t)
      if (steps_ns[t] > 0 && (!(step_ns_ > 0) || steps_ns[t] < 0.999 * step_ns_)) {
        step_ns_ = steps_ns[t];
        base_ = t;
      }
    every_.assign(topics_.size(), 1);
    for (std::size_t t = 0; t < steps_ns.size() && step_ns_ > 0; ++t)
      if (steps_ns[t] > 1.002 * step_ns_) every_[t] = steps_ns[t] / step_ns_;
    for (std::size_t t = 0; aligned_ && t < topics_.size(); ++t)
      if (t != base_) behind_ns_[t] = usual_distance(topics_[t]);
  }

  /// Mean of the steps within half of the median.
  static double usual_step(const TopicQueue& topic, std::size_t rows) {
    std::vector<double> steps;
    for (std::size_t i = 1; i < rows; ++i)
      if (topic.time(i) > topic.time(i - 1)) steps.push_back(static_cast<double>(topic.time(i) - topic.time(i - 1)));
    if (steps.empty()) return 0;
    const double usual = median_in_place(steps, Middle::lower);
    std::erase_if(steps, [&](double step) { return std::fabs(step - usual) > 0.5 * usual; });
    return std::accumulate(steps.begin(), steps.end(), 0.0) / static_cast<double>(steps.size());
  }

  /// Median distance of the first rows from the nearest of the fastest topic.
  double usual_distance(TopicQueue& topic) {
    TopicQueue& base = topics_[base_];
    const std::size_t rows = std::min(base.have(kLearnt), kLearnt), n = std::min(topic.have(kLearnt), kLearnt);
    std::vector<double> off;
    for (std::size_t i = 0, b = 0; i < n && rows > 0; ++i) {
      const auto distance = [&](std::size_t k) {
        return static_cast<double>(topic.time(i)) - static_cast<double>(base.time(k));
      };
      while (b + 1 < rows && std::fabs(distance(b + 1)) <= std::fabs(distance(b))) ++b;
      if (std::fabs(distance(b)) <= 0.5 * step_ns_) off.push_back(distance(b));
    }
    return off.empty() ? 0 : median_in_place(off, Middle::lower);
  }

  void describe(const ReadOptions& options) {
    info_ = topics_[base_].source().info();
    info_.topic = options.topic;
    info_.channels.clear();
    std::vector<std::string> names;
    for (std::size_t t = 0; t < topics_.size(); ++t) {
      const LogInfo& part = topics_[t].source().info();
      names.push_back(printable(topics_[t].name()));
      for (std::size_t c = 0; c < part.channels.size(); ++c) {
        Channel channel = part.channels[c];
        channel.name = topics_[t].channel(c);
        channel.every = every_[t];
        info_.channels.push_back(std::move(channel));
      }
      for (const auto& [from, to] :
           {std::pair(&part.guesses, &info_.guesses), std::pair(&part.dialect, &info_.dialect)})
        for (const std::string& line : *from)
          if (std::find(to->begin(), to->end(), line) == to->end()) to->push_back(line);
    }
    row_.resize(info_.channels.size());
    if (topics_.size() > 1)
      info_.dialect.push_back(fmt::format("{} {} as one table, in rows of {}: {}", names.size(),
                                          options.topic.empty() ? "kinds of rows" : "topics", names[base_],
                                          first_names(names)));
  }

  std::int64_t aligned(std::size_t topic) const {
    return topics_[topic].time() - clamped_whole<std::int64_t>(std::round(behind_ns_[topic]));
  }

  std::optional<std::size_t> earliest() {
    std::optional<std::size_t> first;
    for (std::size_t t = 0; t < topics_.size(); ++t)
      if (topics_[t].ready() && (!first || aligned(t) < aligned(*first))) first = t;
    return first;
  }

  void take(std::size_t t, std::int64_t stamp) {
    TopicQueue& topic = topics_[t];
    if (!open_ && any_ && aligned_ && t != base_ && stamp <= begin_ + half()) {
      ++lost_[t];  // the clock went on by a step: its row is gone
      topic.pop();
      return;
    }
    if (!open_) {
      open_ = any_ = true;
      begin_ = stamp;
      end_ = aligned_ ? stamp + half() : stamp;
      std::fill(row_.begin(), row_.end(), kMissing);
      std::fill(in_row_.begin(), in_row_.end(), false);
    }
    in_row_[t] = true;
    raw_[t] = topic.time();
    const std::size_t first = first_channel(t);
    for (std::size_t c = 0; c < topic.source().info().channels.size(); ++c) row_[first + c] = topic.value(c);
    topic.pop();
  }

  std::int64_t half() const { return clamped_whole<std::int64_t>(std::round(step_ns_ / 2)); }
  std::size_t first_channel(std::size_t topic) const {
    std::size_t first = 0;
    for (std::size_t t = 0; t < topic; ++t) first += topics_[t].source().info().channels.size();
    return first;
  }

  /// A topic that drifts against the fastest one goes over to the next row beyond half a step.
  void follow() {
    for (std::size_t t = 0; t < topics_.size(); ++t) {
      if (t == base_ || !in_row_[t]) continue;
      double& behind = behind_ns_[t];
      behind += (static_cast<double>(raw_[t] - raw_[base_]) - behind) / 64;
      if (std::fabs(behind) > 0.6 * step_ns_) behind -= std::copysign(step_ns_, behind);
    }
  }

  void close(RowBlock& block) {
    const bool timed = in_row_[base_];
    if (timed && aligned_) follow();
    block.time_ns.push_back(timed ? raw_[base_] : begin_);
    for (std::size_t c = 0; c < row_.size(); ++c) block.columns[c].push_back(row_[c]);
    ++block.rows;
    open_ = false;
  }

  /// What was found of the file is found by the reader of each topic.
  static void merge(const Findings& part, Findings& warnings) {
    for (const Finding& one : part.list()) {
      const Finding* const known = warnings.find(one.code);
      if (known != nullptr && known->count == one.count && known->where == one.where) continue;
      Findings alone;
      for (const std::string& row : one.where.rows) alone.add(one.code, one.sentence, row);
      if (one.count > one.where.rows.size()) alone.add(one.code, one.sentence, "", one.count - one.where.rows.size());
      warnings.merge(alone);
    }
  }

  std::vector<TopicQueue> topics_;
  LogInfo info_;
  bool aligned_;
  std::size_t base_ = 0;  ///< the fastest
  double step_ns_ = 0;
  std::vector<double> behind_ns_, every_;
  std::vector<std::uint64_t> lost_;
  // the row that is being made
  std::vector<bool> in_row_;
  std::vector<double> row_;
  std::vector<std::int64_t> raw_;  ///< stamps
  bool open_ = false, any_ = false;
  std::int64_t begin_ = 0, end_ = 0;
};

}  // namespace

std::unique_ptr<RowSource> join_rows(std::vector<JoinedRows> kinds, const ReadOptions& options) {
  std::vector<TopicQueue> queues;
  for (JoinedRows& rows : kinds) queues.emplace_back(std::move(rows));
  return std::make_unique<JoinedTopics>(std::move(queues), std::vector<std::string>(), options);
}

std::unique_ptr<RowSource> open_joined_topics(const std::vector<TopicChoice>& chosen, const std::vector<LogTopic>& all,
                                              const OpenTopics& open, const std::string& path, std::string_view format,
                                              const ReadOptions& options) {
  if (chosen.size() > kMostTopics)
    throw usage_error("E0425", path)
        .says("{} topics match this name, at most {} are read as one", chosen.size(), kMostTopics)
        .got(options.topic);
  std::vector<TopicQueue> topics;
  std::vector<std::string> left_out;  // without stamps
  for (const TopicChoice& choice : chosen) {
    ReadOptions one = options;
    one.topic = all[choice.topic].name;
    one.channels = choice.channels;
    one.hash = options.hash && topics.empty();
    auto rows = open_topic_rows(open(path, options), path, format, one);
    if (rows->info().time.column.empty() && chosen.size() > 1) {
      left_out.push_back(one.topic);
      continue;
    }
    if (rows->info().time.column.empty())
      throw usage_error("E0425", path)
          .says("this topic has no stamps, by which it could be joined with others")
          .got(one.topic)
          .hint("`topic` reads it alone");
    JoinedRows part{nullptr, one.topic, {}};
    for (const Channel& channel : rows->info().channels) part.channels.push_back(one.topic + "/" + channel.name);
    part.rows = std::move(rows);
    topics.emplace_back(std::move(part));
  }
  if (topics.empty())
    throw usage_error("E0425", path)
        .says("none of these topics has stamps, by which they could be joined")
        .got(options.topic)
        .hint("`topic` reads one alone");
  return std::make_unique<JoinedTopics>(std::move(topics), left_out, options);
}

}  // namespace libchar
