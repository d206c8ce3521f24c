#include "libchar/log/csv/chunk_pipeline.hpp"

#include <atomic>
#include <catch2/catch.hpp>
#include <fstream>
#include <string>

#include "libchar/core/file/sha256.hpp"
#include "libchar/log/detail/format.hpp"
#include "tests/support/shared.hpp"

using namespace libchar;

namespace {

std::string many_rows(const std::string& last) {
  std::string text = "t,a\n";
  for (int i = 0; i < 20000; ++i) text += std::to_string(i) + "," + std::to_string(7 * i % 1000) + "\n";
  return text + last;
}

std::string written(const test::TemporaryFolder& folder, const std::string& text) {
  const std::string path = (folder / "rows.csv").string();
  std::ofstream(path, std::ios::binary) << text;
  return path;
}

std::string hash_of(const std::string& text) {
  Sha256 hash;
  hash.update(text);
  return hash.finish();
}

ReadOptions small_chunks(int threads) {
  ReadOptions options;
  options.block_bytes = 4096;
  options.threads = threads;
  return options;
}

}  // namespace

TEST_CASE("a caller may stop at any chunk, and the hash is that of the whole file") {
  const test::TemporaryFolder folder;
  const std::string text = many_rows("");
  const std::string path = written(folder, text);
  for (const int threads : {2, 3, 8})
    for (const int chunks : {0, 1, 5, 30}) {
      const auto rows = find_format("csv")->open(path, small_chunks(threads));
      RowBlock block;
      Findings warnings;
      for (int i = 0; i < chunks; ++i) REQUIRE(rows->next(block, warnings));
      CHECK(rows->sha256() == hash_of(text));
      CHECK_FALSE(rows->next(block, warnings));
    }
}

// Found by fuzzing: a thread that was reading took the stop back that came just then, and waited
// for ever for a chunk to be free.
TEST_CASE("a caller may stop at any moment: the threads that read ahead end") {
  const test::TemporaryFolder folder;
  const std::string path = written(folder, many_rows(""));
  ReadOptions options = small_chunks(3);
  options.block_bytes = 16;
  for (int turn = 0; turn < 1000; ++turn) {
    options.hash = turn % 2 == 0;
    const auto rows = find_format("csv")->open(path, options);
    RowBlock block;
    Findings warnings;
    for (int i = 0; i < turn % 7; ++i) REQUIRE(rows->next(block, warnings));
    const volatile int waits = turn * 37 % 1000;
    for (int i = 0; i < waits; ++i) std::atomic_signal_fence(std::memory_order_seq_cst);
  }
}

TEST_CASE("a bad row far down is thrown in its turn, after every row before it") {
  const test::TemporaryFolder folder;
  const std::string path = written(folder, many_rows("20000,x7\n20001,3\n"));
  for (const int threads : {1, 2, 8}) {
    const auto rows = find_format("csv")->open(path, small_chunks(threads));
    RowBlock block;
    Findings warnings;
    std::size_t read = 0;
    std::string problem;
    try {
      while (rows->next(block, warnings)) read += block.rows;
    } catch (const Error& error) {
      problem = error.problem().where;
    }
    CHECK(read == 20000);
    CHECK(problem.find(":20002:") != std::string::npos);
  }
}
