// Where results go: existing files, devices, pipes and folders without rights, for every verb that writes.

#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <catch2/catch.hpp>
#include <fstream>

#include "tests/support/run.hpp"

using Catch::Contains;
namespace fs = std::filesystem;

namespace {

constexpr const char* kModel =
    "format: sensor-model\nversion: 1\nunit: V\nrate_hz: 100\nwhite_noise: {value: 1, unit: V·√s}\n";

void write_log(const fs::path& path) {
  std::ofstream file(path);
  file << "t,x\n";
  for (int i = 0; i < 2000; ++i) file << 0.01 * i << ',' << (i * i) % 1009 << '\n';
}

std::size_t entries_of(const fs::path& folder) {
  return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder), {}));
}

struct Writing {
  std::vector<std::string> words;  ///< the last one is the output
  std::string stands;              ///< the file that is in the way, "" = the output
};

// Every verb that writes, with an input that it would refuse too: what stands in the way is told first.
std::vector<Writing> all_verbs(const test::TemporaryFolder& folder) {
  const auto at = [&](const char* name) { return (folder / name).string(); };
  const std::string broken = at("broken.csv"), out = at("out");
  std::ofstream(broken) << "t,x\n0,1\n1,2\n2,oops\n";
  const std::string model = at("m.sensor.yaml");
  std::ofstream(model) << kModel;
  const std::string good = at("good.sensor.yaml");
  std::ofstream(good) << kModel;
  return {{{"allan", broken, "-o", out}, ""},
          {{"psd", broken, "-o", out}, ""},
          {{"fit", broken, "-o", out}, ""},
          {{"fit", broken, "--models", out}, "x.sensor.yaml"},
          {{"characterize", broken, "-o", out}, "report.json"},
          {{"characterize", broken, broken, "--pool", "-o", out}, "runs.json"},
          {{"characterize", broken, "--lot", "-o", out}, "index.html"},
          {{"convert", broken, "-o", out + ".csv"}, ""},
          {{"convert", broken, "-o", out + ".f64"}, ""},
          {{"model", model, "-o", out}, ""},
          {{"model", model, "--to", "kalibr", "-o", out}, ""},
          {{"simulate", good, "--samples", "1000000000000", "-o", out + ".csv"}, ""}};
}

}  // namespace

TEST_CASE("what stands in the way of a result is told before the work is done") {
  const test::TemporaryFolder folder;
  for (const Writing& w : all_verbs(folder)) {
    const fs::path output = w.words.back();
    INFO(w.words[0] << ' ' << output);
    const fs::path stands = w.stands.empty() ? output : output / w.stands;
    fs::create_directories(stands.parent_path());
    std::ofstream(stands) << "old";
    const auto ran = test::run(w.words);
    CHECK(ran.code == 5);
    CHECK_THAT(ran.err, Contains(stands.string() + ": error E0503: exists already"));
    CHECK(test::slurp(stands) == "old");
    fs::permissions(stands, fs::perms(0444));
    std::vector<std::string> forced = w.words;
    forced.emplace_back("--force");
    const auto refused = test::run(forced);
    CHECK(refused.code == 5);
    CHECK_THAT(refused.err, Contains("E0517") && Contains("read-only"));
    CHECK(test::slurp(stands) == "old");
    fs::remove_all(output);
  }
}

TEST_CASE("the option --force keeps a private file private") {
  const test::TemporaryFolder folder;
  const std::string log = (folder / "log.csv").string();
  write_log(log);
  for (const std::vector<std::string>& words : {std::vector<std::string>{"allan", log, "-o"},
                                                {"psd", log, "-o"},
                                                {"fit", log, "-o"},
                                                {"convert", log, "--as", "csv", "-o"}}) {
    const fs::path out = folder / "out.csv";
    std::ofstream(out) << "old";
    fs::permissions(out, fs::perms(0600));
    auto forced = words;
    forced.insert(forced.end(), {out.string(), "--force", "-q"});
    INFO(words[0]);
    CHECK(test::run(forced).code == 0);
    CHECK(test::slurp(out) != "old");
    CHECK(fs::status(out).permissions() == fs::perms(0600));
    fs::remove(out);
  }
}

TEST_CASE("standard output as a file: its bytes go there, and the name stays what it was") {
  const test::TemporaryFolder folder;
  const fs::path log = folder / "log.csv", link = folder / "out.csv", got = folder / "got";
  write_log(log);
  fs::create_symlink("/proc/self/fd/1", link);
  const auto plain = test::run({"allan", log.string()});
  REQUIRE(plain.code == 0);
  test::RunOptions to_file;
  to_file.stdout_path = got.string();
  CHECK(test::run({"allan", log.string(), "-o", link.string(), "--force"}, to_file).code == 0);
  CHECK(test::slurp(got) == plain.out);
  CHECK(fs::is_symlink(link));
  // What is said of the log does not get into the log.
  const auto converted = test::run({"convert", log.string(), "-o", link.string()}, to_file);
  CHECK(converted.code == 0);
  CHECK_THAT(converted.err, Contains("2000 rows"));
  CHECK_THAT(test::slurp(got), Catch::StartsWith("t[s],x\n0,0\n") && !Contains("rows"));
  CHECK(entries_of(folder.path()) == 3);
  // Into a pipe, .npy too: what it says at its beginning is right.
  const auto piped = test::run_words(
      {"bash", "-c",
       "\"$0\" convert \"$1\" --as npy -q -o /dev/stdout | cat > \"$2\" && \"$0\" inspect \"$2\" --rate 100",
       test::program(), log.string(), (folder / "p.npy").string()});
  CHECK_THAT(piped.out, Contains("1 channel, 100 Hz (given), 20 s"));
}

TEST_CASE("files beside a pipe or device have no place") {
  const test::TemporaryFolder folder;
  const fs::path log = folder / "log.csv", link = folder / "out.f64", model = folder / "m.sensor.yaml";
  write_log(log);
  std::ofstream(model) << kModel;
  fs::create_symlink("/proc/self/fd/1", link);
  const auto raw = test::run({"convert", log.string(), "-o", link.string()});
  CHECK(raw.code == 5);
  CHECK_THAT(raw.err, Contains("E0518") && Contains("sidecar"));
  const auto scene = test::run({"simulate", model.string(), "--samples", "5", "--as", "csv", "-o", link.string()});
  CHECK(scene.code == 2);
  CHECK_THAT(scene.err, Contains("--no-scene"));
  CHECK(entries_of(folder.path()) == 3);
}

TEST_CASE("folders without rights are one sentence for every verb, none an internal error") {
  // Rights do not bind an administrator; a loop of links is refused to everybody.
  const test::TemporaryFolder folder;
  fs::create_symlink("loop", folder / "loop");
  const fs::path log = folder / "log.csv";
  write_log(log);
  const std::string loop = (folder / "loop").string(), inside = loop + "/x", file = log.string();
  for (const std::vector<std::string>& words : std::vector<std::vector<std::string>>{
           {"inspect", inside},
           {"allan", file, "-o", inside},
           {"psd", file, "-o", inside},
           {"fit", file, "-o", inside},
           {"fit", file, "--models", inside},
           {"characterize", file, "-o", inside},
           {"characterize", file, "-o", loop},
           {"characterize", file, "-o", (folder / "r").string(), "--limits", inside},
           {"convert", file, "-o", inside + ".csv"},
           {"convert", inside, "-o", (folder / "r.csv").string()},
           {"model", inside},
           {"simulate", inside, "-o", (folder / "r.csv").string()},
           {"replay", inside, "-o", (folder / "r").string()},
           {"replay", file, "--sensors", "x", "--models", inside, "-o", (folder / "r").string()},
           {"compare", inside, loop},
           {"fuse", file, "--with", inside, "-o", (folder / "r.csv").string()},
           {"fuse", file, "--with", loop, "-o", (folder / "r.csv").string()}}) {
    const auto ran = test::run(words);
    INFO(words[0] << ' ' << words[1] << ": " << ran.err);
    CHECK((ran.code == 2 || ran.code == 3 || ran.code == 5));
    CHECK_THAT(ran.err, Contains(": error E") && !Contains("internal"));
    CHECK(std::count(ran.err.begin(), ran.err.end(), '\n') == 1);
  }
  CHECK(entries_of(folder.path()) == 2);
}

TEST_CASE("stopped between two logs: the first report is whole, and the message does not deny it") {
  const test::TemporaryFolder folder;
  const fs::path log = folder / "a.csv", pipe = folder / "b.csv", out = folder / "out";
  write_log(log);
  REQUIRE(::mkfifo(pipe.c_str(), 0600) == 0);
  const std::string script =
      R"("$0" characterize "$1" "$2" -o "$3" >/dev/null & pid=$!
exec 3> "$2"
while [ ! -e "$3/a/report.json" ]; do sleep 0.02; done
printf 't,x\n0,1\n1,2\n' >&3
kill -TERM $pid; sleep 0.1; exec 3>&-; wait $pid)";
  const auto ran = test::run_words({"bash", "-c", script, test::program(), log.string(), pipe.string(), out.string()});
  INFO(ran.err);
  CHECK(ran.code == 143);
  CHECK_THAT(ran.err, Contains("stopped; what had been written before is whole"));
}

TEST_CASE("closed streams: every verb that writes gives the same bytes, no message among them") {
  const test::TemporaryFolder folder;
  const fs::path log = folder / "log.csv";
  write_log(log);
  std::ofstream(log, std::ios::app) << "20,5\n20,6\n20.01,\n";  // for warnings and notes
  std::ofstream(folder / "m.sensor.yaml") << kModel;
  const std::string at = folder.path().string(), program = test::program();
  std::string array = "t[s],a[V],b[V],c[V]\n";
  for (int k = 0; k < 400; ++k)
    array += fmt::format("{}.{:02},{},{},{}\n", k / 100, k % 100, k % 7, k % 7 + k % 3, k % 7 + k % 5);
  std::ofstream(folder / "array.csv") << array;
  test::run_words(
      {program, "replay", (folder / "array.csv").string(), "--sensors", "a,b,c", "-o", (folder / "learnt").string()});
  for (const auto& [words, file] : std::vector<std::pair<std::string, std::string>>{
           {"replay array.csv --sensors a,b,c -o run --no-timing", "run/fusion.yaml"},
           {"fuse array.csv --with learnt --algorithm mean -o out.csv", "out.csv"},
           {"allan log.csv -o out.csv", "out.csv"},
           {"psd log.csv -o out.csv", "out.csv"},
           {"fit log.csv -o out.txt", "out.txt"},
           {"convert log.csv -o out.csv", "out.csv"},
           {"convert log.csv -o out.npy", "out.npy"},
           {"characterize log.csv -o out", "out/curves.csv"},
           {"model m.sensor.yaml -o out.txt", "out.txt"},
           {"simulate m.sensor.yaml --samples 100 -o out.csv", "out.csv"}}) {
    const auto bytes = [&, &words = words, &file = file](const std::string& closed) {
      test::run_words({"/bin/sh", "-c", "cd " + at + " && " + program + " " + words + " --force" + closed});
      const std::string text = test::slurp(folder / file);
      fs::remove_all(folder / file);
      return text;
    };
    const std::string open = bytes("");
    INFO(words);
    CHECK_FALSE(open.empty());
    for (const char* closed : {" >&- 2>&-", " <&- >&- 2>&-", " 2>&-"}) CHECK(bytes(closed) == open);
  }
}

TEST_CASE("standard output by -o -: a log goes there as CSV, what is said of it beside it") {
  const test::TemporaryFolder folder;
  const std::string csv = test::fixture("imu_at_rest.csv").string();
  auto ran = test::run({"convert", csv, "--to", "1s", "-o", "-"});
  CHECK(ran.code == 0);
  CHECK_THAT(ran.out, Catch::StartsWith("t[s],gyro_z[deg/s],accel_z[g]\n0,"));
  CHECK_THAT(ran.err, Catch::Contains("/dev/stdout: 50 rows, 2 channels\n"));
  const std::string model = (folder / "gyro.sensor.yaml").string();
  std::ofstream(model) << kModel;
  ran = test::run({"simulate", model, "--duration", "1s", "-o", "-"});
  INFO(ran.err);
  CHECK(ran.code == 0);
  CHECK_THAT(ran.out, Catch::StartsWith("t[s],"));
  CHECK(std::count(ran.out.begin(), ran.out.end(), '\n') == 101);
  ran = test::run({"simulate", model, "--duration", "1s", "-o", "-", "--json"});
  CHECK(ran.code == 2);
  CHECK_THAT(ran.err, Catch::Contains("E0205") && Catch::Contains("standard output takes one document"));
}

TEST_CASE("standard output by -o -: several files do not go there, nor into a folder of that name") {
  const std::string csv = test::fixture("imu_at_rest.csv").string();
  const std::string scene = test::fixture("scenes/lever-arm.yaml").string();
  for (const std::vector<std::string>& command :
       std::vector<std::vector<std::string>>{{"characterize", csv, "-o", "-"},
                                             {"fit", csv, "--models", "-"},
                                             {"replay", scene, "-o", "-"},
                                             {"replay", scene, "--write-scene", "-"},
                                             {"bench", csv, "-o", "-"}}) {
    const auto ran = test::run(command);
    INFO(command.front() << ran.err);
    CHECK(ran.code == 2);
    CHECK_THAT(ran.err, Catch::Contains("E0205") && Catch::Contains("standard output takes one document"));
    CHECK_FALSE(std::filesystem::exists("-"));
  }
}
