#include <catch2/catch.hpp>
#include <cmath>
#include <cstring>
#include <fstream>
#include <nlohmann/json.hpp>

#include "libchar/core/document/document.hpp"
#include "libchar/core/error.hpp"
#include "libchar/log/binary/number_type.hpp"
#include "libchar/log/binary/sidecar.hpp"
#include "libchar/log/read.hpp"
#include "tests/support/rows.hpp"
#include "tests/support/shared.hpp"

using namespace libchar;
using ColumnValues = std::vector<double>;

namespace {

// A raw file of bytes with its sidecar text.
struct Raw {
  test::TemporaryFolder folder;
  std::string path;
  Raw(const std::string& bytes, const std::string& sidecar, const std::string& suffix = ".json")
      : path((folder / "x.bin").string()) {
    std::ofstream(path, std::ios::binary) << bytes;
    std::ofstream(path + suffix, std::ios::binary) << sidecar;
  }
  test::Rows read(const ReadOptions& options = {}) const { return test::read_rows("raw", path, options); }
};

std::string said(const std::string& sidecar, bool json = true) {
  try {
    parse_sidecar(sidecar, "x.json", json);
    return "accepted";
  } catch (const Error& error) {
    return error.what();
  }
}

}  // namespace

TEST_CASE("interleaved and planar, little and big, integers with scale and offset") {
  const std::string little("\x01\x00\xFF\xFF\x02\x00\x00\x80\x03\x00\xFF\x7F", 12),
      big("\x00\x01\xFF\xFF\x00\x02\x80\x00\x00\x03\x7F\xFF", 12);
  const std::string planar("\x01\x00\x02\x00\x03\x00\xFF\xFF\x00\x80\xFF\x7F", 12);
  const std::string tail =
      R"(", "rate_hz": 10, "channels": [{"name": "a", "unit": "deg/s", "scale": 0.5, "offset": 1}, {"name": "b"}])";
  for (const Raw& raw : {Raw(little, R"({"dtype": "i16", "endian": "little)" + tail + "}"),
                         Raw(big, R"({"dtype": "i16", "endian": "big)" + tail + "}"),
                         Raw(planar, R"({"dtype": "i16", "endian": "little)" + tail + R"(, "order": "planar"})")}) {
    const auto got = raw.read();
    CHECK(got.columns == std::vector<ColumnValues>{{1.5, 2, 2.5}, {-1, -32768, 32767}});
    CHECK(got.info.channels[0].unit == "deg/s");
    CHECK_FALSE(got.info.channels[0].integer);
    CHECK(got.info.channels[1].integer);
    CHECK(got.info.time.rate_hz == 10);
    CHECK(got.warnings.empty());
    for (std::size_t bytes = 1; bytes < 20; ++bytes) {
      ReadOptions options;
      options.block_bytes = bytes;
      options.channels = {"b"};
      const auto part = raw.read(options);
      CHECK(part.columns == std::vector<ColumnValues>{{-1, -32768, 32767}});
      CHECK(part.sha256 == got.sha256);
    }
  }
}

TEST_CASE("the time channel has its scale and offset, too") {
  const std::string ticks("\x00\x00\x01\x00\x64\x00\x02\x00\xC8\x00\x03\x00",
                          12);  // 0, 100, 200 beside 1, 2, 3
  const auto stamps = [&](const std::string& time, const ReadOptions& options = {}) {
    const std::string front = R"({"dtype": "i16", "endian": "little", "channels": [)";
    return Raw(ticks, front + time + R"(, {"name": "a"}]})").read(options);
  };
  using Stamps = std::vector<std::int64_t>;
  // Whole nanoseconds a tick, a fraction of one, and offsets of both kinds.
  CHECK(stamps(R"({"name": "t", "unit": "s", "scale": 0.0001})").time_ns == Stamps{0, 10000000, 20000000});
  CHECK(stamps(R"({"name": "t", "unit": "ns", "scale": 30.517578125, "offset": 0.25})").time_ns ==
        Stamps{0, 3052, 6104});
  CHECK(stamps(R"({"name": "t", "unit": "us", "offset": 5})").time_ns == Stamps{5000, 105000, 205000});
  // Stamps since 1970 beyond what a double holds stay exact.
  CHECK(stamps(R"({"name": "t", "unit": "ns", "offset": 1403636579758555392})").time_ns[2] ==
        1403636579758555392 + 200);
  // A unit is guessed from the time, not from the ticks, and a named column is scaled as well.
  const auto guessed = stamps(R"({"name": "t", "scale": 0.0001})");
  CHECK(guessed.info.time.unit == "s");
  CHECK(guessed.time_ns == Stamps{0, 10000000, 20000000});
  ReadOptions named;
  named.time_column = "clock";
  CHECK(stamps(R"({"name": "clock", "unit": "s", "scale": 0.01})", named).time_ns == Stamps{0, 1000000000, 2000000000});
  CHECK_THROWS_WITH(stamps(R"({"name": "t", "unit": "s", "scale": 1e9})"), Catch::Contains("E0314"));
}

TEST_CASE("a YAML sidecar says the same as a JSON one") {
  const std::string bytes("\x00\x00\x80\x3F\x00\x00\x00\x40", 8);
  const Raw yaml(bytes,
                 "# my rig\ndtype: f32\nendian: little\nrate_hz: 200.0\nt0_ns: 1403636579758555392\nchannels:\n  - "
                 "{name: gyro_x, unit: deg/s}\n  - name: \"010\"\n",
                 ".yaml");
  const auto got = yaml.read();
  CHECK(got.columns == std::vector<ColumnValues>{{1}, {2}});
  CHECK(got.info.channels[1].name == "010");
  CHECK(got.info.time.start_ns == 1403636579758555392);
  CHECK(read_recording(yaml.path).info.time.rate_hz == 200);
}

TEST_CASE("rows, trailing bytes and truncation") {
  const std::string four(32, '\x3F');
  const std::string front = R"({"dtype": "f64", "endian": "little", "channels": 2)";
  CHECK(Raw(four, front + R"(, "rows": 2})").read().warnings.empty());
  const auto less = Raw(four + "abc", front + R"(, "rows": 1})").read();
  CHECK(less.info.rows == 1);
  CHECK(less.warnings.find("trailing_bytes")->count == 19);
  CHECK_THROWS_WITH(Raw(four, front + R"(, "rows": 3})").read(), Catch::Contains("2 of 3 rows present"));
  CHECK_THROWS_WITH(Raw(four.substr(0, 15), front + "}").read(),
                    Catch::Contains("15 bytes are less than one row of 16"));
  CHECK_THROWS_WITH(Raw(four + "abc", front + R"(, "order": "planar"})").read(),
                    Catch::Contains("planes cannot be found"));
}

TEST_CASE("values that would be ordinary in the other byte order are pointed out, tiny ones are not") {
  const auto doubtful = [](const std::vector<double>& values, bool swap) {
    std::string bytes;
    for (const double x : values) {
      char b[8];
      std::memcpy(b, &x, 8);
      for (int i = 0; i < 8; ++i) bytes += swap ? b[7 - i] : b[i];
    }
    return Raw(bytes, R"({"dtype": "f64", "endian": "little", "channels": 1})")
               .read()
               .warnings.find("implausible_magnitude") != nullptr;
  };
  CHECK(doubtful({1, 2, 3, -4.5}, true));
  CHECK(doubtful({0.001, 2.5, 100, 1024}, true));
  CHECK_FALSE(doubtful({1e-310, 3e-312, 7e-315}, false));
  CHECK_FALSE(doubtful({0, 0, 0}, true));
  CHECK_FALSE(doubtful({1, 2, 3}, false));
}

TEST_CASE("single floats in the other byte order are told as well") {
  const auto swapped = [](const std::vector<float>& values) {
    std::vector<double> other;
    for (const float x : values) {
      char b[4];
      std::memcpy(b, &x, 4);
      std::swap(b[0], b[3]);
      std::swap(b[1], b[2]);
      float y = 0;
      std::memcpy(&y, b, 4);
      other.push_back(static_cast<double>(y));
    }
    return other;
  };
  CHECK(looks_byte_swapped(swapped({1, 2, 3, -4.5F}), NumberType::f32));
  CHECK(looks_byte_swapped(swapped({0.001F, 2.5F, 100, 1024}), NumberType::f32));
  CHECK_FALSE(looks_byte_swapped(std::vector<double>{1, 2, 3, -4.5}, NumberType::f32));
  CHECK_FALSE(looks_byte_swapped(swapped({1, 2, 3}), NumberType::i32));
}

TEST_CASE("a block keeps to its bytes, stamps included, and progress is that of the file") {
  for (const bool planar : {false, true}) {
    INFO((planar ? "planar" : "interleaved"));
    const Raw raw(std::string(10 * 16 + 3, '\0'),
                  std::string(R"({"dtype": "i64", "endian": "little", "rows": 10, "channels": )") +
                      R"([{"name": "t", "unit": "s"}, {"name": "a"}], "order": ")" +
                      (planar ? "planar" : "interleaved") + R"("})");
    ReadOptions options;
    options.block_bytes = 64;
    const auto source = find_format("raw")->open(raw.path, options);
    RowBlock block;
    Findings warnings;
    for (const std::size_t rows : {4UL, 8UL}) {
      REQUIRE(source->next(block, warnings));
      CHECK(block.rows == 4);
      CHECK(source->bytes_read() == 16 * rows);
    }
    REQUIRE(source->next(block, warnings));
    CHECK(block.rows == 2);
    CHECK(source->bytes_read() == source->bytes_total());
    CHECK_FALSE(source->next(block, warnings));
  }
}

TEST_CASE("a missing sidecar is answered with one to copy, two are one too many") {
  const test::TemporaryFolder folder;
  std::ofstream(folder / "x.f64") << std::string(16, 'a');
  CHECK_THROWS_WITH(test::read_rows("raw", folder / "x.f64"), Catch::Contains("no sidecar") &&
                                                                  Catch::Contains(R"(write )") &&
                                                                  Catch::Contains("x.f64.json, such as"));
  CHECK(parse_sidecar(minimal_sidecar(), "x", true).channels.size() == 3);
  std::ofstream(folder / "x.f64.json") << minimal_sidecar();
  std::ofstream(folder / "x.f64.yml") << minimal_sidecar();
  CHECK_THROWS_WITH(test::read_rows("raw", folder / "x.f64"), Catch::Contains("two sidecars"));
}

TEST_CASE("sidecars are refused with the key at fault") {
  const std::string front = R"({"dtype": "f64", "endian": "little", )";
  CHECK_THAT(said(front + R"("channels": -1})"), Catch::Contains("x.json:1:50") && Catch::Contains("channels:"));
  CHECK_THAT(said(front + R"("channels": 1000000000})"), Catch::Contains("more than the limit of 32768"));
  CHECK_THAT(said(front + R"("channels": []})"), Catch::Contains("empty"));
  CHECK_THAT(said(front + R"("channels": [{"name": "a"}, {"name": "a"}]})"),
             Catch::Contains("channels[1].name") && Catch::Contains("two channels have one name"));
  CHECK_THAT(said(front + R"("channels": [{"name": "a", "scala": 2}]})"), Catch::Contains("did you mean scale?"));
  CHECK_THAT(said(front + R"("channels": [{"name": "a", "scale": 0}]})"), Catch::Contains("scale of 0"));
  CHECK_THAT(said(front + R"("channels": 1, "rate_hz": 0})"),
             Catch::Contains("x.json:1:64") && Catch::Contains("rate_hz:"));
  CHECK_THAT(said(front + R"("channels": 1, "rate_hz": "100"})"), Catch::Contains("rate_hz: expected"));
  CHECK_THAT(said(front + R"("channels": 1, "rate_hz": 1e400})"), Catch::Contains("got \"1e400\""));
  CHECK_THAT(said(front + R"("channels": 1, "offset": -8})"), Catch::Contains("a channel's values"));
  CHECK_THAT(said(front + R"("channels": 1, "rows": 1.5})"), Catch::Contains("rows: expected"));
  CHECK_THAT(said(front + R"("channels": 1, "t0_ns": 18446744073709551615})"), Catch::Contains("t0_ns: expected"));
  CHECK_THAT(said(R"({"dtype": "f64", "channels": 1})"), Catch::Contains("endian: the key is missing"));
  CHECK_THAT(said(R"({"channels": 1})"), Catch::Contains("dtype: the key is missing"));
  CHECK_THAT(said("[1]"), Catch::Contains("map of keys and values"));
  CHECK(said(R"({"dtype": "u8", "channels": 1})") == "accepted");
}

TEST_CASE("a wrong key of a sidecar is named with line and column, in JSON as in YAML") {
  const std::string json = "{\n  \"dtype\": \"u8\",\n  \"chanels\": 1\n}";
  CHECK(said(json) == "x.json:3:3: error E0540: unknown key; got \"chanels\"; hint: did you mean channels?");
  CHECK_THAT(said("dtype: u8\nchanels: 1\n", false), Catch::StartsWith("x.json:2:1: error E0540"));
  CHECK_THAT(said("{\"dtype\": \"u8\",\n \"channels\": [{\"name\": \"a\"},\n  {\"nmae\": \"b\"}]}"),
             Catch::StartsWith("x.json:3:4: error E0540: unknown key in channels[1]"));
  CHECK_THAT(said("{\"dtype\": \"u8\", \"channels\": 1,\n\"order\": \"planer\"}"),
             Catch::StartsWith("x.json:2:10: error E0544"));
}

TEST_CASE("YAML is read without the parts that bite") {
  const auto refused = [](const std::string& text) { return said(text, false); };
  CHECK_THAT(refused("a: &x 1\nb: *x\n"), Catch::Contains("anchors are not read") && Catch::Contains("x.json:1:"));
  CHECK_THAT(refused("a: !!python/object:os.system ls\n"), Catch::Contains("tags are not read"));
  CHECK_THAT(refused("dtype: f64\ndtype: f32\n"), Catch::Contains("repeated") && Catch::Contains("x.json:2:1"));
  CHECK_THAT(refused("<<: {dtype: f64}\n"), Catch::Contains("merge"));
  CHECK_THAT(refused("dtype: f64\n---\ndtype: f32\n"), Catch::Contains("second document"));
  CHECK_THAT(refused(std::string(200, '[')), Catch::Contains("x.json:1:"));
  CHECK_THAT(refused("\tdtype: f64\n"), Catch::Contains("not valid YAML"));
  CHECK_THAT(refused(""), Catch::Contains("empty"));
  const Json node = as_json(parse_yaml_document(
      "a: 010\nb: 0x10\nc: -3\nd: 1.5\ne: .nan\nf: '7'\ng: [1, {h: null}]\ni: 18446744073709551615\n", "x"));
  CHECK(node["a"] == "010");
  CHECK(node["b"] == "0x10");
  CHECK(node["c"] == -3);
  CHECK(node["d"] == 1.5);
  CHECK(node["e"] == ".nan");
  CHECK(node["f"] == "7");
  CHECK(node["g"][1]["h"].is_null());
  CHECK(node["i"] == UINT64_MAX);
}

TEST_CASE("numbers in a sidecar beyond a double are refused as such, with their place") {
  const std::string message = said(R"({"dtype": "f64", "endian": "little", "channels": 1, "rate_hz": 1e400})");
  CHECK_THAT(message, Catch::Contains("E0602") && Catch::Contains("out of range") && Catch::Contains("1e400") &&
                          Catch::Contains(":1:"));
}

TEST_CASE("places of odd values are the first in the order of the rows, whatever blocks they were read in") {
  std::string bytes;
  for (int row = 0; row < 40; ++row)
    for (int column = 0; column < 3; ++column) {
      double value = row + 0.5;
      if (row % 5 == 2 - column) value = std::nan("");
      if (row % 7 == 5 - column) value = HUGE_VAL;
      char raw[sizeof value];
      std::memcpy(raw, &value, sizeof value);
      bytes.append(raw, sizeof value);
    }
  const Raw raw(bytes, R"({"dtype": "f64", "endian": "little", "rate_hz": 10,
                           "channels": [{"name": "a"}, {"name": "b"}, {"name": "c"}]})");
  const auto said_of = [&](std::size_t block) {
    ReadOptions options;
    options.block_bytes = block;
    std::string text;
    const test::Rows rows = test::read_rows("raw", raw.path, options, true);
    for (const Finding& one : rows.warnings.list()) text += one_line(one, "") + "\n";
    return text;
  };
  const std::string whole = said_of(std::size_t{1} << 20U);
  CHECK(whole.find("row 0 ") != std::string::npos);  // of c: a and b have theirs later
  for (const std::size_t block : {std::size_t{1}, std::size_t{50}, std::size_t{200}}) CHECK(said_of(block) == whole);
}

TEST_CASE("the place of rounded integers does not depend on the blocks they were read in") {
  std::string bytes;
  for (std::int64_t row = 0; row < 40; ++row)
    for (std::int64_t column = 0; column < 4; ++column) {
      const std::int64_t value = row < 20 - 3 * column ? row : (std::int64_t{1} << 53U) + 1 + 2 * row;
      char raw[sizeof value];
      std::memcpy(raw, &value, sizeof value);
      bytes.append(raw, sizeof value);
    }
  const Raw raw(bytes, R"({"dtype": "i64", "endian": "little", "rate_hz": 10,
                           "channels": [{"name": "a"}, {"name": "b"}, {"name": "c"}, {"name": "d"}]})");
  for (const std::size_t block : {std::size_t{1}, std::size_t{70}, std::size_t{300}, std::size_t{1} << 20U}) {
    ReadOptions options;
    options.block_bytes = block;
    const test::Rows rows = test::read_rows("raw", raw.path, options, true);
    const Finding* said = rows.warnings.find("rounded_integer");
    REQUIRE(said);
    CHECK(said->count == 20 + 23 + 26 + 29);
    REQUIRE(said->where.rows.size() == 3);
    CHECK(said->where.rows[0].starts_with("row 11 "));  // of d, then c and b
    CHECK(said->where.rows[2].starts_with("row 17 "));
  }
}
