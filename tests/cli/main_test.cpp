// The program as a whole: exit codes, streams, help, slips.

#include <catch2/catch.hpp>
#include <fstream>

#include "tests/support/places.hpp"
#include "tests/support/run.hpp"

using Catch::Contains;

namespace {
std::size_t lines(const std::string& text) {
  return static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n'));
}
}  // namespace

TEST_CASE("help and version go to stdout with exit code 0") {
  for (const char* flag : {"--help", "-h", "--version"}) {
    const auto ran = test::run({flag});
    CHECK(ran.code == 0);
    CHECK(ran.err.empty());
    CHECK_FALSE(ran.out.empty());
  }
  CHECK_THAT(test::run({"--help"}).out, Contains("inspect") && Contains("convert"));
  CHECK_THAT(test::run({"inspect", "--help"}).out,
             Contains("--time-unit") && Contains("auto|s|ms|us|ns") && Contains("default: auto"));
}

TEST_CASE("one processor: nothing but the result, and the same") {
  const test::TemporaryFolder folder;
  const std::string table = test::fixture("imu_at_rest.csv").string();
  const std::string log = (folder / "log.npy").string();
  REQUIRE(test::run({"convert", table, "-o", log}).code == 0);
  for (const std::string verb : {"inspect", "allan", "psd", "fit"})
    for (const std::string& file : {log, table}) {
      INFO(verb << " " << file);
      const auto all = test::run({verb, file});
      const auto one = test::run_words(
          {"/bin/sh", "-c",
           "taskset -c $(taskset -cp $$ | sed 's/.*: //; s/[,-].*//') " + test::program() + " " + verb + " " + file});
      CHECK(one.code == all.code);
      CHECK(one.err == all.err);
      CHECK(one.out == all.out);
    }
}

TEST_CASE("closed streams: no message gets into a file that is written") {
  const test::TemporaryFolder folder;
  std::ofstream(folder / "log.csv") << "t,x\n0,1\n1,\n2,3\n2,4\n3,5\n4,6\n";
  const std::string at = folder.path().string();
  const auto convert = [&](const std::string& out, const std::string& closed) {
    return test::run_words(
        {"/bin/sh", "-c", test::program() + " convert " + at + "/log.csv -o " + at + "/" + out + closed});
  };
  REQUIRE(convert("open.csv", "").err.find("warning") != std::string::npos);
  for (const char* closed : {" >&- 2>&-", " 2>&-", " <&- >&- 2>&-", " <&-"}) {
    convert("closed.csv", closed);
    CHECK(test::slurp(folder / "closed.csv") == test::slurp(folder / "open.csv"));
    std::filesystem::remove(folder / "closed.csv");
  }
}

TEST_CASE("slips on the command line are exit code 2, one line on stderr, with the nearest right word") {
  struct Slip {
    std::vector<std::string> arguments;
    std::string says;
  };
  const std::string log = test::fixture("imu_at_rest.csv").string();
  const std::vector<Slip> slips = {{{}, "which verb?"},
                                   {{"inspcet", "a.csv"}, "did you mean inspect?"},
                                   {{"--verison"}, "did you mean --version?"},
                                   {{"folder/absent.csv"}, "no verb and no file has this name"},
                                   {{"inspect"}, "LOG is required"},
                                   {{"inspect", "a.csv", "--time-unt", "s"}, "did you mean --time-unit?"},
                                   {{"inspect", "a.csv", "--time-unit", "sec"}, "expected one of auto, s, ms, us, ns"},
                                   {{"inspect", "a.csv", "--rate", "nan"}, "--rate"},
                                   {{"inspect", "a.csv", "--rate", "-1"}, "--rate"},
                                   {{"inspect", "a.csv", "--rate", "1e400"}, "--rate"},
                                   {{"inspect", "a.csv", "--rate", "010"}, "got \"010\""},
                                   {{"inspect", "a.csv", "--from", "3 parsecs"}, "a duration such as"},
                                   {{"inspect", "a.csv", "--skip-rows", "-1"}, "expected a whole number"},
                                   {{"inspect", "a.csv", "--threads", "1e3"}, "expected a whole number"},
                                   {{"inspect", "a.csv", "--delimiter", "abc"}, "one character"},
                                   {{"convert", "a.csv"}, "--output is required"},
                                   {{"convert", "a.csv", "b.csv", "-o", "c.csv"}, "one argument too many"},
                                   {{"convert", log, log, "-o", "c.csv"}, "go into a folder of their own"}};
  for (const Slip& slip : slips) {
    const auto ran = test::run(slip.arguments);
    INFO(slip.says << " <- " << ran.err);
    CHECK(ran.code == 2);
    CHECK(ran.out.empty());
    CHECK(lines(ran.err) == 1);
    CHECK_THAT(ran.err, Contains(slip.says));
  }
}

TEST_CASE("a file in the place of the verb is inspected") {
  const std::string file = test::fixture("npy/c_order.npy").string();
  const auto ran = test::run({file, "--rate", "10Hz"});
  CHECK(ran.code == 0);
  CHECK(ran.out == test::run({"inspect", file, "--rate", "10Hz"}).out);
}

TEST_CASE("a missing input is exit code 3, a full output exit code 5") {
  const auto missing = test::run({"inspect", "/nowhere/a.csv"});
  CHECK(missing.code == 3);
  CHECK(lines(missing.err) == 1);
  test::RunOptions full;
  full.stdout_path = "/dev/full";
  CHECK(test::run({"inspect", test::fixture("npy/c_order.npy").string()}, full).code == 5);
  CHECK(test::run({"--help"}, full).code == 5);
}

TEST_CASE("control characters in a file name do not reach the terminal") {
  const auto ran = test::run({"inspect", "/nowhere/\x1b[31mred\x07.csv"});
  CHECK(ran.code == 3);
  CHECK(ran.err.find('\x1b') == std::string::npos);
  CHECK(ran.err.find('\x07') == std::string::npos);
}

TEST_CASE("a reader that goes away is no failure") {
  const std::string log = test::fixture("npy/c_order.npy").string();
  const auto ran =
      test::run_words({"bash", "-c", "set -o pipefail; \"$0\" inspect \"$1\" --json | true", test::program(), log});
  CHECK(ran.code == 0);
  CHECK(ran.err.empty());
}

TEST_CASE("a log from another program, by the shell's <(…), is read as text") {
  const test::TemporaryFolder folder;
  const std::string log = (folder / "log.csv").string(), out = (folder / "out.csv").string();
  {
    std::ofstream file(log);
    file << "t,x\n";
    for (int i = 0; i < 3000; ++i) file << 0.01 * i << ',' << (i * i) % 1009 << '\n';
  }
  for (const char* script : {R"("$0" inspect <(cat "$1") >/dev/null)", R"("$0" convert <(cat "$1") -o "$2" --quiet)",
                             R"("$0" characterize <(cat "$1") -o "$2.report" --quiet >/dev/null)"}) {
    const auto ran = test::run_words({"bash", "-c", script, test::program(), log, out});
    INFO(script << ran.err);
    CHECK(ran.code == 0);
  }
  std::ifstream written(out);
  std::string text((std::istreambuf_iterator<char>(written)), {});
  CHECK(std::count(text.begin(), text.end(), '\n') == 3001);
}

TEST_CASE("stopped by a signal: exit code 128 + signal and no output file") {
  const test::TemporaryFolder folder;
  // With data the reading succeeds and writing must still not happen; without, the reading fails
  // because it was stopped.
  const std::string script =
      R"("$0" convert - -o "$1" < "$2" & pid=$!; exec 3> "$2"; printf "$3" >&3; sleep 0.3; kill -TERM $pid; exec 3>&-; wait $pid)";
  const std::string fifo = (folder / "pipe").string();
  const std::string out = (folder / "out.npy").string();
  for (const char* data : {"x\\n", "x\\n1\\n2\\n"}) {
    const auto ran =
        test::run_words({"bash", "-c", "rm -f \"$2\"; mkfifo \"$2\"; " + script, test::program(), out, fifo, data});
    INFO(ran.err);
    CHECK(ran.code == 143);
    CHECK_FALSE(std::filesystem::exists(out));
  }
}

TEST_CASE("a verb of two words: joined, listed where the second is missing, with help") {
  CHECK(test::run({"fleet", "plan", "--help"}).out == test::run({"fleet-plan", "--help"}).out);
  CHECK(test::run({"help", "fleet", "run"}).out == test::run({"fleet-run", "--help"}).out);
  const test::Ran alone = test::run({"fleet"});
  CHECK(alone.code == 2);
  CHECK_THAT(alone.err, Catch::Contains("plan, run, status, merge, export, compare"));
  CHECK_THAT(test::run({"fleet", "pln"}).err, Catch::Contains("did you mean fleet plan?"));
  for (const std::vector<std::string>& words :
       {std::vector<std::string>{"fleet", "--help"}, {"help", "fleet"}, {"fleet", "help"}}) {
    const test::Ran page = test::run(words);
    CHECK(page.code == 0);
    CHECK_THAT(page.out, Catch::Contains("Usage: sensorchar fleet VERB") && Catch::Contains("fleet merge") &&
                             !Catch::Contains("inspect"));
  }
  CHECK(test::run({"fleet", "help", "run"}).out == test::run({"fleet", "run", "--help"}).out);
  // As it is typed: in usage, in hints, in documents.
  CHECK_THAT(test::run({"--help"}).out, Catch::Contains("fleet merge"));
  CHECK_THAT(test::run({"fleet", "run", "--help"}).out, Catch::Contains("Usage: sensorchar fleet run ["));
  CHECK_THAT(test::run({"fleet", "run"}).err, Catch::Contains("sensorchar fleet run: error E0205") &&
                                                  Catch::Contains("hint: sensorchar fleet run --help"));
  const test::TemporaryFolder folder;
  const std::string fleet = (folder / "F").string(), log = (folder / "a.csv").string();
  std::ofstream(log) << "t[s],x\n0,1\n1,2\n2,1\n";
  const test::Ran planned = test::run({"fleet", "plan", log, "-o", fleet, "--json"});
  CHECK(planned.code == 0);
  CHECK_THAT(planned.out, Catch::Contains("\"fleet\",\n    \"plan\","));
}
