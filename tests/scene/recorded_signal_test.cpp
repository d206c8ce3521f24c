#include <catch2/catch.hpp>
#include <fstream>

#include "libchar/core/error.hpp"
#include "libchar/scene/simulated_scene.hpp"
#include "libchar/scene/text/typed_text.hpp"
#include "tests/support/run.hpp"

using namespace libchar;
using Catch::Contains;

namespace {

struct RecordedLog {
  test::TemporaryFolder folder;
  std::string path = (folder / "log.csv").string();
  ArraySimulation simulation;
  Findings warnings;

  RecordedLog() {
    std::ofstream(path) << "t[s],x[deg/s],y[deg/s]\n0,1,5\n0.01,2,6\n0.02,4,7\n";
    simulation.rate_hz = 100;
    simulation.samples = 3;
  }
  SignalSpec read(const std::string& more) {
    SignalSpec signal = parse_signal("recording,file=" + path + more, "`truth`");
    read_recorded_signal(signal, "`truth`", simulation, warnings);
    return signal;
  }
};

}  // namespace

TEST_CASE("a recorded signal is one channel of a log at the simulation's rate") {
  RecordedLog log;
  CHECK(log.read(",channel=y").samples == std::vector<double>{5, 6, 7});
  CHECK(log.warnings.empty());
  log.simulation.samples = 4;
  log.read(",channel=x");
  REQUIRE(log.warnings.find("recorded_signal_short") != nullptr);
  CHECK_THROWS_WITH(log.read(""), Contains("holds 2 channels") && Contains("channel=NAME"));
  log.simulation.rate_hz = 50;
  CHECK_THROWS_WITH(log.read(",channel=x"), Contains("`truth`") && Contains("`rate_hz` 100"));
}

TEST_CASE("a signal of another kind reads no log") {
  RecordedLog log;
  SignalSpec signal = parse_signal("3", "`truth`");
  signal.file = "absent.csv";
  read_recorded_signal(signal, "`truth`", log.simulation, log.warnings);
  CHECK(signal.samples.empty());
}
