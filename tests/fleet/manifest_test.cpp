// Manifests as people write them, and what is wrong with some.

#include "libchar/fleet/manifest.hpp"

#include <catch2/catch.hpp>

#include "libchar/core/error.hpp"
#include "tests/fleet/fleet_folder.hpp"

using namespace libchar;
using Catch::Contains;

namespace {

std::string refusal(const std::string& text, const std::string& path = "line7.yaml") {
  try {
    parse_manifest(text, path);
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

const std::string kHead = "format: fleet-manifest\nversion: 1\n";

}  // namespace

TEST_CASE("a manifest: defaults, what an entry sets over them, paths from its folder") {
  const Manifest m =
      parse_manifest(kHead +
                         "defaults: {type: imu-x, batch: b1, limits: sheet.yaml, options: {reading: {rate_hz: 200}}}\n"
                         "devices:\n"
                         "  - {device: A01, log: a/01.npy, temperature_c: 25}\n"
                         "  - {log: /logs/02.npy, batch: b2, options: {reading: {rate_hz: 100}}}\n"
                         "  - {device: A03, log: ../c.csv, options: {reading: {rate_hz: 200}}}\n",
                     "/fleet/line7.yaml");
  REQUIRE(m.devices.size() == 3);
  CHECK(m.devices[0].log == "/fleet/a/01.npy");
  CHECK(m.devices[0].type == "imu-x");
  CHECK(m.devices[0].limits == "/fleet/sheet.yaml");
  CHECK(m.devices[0].temperature_c == 25);
  CHECK(m.devices[1].device == "02");
  CHECK(m.devices[1].batch == "b2");
  CHECK_FALSE(m.devices[1].temperature_c);
  CHECK(m.devices[2].log == "/c.csv");
  // The options of the first and the third are the same ones.
  CHECK(m.options.size() == 2);
  CHECK(m.options[m.devices[0].options].reading.rate_hz == 200);
  CHECK(m.options[m.devices[1].options].reading.rate_hz == 100);
  CHECK(m.devices[2].options == m.devices[0].options);
}

TEST_CASE("a table is a manifest too: commas or semicolons, quotes, empty cells, comments") {
  const Manifest m = parse_manifest(
      "\xEF\xBB\xBF"
      "device;log;batch;temperature_c\r\n# line 7\r\n\"A;1\";a.csv;b1;21.5\r\n\r\nA2;b.csv;;\r\n",
      "/fleet/line7.csv");
  REQUIRE(m.devices.size() == 2);
  CHECK(m.devices[0].device == "A;1");
  CHECK(m.devices[0].temperature_c == 21.5);
  CHECK(m.devices[0].where == "/fleet/line7.csv:3:1");
  CHECK(m.devices[1].log == "/fleet/b.csv");
  CHECK(m.devices[1].batch.empty());
}

TEST_CASE("tables are separated by tabs too, and their quotation marks are doubled") {
  const Manifest m = parse_manifest(
      "device\tlog\ttype\nA, 1\ta.csv\t\n \"A \"\"1\"\", x\" \t\"C:\\b.csv\"\t5\" gauge\n", "/fleet/line7.tsv");
  REQUIRE(m.devices.size() == 2);
  CHECK(m.devices[0].device == "A, 1");
  CHECK(m.devices[1].device == "A \"1\", x");
  CHECK(m.devices[1].log == "/fleet/C:\\b.csv");
  CHECK(m.devices[1].type == "5\" gauge");
  const Manifest commas = parse_manifest("\"device\",log\n\"A \"\"1\"\", x\",a.csv\n\"\"\"\",b.csv\n", "/t.CSV");
  CHECK(commas.devices[0].device == "A \"1\", x");
  CHECK(commas.devices[1].device == "\"");
}

TEST_CASE("heads of a table are refused where they stand") {
  CHECK_THAT(refusal("# line 7\nDevice,Log\nA,a.csv\n", "t.csv"),
             Contains("t.csv:2:1") && Contains("Device") && Contains("did you mean device?"));
  CHECK_THAT(refusal("device\tfile\nA\ta.csv\n", "t.tsv"),
             Contains("t.tsv:1:1") && Contains("file") && Contains("device, log, type"));
  CHECK_THAT(refusal("device,batch\nA,b\n", "t.csv"), Contains("t.csv:1:1") && Contains("columns.log is missing"));
}

TEST_CASE("what is wrong with a manifest is said with its place") {
  CHECK_THAT(refusal("format: scene\nversion: 1\n"), Contains("fleet-manifest"));
  CHECK_THAT(refusal(kHead + "devices:\n  - {device: A, lgo: a.csv}\n"),
             Contains("line7.yaml:4") && Contains("lgo") && Contains("log"));
  CHECK_THAT(refusal(kHead + "devices:\n  - {device: A}\n"), Contains("log"));
  CHECK_THAT(refusal(kHead + "devices: []\n"), Contains("no device"));
  CHECK_THAT(refusal(kHead + "devices:\n  - {log: a.csv, temperature_c: hot}\n"),
             Contains("temperature_c") && Contains("line7.yaml:4"));
  CHECK_THAT(refusal(kHead + "devices:\n  - {log: a.csv, options: {reading: {rate: 5}}}\n"), Contains("rate"));
  CHECK_THAT(refusal("device,log\nA,a.csv,3\n", "t.csv"), Contains("t.csv:2:1: error E0781: 3 cells under 2 heads"));
  CHECK_THAT(refusal("device,log,log\n", "t.csv"), Contains("t.csv:1:1") && Contains("is repeated"));
  CHECK_THAT(refusal("device,log\nA,\xE4.csv\n", "t.csv"), Contains("UTF-8") && Contains("t.csv:2"));
  CHECK_THAT(refusal("device,log\n\"A,a.csv\n", "t.csv"), Contains("not closed"));
  CHECK_THAT(refusal("device,log,temperature_c\nA,a.csv,25 °C\n", "t.csv"),
             Contains("write the number alone: it is in °C"));
  CHECK_THAT(refusal("- {device: A, log: a.csv}\n"),
             Contains("a fleet-manifest file begins with \"format: fleet-manifest\""));
  CHECK_THAT(refusal("device,log,temperature_c\nA,a.csv,warm\n", "t.csv"), Contains("t.csv:2"));
}

TEST_CASE("logs alone are devices called as their files are, by folders too where two are alike") {
  const Manifest m = manifest_of_logs({"a/x.csv", "b/x.csv", "c/y.csv"});
  CHECK(m.devices[0].device == "a/x.csv");
  CHECK(m.devices[1].device == "b/x.csv");
  CHECK(m.devices[2].device == "y");
}

TEST_CASE("a pattern that no shell has taken apart stands for its files, in order") {
  const test::TemporaryFolder folder;
  const auto logs = test::write_logs(folder.path(), 3, 2);
  const std::string pattern = (folder / "d?.csv").string();
  const Manifest m = manifest_of_logs({pattern});
  REQUIRE(m.devices.size() == 3);
  for (std::size_t k = 0; k < 3; ++k) CHECK(m.devices[k].log == logs[k]);
  CHECK_THROWS_WITH(manifest_of_logs({logs[0], (folder / "e*.csv").string()}),
                    Contains("no file matches this pattern") && Contains("e*.csv"));
  test::write_file(folder / "m.yaml", kHead + "devices: [{log: d0.csv}]\n");
  CHECK_THROWS_WITH(manifest_of_logs({logs[0], (folder / "m.yaml").string()}),
                    Contains("E0205") && Contains("m.yaml") && Contains("one manifest, or logs"));
}

TEST_CASE("which tables are manifests, and which are logs") {
  const test::TemporaryFolder folder;
  const auto is = [&](const std::string& text) {
    test::write_file(folder / "t.csv", text);
    return is_manifest((folder / "t.csv").string());
  };
  CHECK(is("log\na.csv\n"));
  CHECK(is("device;log;batch\nA;a.csv;b\n"));
  CHECK(is("# line 7\n\"device\",\"log\",temprature\nA,a.csv,3\n"));
  CHECK(is("Device,Log\nA,a.csv\n"));
  CHECK(is("device,file\nA,a.csv\n"));
  CHECK(is("DEVICE\tLOGS\tBatch\nA\ta.csv\tb\n"));
  CHECK(is("device,log,log\nA,a.csv,b.csv\n"));
  CHECK(is("device,lgo\nA,a.csv\n"));
  CHECK(is("devices,log,type\nA,a.csv\n"));
  CHECK_FALSE(is("t,log\n0,1\n"));
  CHECK_FALSE(is("time,lat,lon\n2026-11-25T10:00:00,48.1,11.6\n"));
  CHECK_FALSE(is("timestamp,device,x,y,z\n0,phone,1,2,3\n"));
  CHECK_FALSE(is("t,logger\n0,1\n"));
  CHECK_FALSE(is("t,x,log\n0,1,2\n"));
  CHECK_FALSE(is("0.1,0.2\n0.3,0.4\n"));
  CHECK_FALSE(is(""));
  const auto named = [&](const std::string& name, const std::string& text) {
    test::write_file(folder / name, text);
    return is_manifest((folder / name).string());
  };
  CHECK(named("list.yaml", "- {device: A, log: a.csv}\n"));
  CHECK(named("empty.YML", ""));
  CHECK(is_manifest((folder / "absent.yaml").string()));
  CHECK(named("line.tsv", "device\tlog\nA\ta.csv\n"));
  CHECK_FALSE(named("metadata.yaml", "rosbag2_bagfile_information:\n  version: 4\n"));
}
