// Every npy and raw case of the shared table of bad inputs: verdict, place, and one line that says what is wrong.

#include <catch2/catch.hpp>
#include <fstream>
#include <map>
#include <sstream>

#include "libchar/core/error.hpp"
#include "tests/support/rows.hpp"
#include "tests/support/shared.hpp"

using namespace libchar;

namespace {

struct Case {
  std::string file, verdict, where, why;
};

std::vector<Case> cases(const std::string& folder) {
  std::ifstream in(test::known("badinputs/EXPECT.tsv"));
  std::vector<Case> all;
  for (std::string line; std::getline(in, line);) {
    std::istringstream cells(line);
    Case c;
    std::getline(cells, c.file, '\t');
    std::getline(cells, c.verdict, '\t');
    std::getline(cells, c.where, '\t');
    std::getline(cells, c.why, '\t');
    if (c.file.rfind(folder + "/", 0) == 0 && !c.file.ends_with(".json")) all.push_back(c);
  }
  return all;
}

// What happened: "ok", "warn", or the message of the error.
std::string outcome(const std::string& format, const std::string& file) {
  try {
    return test::read_rows(format, test::known("badinputs/" + file), {}, true).warnings.empty() ? "ok" : "warn";
  } catch (const Error& error) {
    CHECK(error.problem().kind == ErrorKind::input);
    CHECK(std::string(error.what()).find('\n') == std::string::npos);
    CHECK_FALSE(error.problem().what.empty());
    return error.what();
  }
}

}  // namespace

TEST_CASE("bad .npy files get the verdict of the table") {
  // "or read by name" and "half or clear error" leave the choice: both are read. Further dimensions are columns.
  const std::map<std::string, std::string> chosen = {
      {"npy/033_structured.npy", "ok"}, {"npy/046_nan_payload.npy", "warn"}, {"npy/021_3d.npy", "ok"}};
  std::size_t count = 0;
  for (const Case& c : cases("npy")) {
    const std::string got = outcome("npy", c.file);
    INFO(c.file << " " << c.why << " -> " << got);
    const std::string expected = chosen.contains(c.file) ? chosen.at(c.file) : c.verdict;
    if (expected == "error")
      CHECK((got != "ok" && got != "warn"));
    else
      CHECK(got == expected);
    if (expected == "error" && c.where != "-") CHECK(got.find("(byte " + c.where) != std::string::npos);
    ++count;
  }
  CHECK(count == 31);
}

TEST_CASE("bad raw files and sidecars get the verdict of the table") {
  std::size_t count = 0;
  for (const Case& c : cases("raw")) {
    const std::string got = outcome("raw", c.file);
    INFO(c.file << " " << c.why << " -> " << got);
    if (c.verdict == "error")
      CHECK((got != "ok" && got != "warn"));
    else
      CHECK(got == c.verdict);
    ++count;
  }
  CHECK(count == 13);
}

TEST_CASE("messages about bad binary files name place, numbers and remedy") {
  const auto says = [](const std::string& format, const std::string& file, const std::string& part) {
    const std::string got = outcome(format, file);
    INFO(file << " -> " << got);
    CHECK(got.find(part) != std::string::npos);
  };
  says("npy", "npy/007_truncated_data.npy", "2 of 4 values present");
  says("npy", "npy/006_hlen_past_eof.npy", "exceeds the file size 68");
  says("npy", "npy/048_npz.npy", "ZIP archive (.npz)");
  says("npy", "npy/042_long_header_60k.npy", "exceeds the limit of 10000");
  says("npy", "npy/010_shape_overflow.npy", "overflow");
  says("npy", "npy/013_shape_negative.npy", "negative");
  says("npy", "npy/034_datetime.npy", "calendar times");
  says("npy", "npy/039_dup_key.npy", "a key is repeated in the header; got \"shape\"");
  says("raw", "raw/007_offset_past_end.f64", "offset of 1000000 bytes lies after the end");
  says("raw", "raw/016_dtype_case.f64", "did you mean f64?");
  says("raw", "raw/019_unknown_key.f64", "did you mean channels?");
  says("raw", "raw/020_dup_key.f64", "repeated");
  says("raw", "raw/021_sidecar_empty.f64", ":1:1");
  says("raw", "raw/022_sidecar_truncated.f64", "json:1:");
}
