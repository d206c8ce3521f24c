#include <catch2/catch.hpp>
#include <fstream>
#include <nlohmann/json.hpp>

#include "libchar/core/document/json.hpp"
#include "tests/support/run.hpp"

using Catch::Contains;

namespace {
std::string fixture(const std::string& name) { return test::fixture("npy/" + name).string(); }
}  // namespace

TEST_CASE("round the formats and back to the same bytes") {
  const test::TemporaryFolder folder;
  const std::string csv = (folder / "a.csv").string(), raw = (folder / "b.f64").string(),
                    npy = (folder / "c.npy").string();
  CHECK(test::run({"convert", fixture("fortran_order.npy"), "--rate", "200Hz", "-o", csv}).code == 0);
  CHECK(test::slurp(csv) ==
        "t[s],c0,c1,c2\n0,0,0.125,0.25\n0.005,0.375,0.5,0.625\n0.01,0.75,0.875,1\n0.015,1.125,1.25,1.375\n");
  CHECK(test::run({"convert", csv, "-o", raw, "--order", "planar", "--endian", "big"}).code == 0);
  CHECK(test::run({"convert", raw, "-o", npy, "-q"}).code == 0);
  // The same doubles behind headers of different length.
  const std::string a = test::slurp(fixture("c_order.npy")), b = test::slurp(npy);
  CHECK(a.substr(a.size() - 96) == b.substr(b.size() - 96));
}

TEST_CASE("convert says what it wrote and what the format cannot keep") {
  const test::TemporaryFolder folder;
  const std::string out = (folder / "a.npy").string();
  const auto ran = test::run({"convert", fixture("structured.npy"), "-c", "gyr_0,acc_1", "-o", out});
  CHECK(ran.code == 0);
  CHECK_THAT(ran.out, Contains("a.npy: 5 rows, 2 channels, "));
  CHECK_THAT(ran.err, Contains("not kept: the sampling rate: read it back with --rate 200"));
  const auto json = test::run({"convert", fixture("structured.npy"), "-o", out, "--force", "--json"});
  const libchar::Json document = libchar::parse_json(json.out, "stdout");
  CHECK(document["format"] == "convert");
  CHECK(document["rows"] == 5);
  CHECK(document["output"][0]["bytes"] == std::filesystem::file_size(out));
}

TEST_CASE("nothing is overwritten unasked, and an input never") {
  const test::TemporaryFolder folder;
  const std::string log = (folder / "a.npy").string(), link = (folder / "link.npy").string();
  std::filesystem::copy_file(fixture("c_order.npy"), log);
  std::filesystem::permissions(log, std::filesystem::perms::owner_write, std::filesystem::perm_options::add);
  std::filesystem::create_symlink(log, link);
  const std::string before = test::slurp(log);
  for (const std::string& same : {log, link, (folder / "./a.npy").string()}) {
    const auto ran = test::run({"convert", log, "-o", same, "--force"});
    CHECK(ran.code == 5);
    CHECK_THAT(ran.err, Contains("is the input itself"));
  }
  std::ofstream(folder / "b.csv") << "mine";
  CHECK(test::run({"convert", log, "-o", (folder / "b.csv").string()}).code == 5);
  CHECK(test::slurp(folder / "b.csv") == "mine");
  CHECK(test::run({"convert", log, "-o", (folder / "b.csv").string(), "--force"}).code == 0);
  CHECK(test::slurp(log) == before);
}

TEST_CASE("the sidecar of the input is safe too") {
  const test::TemporaryFolder folder;
  const std::string raw = (folder / "a.f64").string();
  CHECK(test::run({"convert", fixture("c_order.npy"), "-o", raw}).code == 0);
  const auto ran = test::run({"convert", raw, "--as", "csv", "-o", raw + ".json", "--force"});
  CHECK(ran.code == 5);
}

TEST_CASE("outputs that cannot be: unknown suffix, no folder, no space") {
  const test::TemporaryFolder folder;
  CHECK(test::run({"convert", fixture("c_order.npy"), "-o", (folder / "a.xyz").string()}).code == 2);
  CHECK(test::run({"convert", fixture("c_order.npy"), "-o", (folder / "none/a.csv").string()}).code == 5);
  CHECK(test::run({"convert", fixture("c_order.npy"), "--as", "csv", "-o", "/dev/full", "--force"}).code == 5);
}

TEST_CASE("option --strict leaves no output behind a warning") {
  const test::TemporaryFolder folder;
  const std::string out = (folder / "a.csv").string();
  CHECK(test::run({"convert", fixture("half.npy"), "-o", out, "--strict"}).code == 3);
  CHECK_FALSE(std::filesystem::exists(out));
}

TEST_CASE("a pipe of CSV becomes a file with its final rate") {
  const test::TemporaryFolder folder;
  std::ofstream(folder / "in.csv") << "t[ms],x\n0,1\n5,2\n10,3\n20,5\n";
  test::RunOptions options;
  options.stdin_path = (folder / "in.csv").string();
  for (const char* name : {"out.csv", "out.f64"})
    CHECK(test::run({"convert", "-", "-o", (folder / name).string()}, options).code == 0);
  CHECK(test::slurp(folder / "out.csv") == "t[s],x\n0,1\n0.005,2\n0.01,3\n0.015,\n0.02,5\n");
  CHECK_THAT(test::slurp(folder / "out.f64.json"), Contains("\"rate_hz\": 200.0") && Contains("\"rows\": 5"));
}
