// Databases of rosbag2 (SQLite 3): messages in CDR, by definitions in the file (since Iron) or, without, by those of
// common types. Source: ros2/rosbag2, rosbag2_storage_sqlite3 (tables topics, messages, message_definitions).

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <map>
#include <memory>

#include "libchar/core/refusal.hpp"
#include "libchar/log/binary/file.hpp"
#include "libchar/log/detail/format.hpp"
#include "libchar/log/ros/decompress.hpp"
#include "libchar/log/ros/messages/message_topics.hpp"
#include "libchar/log/ros/sqlite_file.hpp"
#include "libchar_have.hpp"
#if LIBCHAR_HAVE_SQLITE
#include <sqlite3.h>
#endif

namespace libchar {
namespace {

constexpr std::string_view kSqliteMagic{"SQLite format 3\0", 16};
constexpr std::uint64_t kSqliteHeader = 100;

#if LIBCHAR_HAVE_SQLITE

constexpr const char* kDamaged = "the database is cut or damaged: messages before the damage were read";

class Database {
 public:
  explicit Database(const std::string& path) : handle_(open_sqlite(path)) {
    // A file of unknown origin: its schema runs nothing, and no value is larger than what is read of other logs.
    sqlite3_db_config(handle_, SQLITE_DBCONFIG_TRUSTED_SCHEMA, 0, nullptr);
    sqlite3_limit(handle_, SQLITE_LIMIT_LENGTH, static_cast<int>(kLargestChunk));
    sqlite3_exec(handle_, "PRAGMA cell_size_check=ON", nullptr, nullptr, nullptr);
    // Nothing can be written (sqlite_file.hpp); without it a file that was cut is refused as a whole.
    sqlite3_exec(handle_, "PRAGMA writable_schema=ON", nullptr, nullptr, nullptr);
  }
  ~Database() { sqlite3_close(handle_); }
  Database(const Database&) = delete;
  Database& operator=(const Database&) = delete;
  sqlite3* handle() const { return handle_; }
  bool has_table(const char* name) const;

 private:
  sqlite3* handle_;
};

class Query {
 public:
  Query(const Database& database, const std::string& text) {
    prepared_ = sqlite3_prepare_v2(database.handle(), text.c_str(), -1, &handle_, nullptr);
  }
  ~Query() { sqlite3_finalize(handle_); }
  Query(const Query&) = delete;
  Query& operator=(const Query&) = delete;
  bool good() const { return prepared_ == SQLITE_OK; }
  /// Is there a row? What ended the rows otherwise is `damaged`.
  bool step() {
    if (!good() || ended_) return false;
    const int code = sqlite3_step(handle_);
    ended_ = code != SQLITE_ROW;  // another step would begin again
    damaged_ = code != SQLITE_ROW && code != SQLITE_DONE;
    if (damaged_) why_ = sqlite3_errstr(code);
    return code == SQLITE_ROW;
  }
  bool damaged() const { return damaged_; }
  const std::string& why() const { return why_; }
  void bind(std::int64_t value) {
    sqlite3_reset(handle_);
    ended_ = false;
    sqlite3_bind_int64(handle_, 1, value);
  }
  std::int64_t integer(int column) const { return sqlite3_column_int64(handle_, column); }
  std::span<const std::byte> bytes(int column) const {
    const void* data = sqlite3_column_blob(handle_, column);
    const int size = sqlite3_column_bytes(handle_, column);
    if (data == nullptr) return {};
    return {static_cast<const std::byte*>(data), static_cast<std::size_t>(size)};
  }
  std::string text(int column) const {
    const auto found = bytes(column);
    return {reinterpret_cast<const char*>(found.data()), found.size()};
  }

 private:
  sqlite3_stmt* handle_ = nullptr;
  int prepared_ = SQLITE_ERROR;
  bool ended_ = false, damaged_ = false;
  std::string why_;
};

bool Database::has_table(const char* name) const {
  Query query(*this, fmt::format("SELECT 1 FROM sqlite_master WHERE type='table' AND name='{}'", name));
  return query.step();
}

class Db3Reader final : public MessageTopics {
 public:
  Db3Reader(const std::string& path, const ReadOptions& options)
      : MessageTopics(path, options, false), database_(path) {
    std::error_code none;
    bytes_ = std::filesystem::file_size(path, none);
    warn_of_missing_pages(path);
    if (!database_.has_table("topics") || !database_.has_table("messages")) refuse_without_tables(path);
    warn_of_journal(path);
    read_definitions();
    list();
  }

  std::vector<std::string> dialect() const override {
    return {fmt::format("rosbag2 database, {} definitions", definitions_.empty() ? "without" : "with")};
  }

  std::uint64_t bytes_read() const override {
    if (ended_ || rows_ == 0) return ended_ ? bytes_ : 0;
    return static_cast<std::uint64_t>(static_cast<double>(bytes_) * static_cast<double>(seen_) /
                                      static_cast<double>(std::max(rows_, seen_)));
  }

 protected:
  void start(std::size_t topic) override {
    rows_ = topics()[topic].rows;
    seen_ = 0;
    query_ = std::make_unique<Query>(
        database_, fmt::format("SELECT id, timestamp, data FROM messages WHERE topic_id IN ({}) ORDER BY id",
                               fmt::join(ids_[topic], ",")));
  }

  bool next_message(RawMessage& message, Findings& warnings) override {
    if (query_->step()) {
      ++seen_;
      message.at = static_cast<std::uint64_t>(query_->integer(0));
      message.log_ns = message.publish_ns = query_->integer(1);
      message.data = plain(query_->bytes(2), unpacked_);
      return true;
    }
    if (query_->damaged()) warnings.add("cut_end", kDamaged, fmt::format("after row {}: {}", seen_, query_->why()));
    ended_ = true;
    return false;
  }

  std::string place(const RawMessage& message) const override { return fmt::format("message {}", message.at); }

 private:
  struct Definition {
    std::string encoding, text;
  };
  struct Count {
    std::uint64_t rows = 0;
    std::int64_t first_ns = 0, last_ns = 0, first_id = 0;
  };

  // Messages may be packed one by one (compression_mode: message).
  static std::span<const std::byte> plain(std::span<const std::byte> data, std::vector<std::byte>& to) {
    constexpr unsigned char kZstd[] = {0x28, 0xb5, 0x2f, 0xfd};
    if (data.size() < 4 || std::memcmp(data.data(), kZstd, 4) != 0) return data;
    if (!why_not_packed("zstd").empty() || !unpack("zstd", data, kLargestChunk, to).empty()) return {};
    return to;
  }

  [[noreturn]] void refuse_without_tables(const std::string& path) {
    std::string what = "a database of SQLite without the tables of rosbag2 (topics, messages), or a damaged one";
    std::string hint = "export its table as CSV (sqlite3 -header -csv FILE 'select …')";
    const std::string head = BinaryFile(path).head(kSqliteMagic.size());
    if (head != kSqliteMagic) {
      what = wrong_start(head, kSqliteMagic, "a database of SQLite");
      hint = "";
    } else if (bytes_ < kSqliteHeader) {
      what = fmt::format("ends at byte {}, inside the header of a database", bytes_);
      hint = "copy it again";
    } else if (const Finding* cut = found_early().find("cut_end")) {
      what = fmt::format("holds no table of rosbag2 (topics, messages): {}", cut->sentence);
      hint = "copy it again";
    }
    throw input_error("E0446", path).says(std::move(what)).hint(std::move(hint));
  }

  // What was not yet written into the file itself.
  void warn_of_journal(const std::string& path) {
    for (const char* end : {"-wal", "-journal"}) {
      std::error_code none;
      const auto bytes = std::filesystem::file_size(path + end, none);
      if (!none && bytes > 0)
        found_early().add("open_recording", "the recording was not closed: what is in the file next to it is not read",
                          path + end);
    }
  }

  // The header says of how many pages the file is: big-endian numbers at bytes 16 and 28.
  void warn_of_missing_pages(const std::string& path) {
    const std::string head = BinaryFile(path).head(32);
    const auto number = [&](std::size_t at, std::size_t bytes) {
      std::uint64_t value = 0;
      for (std::size_t i = at; i < at + bytes && i < head.size(); ++i)
        value = value * 256 + static_cast<unsigned char>(head[i]);
      return value;
    };
    const std::uint64_t page = number(16, 2) == 1 ? 65536 : number(16, 2);
    const std::uint64_t said = page * number(28, 4);
    if (bytes_ < said)
      found_early().add(
          "cut_end",
          fmt::format("the database ends at byte {} of {} (a copy that was cut): messages before that are read", bytes_,
                      said));
  }

  void read_definitions() {
    if (!database_.has_table("message_definitions")) return;
    Query query(database_, "SELECT topic_type, encoding, encoded_message_definition FROM message_definitions");
    while (query.step()) definitions_.try_emplace(query.text(0), Definition{query.text(1), query.text(2)});
  }

  std::map<std::int64_t, Count> counted() const {
    std::map<std::int64_t, Count> counts;
    Query query(database_, "SELECT topic_id, timestamp, id FROM messages ORDER BY id");
    while (query.step()) {
      const std::int64_t time = query.integer(1);
      Count& count = counts[query.integer(0)];
      if (count.rows++ == 0) count = {1, time, time, query.integer(2)};
      count.first_ns = std::min(count.first_ns, time);
      count.last_ns = std::max(count.last_ns, time);
    }
    return counts;
  }

  void list() {
    const std::map<std::int64_t, Count> counts = counted();
    Query example(database_, "SELECT data FROM messages WHERE id=?1");
    Query query(database_, "SELECT id, name, type, serialization_format FROM topics ORDER BY id");
    RawTopics raw;
    while (query.step()) {
      RawTopic topic;
      const std::int64_t id = query.integer(0);
      topic.name = query.text(1);
      topic.format.type = query.text(2);
      topic.format.message_encoding = query.text(3);
      if (const auto found = definitions_.find(topic.format.type); found != definitions_.end()) {
        topic.format.definition_encoding = found->second.encoding;
        topic.format.definition = found->second.text;
      }
      if (const auto found = counts.find(id); found != counts.end()) {
        topic.rows = found->second.rows;
        topic.first_ns = found->second.first_ns;
        topic.last_ns = found->second.last_ns;
        example.bind(found->second.first_id);
        if (example.step()) {
          const auto data = plain(example.bytes(0), unpacked_);
          topic.format.example.assign(data.begin(), data.end());
        }
      }
      const std::size_t at = raw.add(std::move(topic));
      if (at == ids_.size()) ids_.emplace_back();
      ids_[at].push_back(id);
    }
    set_topics(raw.take());
  }

  Database database_;
  std::map<std::string, Definition> definitions_;
  std::vector<std::vector<std::int64_t>> ids_;  // of topics in the database, by topic
  std::unique_ptr<Query> query_;
  std::vector<std::byte> unpacked_;
  std::uint64_t bytes_ = 0, rows_ = 0, seen_ = 0;
  bool ended_ = false;
};

std::unique_ptr<TopicReader> open_db3(const std::string& path, const ReadOptions& options) {
  return std::make_unique<Db3Reader>(path, options);
}

#else

std::unique_ptr<TopicReader> open_db3(const std::string& path, const ReadOptions&) {
  throw input_error("E0447", path)
      .says("a database of SQLite, and this program is built without sqlite3")
      .hint("ros2 bag convert writes it as MCAP");
}

#endif

}  // namespace

Format db3_format() {
  Format row;
  row.about.name = "db3";
  row.about.title = "ROS 2 database";
  row.about.suffixes = {".db3"};
  row.about.units = "of ROS types";
  row.about.topics = true;
  row.about.time_sources = true;
  row.certain = [](std::string_view first_bytes) { return first_bytes.starts_with(kSqliteMagic); };
  row.topics = open_db3;
  return row;
}

}  // namespace libchar
