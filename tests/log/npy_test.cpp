// Fixtures by NumPy itself (fixtures/npy/make.py), so that our reader is not checked against our writer.

#include <catch2/catch.hpp>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>

#include "libchar/core/error.hpp"
#include "libchar/core/file/sha256.hpp"
#include "libchar/log/binary/npy_header.hpp"
#include "libchar/log/detail/format.hpp"
#include "libchar/log/read.hpp"
#include "tests/support/rows.hpp"
#include "tests/support/shared.hpp"

using namespace libchar;
using ColumnValues = std::vector<double>;

namespace {

test::Rows read(const std::string& name, const ReadOptions& options = {}) {
  return test::read_rows("npy", test::fixture("npy/" + name), options);
}

std::string names(const LogInfo& info) {
  std::string all;
  for (const Channel& channel : info.channels) all += channel.name + " ";
  return all;
}

std::string npy(const std::string& literal, const std::string& data = std::string(32, '\0')) {
  std::string text("\x93NUMPY\x01\x00", 8);
  text += static_cast<char>(literal.size() & 0xFFU);
  text += static_cast<char>(literal.size() >> 8U);
  return text + literal + data;
}

NpyHeader header_of(const std::string& literal) {
  const std::string bytes = npy(literal);
  return parse_npy_header(bytes, bytes.size(), "a.npy");
}

std::string fault_of(const std::string& literal) {
  try {
    header_of(literal);
    return "accepted";
  } catch (const Error& error) {
    return error.what();
  }
}

}  // namespace

TEST_CASE("64-bit integers are said to be rounded where a double does not hold them, and only there") {
  const auto rounded = [](const std::vector<std::uint64_t>& values, const char* type) {
    const test::TemporaryFolder folder;
    const std::string path = (folder / "a.npy").string();
    const std::string literal = "{'descr': '" + std::string(type) + "', 'fortran_order': False, 'shape': (" +
                                std::to_string(values.size()) + ",), }\n";
    std::string data(values.size() * 8, '\0');
    std::memcpy(data.data(), values.data(), data.size());
    std::ofstream(path, std::ios::binary) << npy(literal, data);
    const test::Rows rows = test::read_rows("npy", path, {}, true);
    const Finding* warning = rows.warnings.find("rounded_integer");
    return warning == nullptr ? 0 : warning->count;
  };
  const std::uint64_t one = 1, edge = one << 53U;
  CHECK(rounded({edge - 1, edge, edge + 2, one << 62U, (one << 62U) + (one << 10U)}, "<i8") == 0);
  CHECK(rounded({edge + 1, (one << 62U) + 1, (one << 63U) - 1}, "<i8") == 3);
  CHECK(rounded({one << 63U, ~one + 1}, "<i8") == 0);  // the least, and -2
  CHECK(rounded({(one << 63U) + 1}, "<i8") == 1);
  CHECK(rounded({one << 63U, (one << 63U) + (one << 11U)}, "<u8") == 0);
  CHECK(rounded({(one << 63U) + 1, ~std::uint64_t{0}}, "<u8") == 2);
}

TEST_CASE("a file that becomes shorter while it is read is told with the byte where it ends") {
  const test::TemporaryFolder folder;
  const std::string path = (folder / "a.npy").string();
  const std::string literal = "{'descr': '<f8', 'fortran_order': False, 'shape': (1000,), }\n";
  std::ofstream(path, std::ios::binary) << npy(literal, std::string(8000, '\0'));
  ReadOptions options;
  options.block_bytes = 800;
  const auto source = find_format("npy")->open(path, options);
  std::filesystem::resize_file(path, 10 + literal.size() + 4001);
  RowBlock block;
  Findings warnings;
  const std::string end = "(byte " + std::to_string(10 + literal.size() + 4001) + ")";
  CHECK_THROWS_WITH(([&] {
                      while (source->next(block, warnings)) {
                      }
                    })(),
                    Catch::Contains(end) && Catch::Contains("E0104") && Catch::Contains("became shorter"));
}

TEST_CASE("C order, Fortran order, byte order and header version change nothing") {
  const std::vector<ColumnValues> expected = {
      {0, 0.375, 0.75, 1.125}, {0.125, 0.5, 0.875, 1.25}, {0.25, 0.625, 1, 1.375}};
  for (const char* name : {"c_order.npy", "fortran_order.npy", "big_endian_f4.npy", "version_2.npy"}) {
    INFO(name);
    const auto got = read(name);
    CHECK(got.columns == expected);
    CHECK(names(got.info) == "c0 c1 c2 ");
    CHECK(got.info.rows == 4);
    CHECK(got.warnings.empty());
    CHECK(got.time_ns.empty());
  }
}

TEST_CASE("integers come over exactly, and are counted where a double cannot hold them") {
  CHECK(read("int16.npy").columns == std::vector<ColumnValues>{{-32768, 0}, {32767, -1}});
  CHECK(read("int16.npy").info.channels[0].integer);
  const auto large = test::read_rows("npy", test::fixture("npy/int64.npy"), {}, true);
  CHECK(large.columns[0] == ColumnValues{0x1p53, 0x1p53, -0x1p63, 0x1p63});
  REQUIRE(large.warnings.find("rounded_integer"));
  CHECK(large.warnings.find("rounded_integer")->count == 2);  // 2^53 + 1 and 2^63 - 1
  const auto natural = test::read_rows("npy", test::fixture("npy/uint64.npy"), {}, true);
  CHECK(natural.columns[0] == ColumnValues{0, 0x1p53, 0x1p64});
  CHECK(natural.warnings.find("rounded_integer")->count == 2);
}

TEST_CASE("half precision is exact, infinity and NaN are missing, infinity is counted") {
  const auto got = test::read_rows("npy", test::fixture("npy/half.npy"), {}, true);
  const ColumnValues& x = got.columns[0];
  CHECK(ColumnValues(x.begin(), x.begin() + 6) == ColumnValues{0, 1, -2, 65504, 0x1p-24, 0x1p-14});
  CHECK((x[6] == 0 && std::signbit(x[6])));
  CHECK((std::isnan(x[7]) && std::isnan(x[8])));
  REQUIRE(got.warnings.find("infinite_value"));
  CHECK(got.warnings.find("infinite_value")->count == 1);
}

TEST_CASE("a structured array gives its fields by name and its stamps to the nanosecond") {
  const auto got = read("structured.npy");
  CHECK(names(got.info) == "gyr_0 gyr_1 gyr_2 acc_0 acc_1 acc_2 count ");
  CHECK(got.time_ns[4] == 1403636579758555392 + 4 * 5'000'000);
  CHECK(got.info.time.column == "t");
  CHECK(got.info.time.unit == "ns");
  CHECK(got.info.time.unit_guessed);
  CHECK(got.columns[1] == ColumnValues{0.25, 1, 1.75, 2.5, 3.25});
  CHECK(got.columns[5] == ColumnValues{-1, -2.5, -4, -5.5, -7});
  CHECK(got.columns[6] == ColumnValues{-2, -1, 0, 1, 2});
  const LogInfo info = read_recording(test::fixture("npy/structured.npy").string()).info;
  CHECK(info.time.rate_hz == Approx(200).epsilon(1e-12));
  CHECK(info.time.start_ns == 1403636579758555392);
}

TEST_CASE("padding of aligned records is skipped, UTF-8 names are kept") {
  const auto got = read("aligned_version_3.npy");
  CHECK(names(got.info) == "flag Größe ");
  CHECK(got.columns == std::vector<ColumnValues>{{1, 2, 3}, {0.5, 1.5, 2.5}});
}

TEST_CASE("channels are chosen by name or position, in file order, a slip is named") {
  ReadOptions options;
  options.channels = {"acc_1", "gyr_0"};
  const auto got = read("structured.npy", options);
  CHECK(names(got.info) == "gyr_0 acc_1 ");
  CHECK(got.columns[1] == ColumnValues{-0.5, -2, -3.5, -5, -6.5});
  options.channels = {"gry_0"};
  CHECK_THROWS_WITH(read("structured.npy", options), Catch::Contains("did you mean gyr_0?"));
  options.channels = {"c3"};
  CHECK_THROWS_WITH(read("c_order.npy", options),
                    Catch::Contains("it has c0, c1, c2") || Catch::Contains("did you mean"));
  options.channels = {"c2"};
  for (const char* name : {"c_order.npy", "fortran_order.npy"})
    CHECK(read(name, options).columns == std::vector<ColumnValues>{{0.25, 0.625, 1, 1.375}});
}

TEST_CASE("an unnamed array has a time column only when it is named by position") {
  ReadOptions options;
  options.time_column = "c0";
  const auto got = read("fortran_order.npy", options);
  CHECK(names(got.info) == "c1 c2 ");
  CHECK(got.time_ns == std::vector<std::int64_t>{0, 375'000'000, 750'000'000, 1'125'000'000});
  options.time_unit = "ms";
  CHECK(read("c_order.npy", options).time_ns[1] == 375'000);
}

TEST_CASE("a real recording with time in its first column") {
  NEEDS_SHARED("data/tilt_broad_02_undisturbed_slow_rotation_B.npy");
  ReadOptions options;
  options.time_column = "c0";
  const Recording got =
      read_recording(test::shared("data/tilt_broad_02_undisturbed_slow_rotation_B.npy").string(), options);
  CHECK(got.info.time.rate_hz == Approx(285.7142857142857).epsilon(1e-9));
  CHECK(got.info.samples == 53240);
  CHECK(got.info.time.gaps == 0);
  CHECK(got.samples.size() == 13);
  std::size_t missing = 0;
  for (const double x : got.samples[6]) missing += std::isnan(x);
  CHECK(missing == 1706);  // as its description says
}

TEST_CASE("block size and hashing never change what is read") {
  for (const char* name : {"structured.npy", "fortran_order.npy", "half.npy", "aligned_version_3.npy"}) {
    const auto whole = read(name);
    for (std::size_t bytes = 1; bytes < 70000; bytes = bytes * 5 / 3 + 1) {
      INFO(name << " in blocks of " << bytes);
      ReadOptions options;
      options.block_bytes = bytes;
      const auto got = read(name, options);
      REQUIRE(got.columns.size() == whole.columns.size());
      for (std::size_t c = 0; c < got.columns.size(); ++c)
        CHECK(std::memcmp(got.columns[c].data(), whole.columns[c].data(), whole.columns[c].size() * 8) == 0);
      CHECK(got.time_ns == whole.time_ns);
      CHECK(got.sha256 == whole.sha256);
      CHECK(got.warnings.list().size() == whole.warnings.list().size());
    }
    Sha256 sha;
    sha.update(test::slurp(test::fixture(std::string("npy/") + name)));
    CHECK(whole.sha256 == sha.finish());
  }
}

TEST_CASE("a reading that is given up does not wait for the rest") {
  const auto source = find_format("npy")->open(test::fixture("npy/c_order.npy").string(), {});
  RowBlock block;
  Findings warnings;
  CHECK(source->next(block, warnings));
  CHECK(source->place(block, 2, 0) == "row 2 (byte 176)");
}

TEST_CASE("the header is read as Python writes it and never more freely") {
  const NpyHeader spaced = header_of("{ \"shape\" : ( 2 , 2 ) ,'fortran_order':True,'descr':'=f8'}\n");
  CHECK(spaced.shape == std::vector<std::uint64_t>{2, 2});
  CHECK(spaced.fortran_order);
  const NpyHeader quoted =
      header_of("{'descr': [('a\\'b', '<f4'), (\"c\\\\\", '|i1', 2)], 'fortran_order': False, 'shape': (3,), }");
  CHECK(quoted.fields[0].name == "a'b");
  CHECK(quoted.fields[1].name == "c\\");
  CHECK(quoted.item_bytes == 6);
  const std::string rest = "'fortran_order': False, 'shape': (4,), }";
  CHECK_THAT(fault_of("{'descr': __import__('os'), " + rest), Catch::Contains("expected a quoted string"));
  CHECK_THAT(fault_of("{'descr': '|O', " + rest),
             Catch::Contains("Python objects (pickled code), which are never read"));
  CHECK_THAT(fault_of("{'descr': '<c16', " + rest), Catch::Contains("complex"));
  CHECK_THAT(fault_of("{'descr': '|S5', " + rest), Catch::Contains("text"));
  CHECK_THAT(fault_of("{'descr': 'f8', " + rest), Catch::Contains("of a type that is not read"));
  CHECK_THAT(fault_of("{'descr': [('a', '<f8'), ('a', '<f8')], " + rest), Catch::Contains("two fields have one name"));
  const NpyHeader nested = header_of(
      "{'descr': [('t', '<f8'), ('w', [('x', '<f4'), ('y', '<f8', (2,))]), ('', '|V2'), ('n', '<i2')], " + rest + "\n");
  REQUIRE(nested.fields.size() == 4);
  CHECK(nested.fields[1].name == "w.x");
  CHECK(nested.fields[2].name == "w.y");
  CHECK(nested.fields[2].byte == 12);
  CHECK(nested.fields[3].byte == 30);
  CHECK(nested.item_bytes == 32);
  CHECK_THAT(fault_of("{'descr': [('a', [('b', '<f8')], (2,))], " + rest), Catch::Contains("array of records"));
  std::string deep = "'<f8'";
  for (int k = 0; k < 40; ++k) deep = "[('a', " + deep + ")]";
  CHECK_THAT(fault_of("{'descr': " + deep + ", " + rest), Catch::Contains("too deep"));
  CHECK_THAT(fault_of("{'descr': [], " + rest), Catch::Contains("no field"));
  CHECK_THAT(fault_of("{'descr': [('a', '<f8', (4294967296, 4294967296, 4))], " + rest), Catch::Contains("overflows"));
  CHECK_THAT(fault_of("{'descr': [('a', '<f8', (200000,))], " + rest), Catch::Contains("more than 32768 columns"));
  CHECK_THAT(fault_of("{'descr': '<f8', 'shape': (4,), }"), Catch::Contains("no key \"fortran_order\""));
  CHECK_THAT(fault_of("{'descr': '<f8', 'fortran_order': 0, 'shape': (4,), }"),
             Catch::Contains("neither True nor False"));
  CHECK_THAT(fault_of("{'descr': '<f8', 'fortran_order': False, 'shape': (99999999999999999999,), }"),
             Catch::Contains("too large"));
  CHECK_THAT(fault_of("{'descr': '<f8', " + rest + "x"), Catch::Contains("follows the header"));
  CHECK_THAT(fault_of("{'descr': '<f8"), Catch::Contains("does not end"));
  CHECK_THAT(fault_of(""), Catch::Contains("expected {"));
}

TEST_CASE("what is no regular file is said so at once") {
  const test::TemporaryFolder folder;
  CHECK_THROWS_WITH(find_format("npy")->open(folder.path().string(), {}), Catch::Contains("is a folder"));
  CHECK_THROWS_WITH(find_format("npy")->open((folder / "none.npy").string(), {}), Catch::Contains("No such file"));
  CHECK_THROWS_WITH(find_format("npy")->open("/dev/zero", {}), Catch::Contains("not a regular file"));
  std::ofstream(folder / "empty.npy") << npy("{'descr': '<f8', 'fortran_order': False, 'shape': (0,), }", "");
  CHECK_THROWS_WITH(find_format("npy")->open((folder / "empty.npy").string(), {}), Catch::Contains("holds no samples"));
}

TEST_CASE("stamps that overflow, are too large or are missing") {
  const test::TemporaryFolder folder;
  const auto write = [&](const std::vector<double>& values) {
    std::string data(values.size() * 8, '\0');
    std::memcpy(data.data(), values.data(), data.size());
    std::ofstream(folder / "t.npy", std::ios::binary)
        << npy("{'descr': [('time_s', '<f8'), ('x', '<f8')], 'fortran_order': False, 'shape': (" +
                   std::to_string(values.size() / 2) + ",), }",
               data);
    return test::read_rows("npy", folder / "t.npy");
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  CHECK(write({0, 1, 0.1, 2, 0.2, 3}).time_ns == std::vector<std::int64_t>{0, 100'000'000, 200'000'000});
  CHECK_THROWS_WITH(write({0, 1, nan, 2, 0.2, 3}),
                    Catch::Contains("E0313") && Catch::Contains("missing time stamp") && Catch::Contains("row 1"));
  CHECK_THROWS_WITH(write({0, 1, 1e10, 2}),
                    Catch::Contains("does not fit 64-bit nanoseconds") && Catch::Contains("row 1"));
}

TEST_CASE("dimensions behind the first are columns, in either order") {
  const auto read = [](bool fortran, const std::vector<double>& values) {
    const test::TemporaryFolder folder;
    std::string header =
        std::string("{'descr': '<f8', 'fortran_order': ") + (fortran ? "True" : "False") + ", 'shape': (2, 2, 3), }";
    header.resize(117, ' ');
    header += '\n';
    std::string bytes = std::string("\x93NUMPY\x01\x00", 8) + '\x76' + '\0' + header;
    bytes.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(double));
    const std::string path = (folder / "a.npy").string();
    std::ofstream(path, std::ios::binary) << bytes;
    return read_recording(path).samples;
  };
  // Element (i, j, k) is 100 i + 10 j + k.
  const auto rows = read(false, {0, 1, 2, 10, 11, 12, 100, 101, 102, 110, 111, 112});
  CHECK(rows[4] == std::vector<double>{11, 111});
  CHECK(rows == read(true, {0, 100, 10, 110, 1, 101, 11, 111, 2, 102, 12, 112}));
}
