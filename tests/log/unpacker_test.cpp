// Compressed logs, read as they are stored: packed by gzip 1.12, zstd 1.5.4 and xz 5.4.1 of Debian
// 12 from the 60 rows below.

#include "libchar/log/csv/unpacker.hpp"

#include <catch2/catch.hpp>
#include <fstream>

#include "libchar/core/error.hpp"
#include "tests/log/libraries.hpp"
#include "tests/log/log_text.hpp"
#include "tests/support/shared.hpp"

using namespace libchar;

namespace {

std::string rows_text() {
  std::string text = "t,x\n";
  for (int k = 0; k < 60; ++k) text += std::to_string(k) + "," + std::to_string(k * 7919 % 1000) + "\n";
  return text;
}

std::string from_hex(std::string_view hex) {
  const auto digit = [](char c) { return c <= '9' ? c - '0' : c - 'a' + 10; };
  std::string bytes;
  for (std::size_t i = 0; i + 1 < hex.size(); i += 2)
    bytes += static_cast<char>(16 * digit(hex[i]) + digit(hex[i + 1]));
  return bytes;
}

struct Packed {
  std::string suffix, hex, sha256;
};

const std::vector<Packed>& packed_files() {
  static const std::vector<Packed> files = {
      {".gz",
       "1f8b08000000000002030dd0b90d44510843d1dcb5387866a7af1f4cf9438a04e2dc8f3f3c3e88ab85717ce0ec6c04ab0bc9dc443115688"
       "63b869e86a5b5a047ed2d8b7a0b196d20e74643c1a982923d0915fb05d42c73689861d0324ab0479f07136def853ba28139e50d0b66c192"
       "db092bce06ac3972d8b0dd60cb4ac11fb31f5c8c59b831de419c6e0d0f5a143ca94af85d0978d3e1c33583ef4d8478ec7a081d7c1176f24"
       "1f8d12f469cbd1079f844d4e903d1a777c45032c4d2857cdc7c489d7e9176fa415ed1d7c84b6a97f49a4622ebf481bc47c69197f519f2ba"
       "9af00769e952fb96010000",
       "cc2e78713d5a88c000bd4fee65358417cf162bb7dd2fcd3785208eca311f024f"},
      {".zst",
       "28b52ffd6496009506006699330fc0a50dc0fff793dd9b2bf7627038302e002e002f00b7ea4d22eb983557312d1ae605d766383798aee83"
       "12e358a4c8be397f87b4f2aeab05e159a5883e7ab191a1814086f10fad40b86542d28b65670ce4ac1d7f5417a2758e24ad01c8de05dd4c1"
       "60d210344dcf8c79cd94a09639a14a66d20f49a6332cbf32b47b637845f53050350c3dd613465c4d282de1584978722fa4898eb0422a420"
       "bd3109e4d2d0c157444ef8c20b5534c5ae7d094cecffb93823a6785aa9c66d5388fac3ec3afe1b4f48661d786726e0da7a234fc03007107"
       "82a8",
       "a9d4c2f0aaa5c31fd9d79b033c0bf39d1e140c21a5ff07e9e603368162043bee"},
      {".xz",
       "fd377a585a000004e6d6b446020021011c00000010cf58cce0019500fc5d003a0b0b00a66c54e43e77f2a8b3d4fd2bf49eab9b1c6daa219"
       "2b985b2fc47ba3e793152939df4524508754d8c5f85933a206d149318ee048315bf1a318c4337180bb54feb5c6a1f203b6d22c2224330aa"
       "9a1e09c335ed1a3556f51ad44e5e4954a9522f38ee41f8855bdc1adf1afa1d60e2a481bef8a4fd8a250ad1d3fc9e5ad1668a71358e11357"
       "4b787aeaef69b75a6c2bf38898ef1700d1510e4aa46ed56679815a5faa69dd99013d1f138b062daf03ec08a4244ac3e33e04210a2686800"
       "ad12b1c0fc17ca3e15c907be5bb907dbe4806b879e4db9b3bd9cbf0f005267d17e4791bc2436f312731bddb92dd92d26f61defd9a8767fd"
       "a96eb23f4eb002bc6c3c10f2b85fe0001980296030000b213cdd2b1c467fb020000000004595a",
       "2e06a76720e6e7f0a777d664fbbe2602ce2d39ec5a3bcea0ff1744202e6964cf"}};
  return files;
}

Recording read_bytes(const std::string& bytes, const std::string& suffix, std::size_t block) {
  const test::TemporaryFolder folder;
  const std::string path = (folder / ("log.csv" + suffix)).string();
  std::ofstream(path, std::ios::binary) << bytes;
  ReadOptions options;
  options.block_bytes = block;
  return read_recording(path, options);
}

}  // namespace

TEST_CASE("a compressed log is the log, and its hash is that of the file as it is stored") {
  NEEDS_LIBRARY(ZLIB);
  NEEDS_LIBRARY(ZSTD);
  NEEDS_LIBRARY(LZMA);
  const Recording plain = test::read_text(rows_text());
  for (const Packed& file : packed_files())
    for (const std::size_t block : {std::size_t{1}, std::size_t{64}, std::size_t{1} << 21U}) {
      INFO(file.suffix << ", blocks of " << block);
      const std::string bytes = from_hex(file.hex);
      const Recording r = read_bytes(bytes, file.suffix, block);
      CHECK(r.samples == plain.samples);
      CHECK(r.info.time.rate_hz == plain.info.time.rate_hz);
      CHECK(r.info.sha256 == file.sha256);
      CHECK(r.info.bytes == bytes.size());
    }
}

TEST_CASE("compressed data that end early give their whole rows and a warning") {
  NEEDS_LIBRARY(ZLIB);
  NEEDS_LIBRARY(ZSTD);
  NEEDS_LIBRARY(LZMA);
  for (const Packed& file : packed_files()) {
    const std::string bytes = from_hex(file.hex);
    std::size_t most = 0;
    for (std::size_t kept = 12; kept < bytes.size(); ++kept) {
      INFO(file.suffix << " cut at " << kept);
      try {
        const Recording r = read_bytes(bytes.substr(0, kept), file.suffix, 64);
        CHECK(test::count(r, "compressed_cut") == 1);
        CHECK(r.info.rows <= 60);
        CHECK(r.info.rows >= most);  // never less from more
        most = r.info.rows;
        for (std::size_t k = 0; k < r.samples[0].size(); ++k)
          CHECK(r.samples[0][k] == static_cast<double>(k * 7919 % 1000));
      } catch (const Error& error) {  // not even a row came out
        CHECK(most == 0);
        CHECK(error.problem().kind == ErrorKind::input);
      }
    }
  }
}

TEST_CASE("damaged compressed data are an error, two members are one log") {
  NEEDS_LIBRARY(ZLIB);
  NEEDS_LIBRARY(ZSTD);
  NEEDS_LIBRARY(LZMA);
  const Packed& gzip = packed_files()[0];
  std::string bytes = from_hex(gzip.hex);
  bytes[bytes.size() - 6] = static_cast<char>(bytes[bytes.size() - 6] ^ 1);  // of the checksum
  CHECK_THROWS_WITH(read_bytes(bytes, ".gz", 64), Catch::Contains("E0329"));
  const std::string half = from_hex(gzip.hex);
  ReadOptions options;
  const test::TemporaryFolder folder;
  const std::string path = (folder / "two.csv.gz").string();
  std::ofstream(path, std::ios::binary) << half << half;
  options.skip_repeated_header = true;
  options.time_column = "none";
  CHECK(read_recording(path, options).info.rows == 120);
}

TEST_CASE("a small file is not gigabytes of text") {
  NEEDS_LIBRARY(ZSTD);
  using namespace std::string_literals;
  std::string frame = "\x28\xb5\x2f\xfd\0\x58"s + "\x40\0\0"s + "a,b\n1,2\n";
  for (int k = 0; k < 300; ++k) frame += "\x02\0\x10\n"s;  // 131072 times the same byte
  CHECK_THROWS_WITH(read_bytes(frame, ".zst", 1U << 21U), Catch::Contains("E0329") && Catch::Contains("100 times"));
  std::string objects = "{";
  for (int k = 0; k < 30000; ++k) objects += (k > 0 ? ",\"k" : "\"k") + std::to_string(k) + "\":1";
  objects += "}\n";
  for (int k = 0; k < 4000; ++k) objects += "{\"k0\":1}\n";
  CHECK_THROWS_WITH(read_bytes(objects, ".jsonl", 1U << 21U), Catch::Contains("E0329") && Catch::Contains("32 times"));
}

TEST_CASE("only text is read compressed") {
  NEEDS_LIBRARY(ZLIB);
  NEEDS_LIBRARY(ZSTD);
  NEEDS_LIBRARY(LZMA);
  const test::TemporaryFolder folder;
  const std::string path = (folder / "log.npy.gz").string();
  std::ofstream(path, std::ios::binary) << from_hex(packed_files()[0].hex);
  CHECK_THROWS_WITH(read_recording(path), Catch::Contains("E0330"));
}
