#include "libchar/log/tables/table_reader.hpp"

#include <utility>

#include "libchar/core/error.hpp"
#include "libchar/core/file/log_files.hpp"
#include "libchar/log/binary/file.hpp"
#include "libchar/log/topics/topic_rows.hpp"

namespace libchar {
namespace {

/// Rows of the table, in a log that is more than it.
class TableRows final : public RowSource {
 public:
  TableRows(std::unique_ptr<TableReader> reader, const std::string& path, std::string_view format,
            const ReadOptions& options)
      : reader_(std::move(reader)), path_(path) {
    for (const std::string& file : files_of_log(path)) files_.push_back(std::make_unique<BinaryFile>(file));
    std::vector<const BinaryFile*> all;
    for (const auto& file : files_) all.push_back(file.get());
    hash_ = std::make_unique<FileHash>(std::move(all), options.hash);
    choose(options);
    info_.file = path;
    info_.format = format;
    info_.bytes = 0;
    for (const auto& file : files_) info_.bytes += file->size();
  }

  const LogInfo& info() const override { return info_; }
  bool next(RowBlock& block, Findings& warnings) override {
    if (!std::exchange(started_, true)) hash_->start();
    return rows_->next(block, warnings);
  }
  std::string place(const RowBlock& block, std::size_t i, std::uint64_t before) const override {
    return rows_->place(block, i, before);
  }
  std::string where(const RowBlock& block, std::size_t i, std::uint64_t before) const override {
    return rows_->where(block, i, before);
  }
  void finish(Findings& warnings) override { rows_->finish(warnings); }
  std::uint64_t bytes_read() const override { return rows_->bytes_read(); }
  std::uint64_t bytes_total() const override { return rows_->bytes_total(); }
  std::string sha256() override { return hash_->finish(); }

 private:
  void choose(const ReadOptions& options) {
    ReadOptions named = options;
    std::string guess;
    const std::vector<LogTopic>& topics = reader_->topics();
    if (const auto usual = reader_->usual_table(); usual && named.topic.empty() && named.channels.empty()) {
      named.topic = topics[usual->first].name;
      guess = usual->second;
    }
    const auto choice = topics.empty() ? std::nullopt : choose_topic(topics, named, path_);
    if (!choice) refuse_without_topic(topics, path_);
    ReadOptions chosen = options;
    chosen.topic.clear();
    chosen.channels = choice->channels;
    chosen.hash = false;
    rows_ = reader_->open_table(choice->topic, chosen);
    info_ = rows_->info();
    info_.topics = topics;
    info_.topic = topics[choice->topic].name;
    info_.dialect.push_back("table " + info_.topic);
    for (const std::string& line : {guess, choice->guess})
      if (!line.empty()) info_.guesses.push_back(line);
  }

  std::unique_ptr<TableReader> reader_;  // outlives the rows
  std::string path_;
  std::vector<std::unique_ptr<BinaryFile>> files_;
  std::unique_ptr<FileHash> hash_;
  std::unique_ptr<RowSource> rows_;
  LogInfo info_;
  bool started_ = false;
};

}  // namespace

void TableReader::list_table(const std::string& name) {
  LogTopic& topic = topics_.emplace_back();
  topic.name = name;
  constexpr std::size_t kMostTables = 256;
  if (topics_.size() > kMostTables) {
    topic.why_not = "one of too many tables";
    return;
  }
  ReadOptions head;
  head.hash = false;
  head.threads = 1;
  try {
    const auto rows = open_table(topics_.size() - 1, head);
    topic.fields = rows->info().channels;
    topic.rows = rows->info().rows;
  } catch (const Error& error) {
    topic.why_not = error.problem().what;
  }
}

std::unique_ptr<RowSource> open_table_rows(std::unique_ptr<TableReader> reader, const std::string& path,
                                           std::string_view format, const ReadOptions& options) {
  return std::make_unique<TableRows>(std::move(reader), path, format, options);
}

}  // namespace libchar
