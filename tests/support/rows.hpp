#pragma once
// All rows of a log as its format delivers them, in one piece: for tests of a format below the common part of reading.

#include <filesystem>
#include <string>
#include <vector>

#include "libchar/log/detail/format.hpp"

namespace test {

struct Rows {
  libchar::LogInfo info;
  std::vector<std::vector<double>> columns;
  std::vector<std::int64_t> time_ns;
  libchar::Findings warnings;
  std::string sha256;
  std::size_t blocks = 0;
};

inline Rows read_rows(const std::string& format, const std::filesystem::path& path,
                      const libchar::ReadOptions& options = {},
                      bool to_end = false) {  // warnings that need totals too
  const libchar::Format* const row = libchar::find_format(format);
  if (row == nullptr) throw std::runtime_error("no such format");
  Rows all;
  const auto source = libchar::open_rows(*row, path.string(), options);
  libchar::RowBlock block;
  while (source->next(block, all.warnings)) {
    ++all.blocks;
    all.columns.resize(block.columns.size());
    for (std::size_t c = 0; c < block.columns.size(); ++c)
      all.columns[c].insert(all.columns[c].end(), block.columns[c].begin(), block.columns[c].end());
    all.time_ns.insert(all.time_ns.end(), block.time_ns.begin(), block.time_ns.end());
  }
  if (to_end) source->finish(all.warnings);
  all.info = source->info();
  all.sha256 = source->sha256();
  return all;
}

}  // namespace test
