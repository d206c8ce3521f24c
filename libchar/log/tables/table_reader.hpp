#pragma once
// Logs whose topics are tables of text: members of an archive, files of a folder, sheets of a workbook. Each table is
// read as every CSV file is.

#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "libchar/log/csv/unpacker.hpp"
#include "libchar/log/topics/topic_reader.hpp"

namespace libchar {

namespace csv {
/// Rows of a table whose text comes from elsewhere; `name` is that of messages.
std::unique_ptr<RowSource> open_text(std::unique_ptr<Unpacker> text, const std::string& name,
                                     const ReadOptions& options);
}  // namespace csv

class TableReader : public TopicReader {
 public:
  /// Rows of a table, with a clock and channels as its text says.
  virtual std::unique_ptr<RowSource> open_table(std::size_t topic, const ReadOptions& options) = 0;
  /// The one that is meant where nobody chooses, and why.
  virtual std::optional<std::pair<std::size_t, std::string>> usual_table() const { return {}; }

  const std::vector<LogTopic>& topics() const final { return topics_; }
  std::string stamps(std::size_t) const final { return ""; }
  void select(std::size_t, const std::vector<std::size_t>&, std::optional<std::size_t>, StampUnit) final {}
  bool next(RowBlock&, std::size_t, Findings&) final { throw std::logic_error("tables are read by open_table"); }
  std::uint64_t bytes_read() const final { return 0; }

 protected:
  /// Looks at the table called so, which `open_table` opens.
  void list_table(const std::string& name);

 private:
  std::vector<LogTopic> topics_;
};

/// The table and channels that `options` choose.
std::unique_ptr<RowSource> open_table_rows(std::unique_ptr<TableReader> reader, const std::string& path,
                                           std::string_view format, const ReadOptions& options);

}  // namespace libchar
