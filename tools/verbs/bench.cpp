// bench [FILE…]: run time against error, of ways to get noise coefficients and of fusion
// algorithms, on models, logs and scenes.

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <utility>

#include "heap_meter.hpp"
#include "help/next.hpp"
#include "libchar/benchmark/bench_document.hpp"
#include "libchar/core/document/document.hpp"
#include "libchar/core/file/output_files.hpp"
#include "libchar/core/numeric/whole.hpp"
#include "libchar/core/refusal.hpp"
#include "libchar/core/text/spelling.hpp"
#include "libchar/core/text/text.hpp"
#include "libchar/fusion/registry.hpp"
#include "libchar/replay/replay.hpp"
#include "libchar/report/compare/comparison_text.hpp"
#include "reading_options.hpp"
#include "verb.hpp"

namespace sensorchar {
namespace {

using namespace libchar;

struct BenchVerb {
  std::vector<std::string> files, parts, methods, algorithms, sweeps;
  std::string folder, against;
  BenchInputOptions inputs;
  std::uint64_t seed = 1, records = 0, runs = 0, samples = 0;
  std::optional<double> target, tau_s, share, rate_hz, tolerance;
  bool quick = false, stress = false, force = false, json = false;

  /// Parts that were not named are done where they are asked of what was given.
  bool wants(const std::string& part) const {
    return parts.empty() || std::find(parts.begin(), parts.end(), part) != parts.end();
  }
};

const std::vector<std::string> kBenchParts = {"characterization", "fusion", "scaling", "design", "stress"};

void check_parts(const BenchVerb& verb) {
  for (const std::string& part : verb.parts)
    if (std::find(kBenchParts.begin(), kBenchParts.end(), part) == kBenchParts.end())
      throw usage_error("E0202", "--parts")
          .says("no such part of a benchmark")
          .got(part)
          .hint(did_you_mean(nearest(part, kBenchParts), first_names(kBenchParts)));
}

/// Before anything is measured: fusion comes late, and a slip must not cost the minutes before it.
void check_algorithms(const BenchVerb& verb) {
  for (const std::string& name : verb.algorithms) fusion::algorithm(name);
  for (const std::string& text : verb.sweeps) parse_sweep(text, "--sweep");
}

/// Is this part done? A part that nothing was given for is left out; how cost grows and what is
/// endured is asked of the program, and not of a file.
bool is_done(const std::string& part, const BenchVerb& verb, const BenchInputs& inputs) {
  if (part == "scaling" || part == "stress") return verb.parts.empty() ? verb.files.empty() : verb.wants(part);
  if (!verb.wants(part)) return false;
  return part == "fusion" ? !inputs.scenes.empty() : !inputs.signals.empty();
}

/// An option of parts that are not done would be passed over.
struct PartOption {
  const char* flag;
  bool given;
  std::vector<std::string> parts;
};

std::vector<PartOption> part_options(const BenchVerb& verb) {
  return {{"--sweep", !verb.sweeps.empty(), {"fusion"}},
          {"--algorithms", !verb.algorithms.empty(), {"fusion"}},
          {"--runs", verb.runs != 0, {"fusion"}},
          {"--methods", !verb.methods.empty(), {"characterization"}},
          {"--samples", verb.samples != 0, {"characterization", "design"}},
          {"--records", verb.records != 0, {"characterization", "design"}},
          {"--target", verb.target.has_value(), {"design"}},
          {"--at", verb.tau_s.has_value(), {"design"}},
          {"--within", verb.share.has_value(), {"design"}},
          {"--instants-rate", verb.rate_hz.has_value(), {"scaling"}}};
}

void check_options_are_used(const BenchVerb& verb, const BenchInputs& inputs) {
  for (const PartOption& option : part_options(verb)) {
    if (!option.given) continue;
    const auto done = [&](const std::string& part) { return is_done(part, verb, inputs); };
    if (std::any_of(option.parts.begin(), option.parts.end(), done)) continue;
    const std::string& part = option.parts.front();
    std::string hint = "add " + part + " to --parts";
    if (verb.parts.empty() && part == "scaling") hint = "--parts " + part;
    if (part != "scaling" && verb.wants(part))
      hint = fmt::format("give a {}, or no files for those that are built in",
                         part == "fusion" ? "scene" : "model or a log");
    throw usage_error("E0205", option.flag)
        .says("it is about {}, which is not done here", fmt::join(option.parts, " and "))
        .hint(hint);
  }
  if (verb.tau_s && !verb.target)
    throw usage_error("E0205", "--at")
        .says("it is the averaging time of a --target, which is missing")
        .hint("--target DEVIATION");
}

// Of the files, or what is built in where there are none. A part that nothing was given for is left out.
BenchInputs inputs_of(Session& session, BenchVerb& verb) {
  BenchInputs out;
  verb.inputs.most_samples = verb.samples != 0 ? verb.samples : verb.quick ? 1U << 15U : 200000U;
  for (const std::string& file : verb.files) add_bench_input(file, verb.inputs, out, session.terminal);
  if (!verb.files.empty()) return out;
  if (verb.wants("characterization") || verb.wants("design")) out.signals = bench_signals(verb.inputs.most_samples);
  if (verb.wants("fusion")) out.scenes = bench_scenes();
  return out;
}

void bench_noise(Session& session, const BenchVerb& verb, const BenchInputs& inputs, BenchReport& report) {
  CharacterizationBenchOptions options;
  options.records = verb.records != 0 ? detail::in_memory(verb.records) : verb.quick ? 12 : 60;
  options.seed = verb.seed;
  options.methods = verb.methods;
  for (const BenchSignal& signal : inputs.signals)
    report.characterization.push_back(bench_characterization(signal, options, session.terminal, heap_meter()));
}

FusionBench bench_scenes_of(Session& session, const BenchVerb& verb, const BenchInputs& inputs) {
  FusionBenchOptions options;
  options.seeds = verb.runs != 0 ? detail::in_memory(verb.runs) : verb.quick ? 3 : 12;
  options.seed = verb.seed;
  options.algorithms = verb.algorithms;
  for (const std::string& text : verb.sweeps) options.sweeps.push_back(parse_sweep(text, "--sweep"));
  return bench_fusion(inputs.scenes, options, session.terminal, heap_meter());
}

ScalingBench bench_growth(Session& session, const BenchVerb& verb) {
  ScalingBenchOptions options;
  options.quick = verb.quick;
  options.seed = verb.seed;
  if (verb.rate_hz) options.rate_hz = *verb.rate_hz;
  return bench_scaling(options, session.terminal, heap_meter());
}

DesignBench bench_needs(Session& session, const BenchVerb& verb, const BenchInputs& inputs) {
  DesignOptions options;
  options.target = verb.target;
  options.tau_s = verb.tau_s.value_or(1);
  options.share = verb.share.value_or(10) / 100;
  options.records = verb.records != 0 ? detail::in_memory(verb.records) : verb.quick ? 12 : 40;
  options.seed = verb.seed;
  if (verb.quick) options.most_samples = 4e5;
  if (verb.samples != 0) options.most_samples = static_cast<double>(verb.samples);
  return bench_design(inputs.signals, options, session.terminal);
}

BenchReport measured(Session& session, const BenchVerb& verb, const BenchInputs& inputs) {
  const MachineWatch watch;
  BenchReport report;
  report.command = session.command;
  report.quick = verb.quick;
  report.seed = verb.seed;
  const auto done = [&](const char* part) { return is_done(part, verb, inputs); };
  if (done("characterization")) bench_noise(session, verb, inputs, report);
  if (done("fusion")) report.fusion = bench_scenes_of(session, verb, inputs);
  if (done("scaling")) report.scaling = bench_growth(session, verb);
  if (done("design")) report.design = bench_needs(session, verb, inputs);
  if (done("stress")) report.stress = bench_stress({verb.quick, verb.seed}, session.terminal);
  report.machine = watch.finish();
  session.terminal.clear();
  return report;
}

void refuse_worse(const BenchChanges& changes, double tolerance, const std::string& older) {
  const std::vector<BenchChange> worse = changes.worse(tolerance);
  if (worse.empty()) return;
  throw Refusal(ErrorKind::check, "E0969", older)
      .says("{} figures are worse than there by more than {} %, the first {}", worse.size(), 100 * tolerance,
            worse[0].what)
      .hint("other work on the machine? run again; --tolerance accepts more");
}

void refuse_wrong(const StressBench& stress) {
  const std::size_t wrong = stress.count(StressOutcome::wrong);
  if (wrong == 0) return;
  const StressCell& first = stress.cells.front();
  throw Refusal(ErrorKind::check, "E0971")
      .says("{} of {} results under stress are wrong, the first: {}, {}: {}", wrong, stress.cells.size(), first.subject,
            first.input, first.what);
}

void run_bench(Session& session, BenchVerb& verb) {
  if (verb.stress) verb.parts.emplace_back("stress");
  check_parts(verb);
  refuse_standard_output("--output", verb.folder);
  const auto foreseen = [&] {
    std::vector<std::string> out;
    for (const char* name : {"bench.html", "bench.json", "bench.md"})
      out.push_back((std::filesystem::path(verb.folder) / name).string());
    return out;
  };
  std::vector<std::string> inputs_named = verb.files;
  if (!verb.against.empty()) inputs_named.push_back(verb.against);
  if (!verb.folder.empty()) foresee_outputs(foreseen(), verb.folder, inputs_named, verb.force);
  const BenchReport older =
      verb.against.empty() ? BenchReport{} : parse_bench_report(read_document_text(verb.against), verb.against);
  check_algorithms(verb);
  const BenchInputs inputs = inputs_of(session, verb);
  check_options_are_used(verb, inputs);
  const BenchReport report = measured(session, verb, inputs);
  if (report.characterization.empty() && !report.fusion && !report.scaling && !report.design && !report.stress)
    throw usage_error("E0205", "--parts")
        .says("nothing to do: models and logs are for characterization, scenes for fusion")
        .hint("other files, or other parts");
  std::optional<BenchChanges> changes;
  if (!verb.against.empty()) changes = bench_changes(older, report, verb.against);
  std::vector<std::string> removed;
  if (!verb.folder.empty())
    removed = write_outputs(bench_files(report, verb.folder, bench_again(session, verb.folder)), verb.folder,
                            inputs_named, verb.force);
  Json document = document_of(bench_fields(), report);
  const double tolerance = verb.tolerance.value_or(5) / 100;
  if (changes) document["against"] = changes_json(*changes, tolerance);
  if (verb.json) {
    print(dump_json(document));
  } else {
    const auto say = [&](const std::string& text) {
      verb.folder.empty() ? print_text(text) : print_beside(session, text);
    };
    say(bench_text(report));
    if (changes) say(changes_text(*changes, tolerance));
    if (!verb.folder.empty()) say(fmt::format("wrote {}\n", fmt::join(foreseen(), " ")));
  }
  if (report.stress) refuse_wrong(*report.stress);
  if (changes) refuse_worse(*changes, tolerance, verb.against);
}

void add_design_options(VerbOptions& options, BenchVerb& verb) {
  options
      .add_number("--target", verb.target, "design: target Allan deviation of the fused sensors, in the models' unit",
                  1e-100, 1e100)
      .value_name("DEVIATION");
  options.add_duration("--at", verb.tau_s, "design: averaging time of that target (default: 1 s)");
  options
      .add_number("--within", verb.share, "design: target uncertainty of a coefficient in percent (default: 10)", 0.01,
                  99)
      .value_name("PERCENT");
  options.add_rate("--instants-rate", verb.rate_hz, "scaling: rate that fusion must keep up with (default: 1 kHz)");
}

void add_comparison_options(VerbOptions& options, BenchVerb& verb) {
  options
      .add_text(
          "--against", verb.against,
          "bench.json of an earlier run with the same options: exit code 6 if a figure is worse beyond both intervals")
      .value_name("FILE");
  options.add_number("--tolerance", verb.tolerance, "percent by which a figure may be worse (default: 5)", 0, 1000)
      .value_name("PERCENT");
}

std::function<void()> bench_options(VerbOptions& options, Session& session) {
  const auto verb = std::make_shared<BenchVerb>();
  options
      .add_texts("FILE", verb->files,
                 "models, logs (their fitted models) and scenes; none: built-in signals and scenes")
      .value_name("FILE…");
  options.add_text("-o,--output", verb->folder, "folder for bench.html, bench.json, bench.md").value_name("DIR");
  options.add_texts("--parts", verb->parts, "these only: " + fmt::format("{}", fmt::join(kBenchParts, ", ")))
      .separated_by_commas()
      .one_value_each()
      .value_name("PART,…")
      .known_words({kBenchParts.begin(), kBenchParts.end()});
  options.add_flag("--quick", verb->quick, "short records and few runs: under a minute");
  options.add_flag("--stress", verb->stress, "the same as --parts stress");
  options.add_count("--seed", verb->seed, "seed of the first simulation (default: 1)");
  options.add_count("--records", verb->records, "simulated recordings of each signal (default: 60; quick: 12)", 2,
                    100000);
  options.add_count("--samples", verb->samples,
                    "samples per recording at most (default: 200000, for a design 4000000; quick: 32768, 400000)", 64,
                    std::uint64_t{1} << 32U);
  options.add_count("--runs", verb->runs, "runs of each scene (default: 12; quick: 3)", 2, 10000);
  options.add_texts("--methods", verb->methods, "estimators of coefficients (default: all)")
      .separated_by_commas()
      .one_value_each()
      .value_name("NAME,…");
  options.add_texts("--algorithms", verb->algorithms, "fusion algorithms (default: the scene's, else all)")
      .separated_by_commas()
      .one_value_each()
      .value_name("NAME,…");
  options
      .add_texts("--sweep", verb->sweeps,
                 "run an algorithm once with each value of an option, ALGORITHM.OPTION=NUMBER,… or FROM..TO; several "
                 "make a grid")
      .one_value_each()
      .value_name("SWEEP");
  add_design_options(options, *verb);
  add_comparison_options(options, *verb);
  options.only("with --against", [verb = verb.get()] { return !verb->against.empty(); }, {"--tolerance"});
  options.add_flag("--force", verb->force, "overwrite results of an earlier run");
  options.add_flag("--json", verb->json, "print bench.json to stdout instead of the tables");
  add_reading_options(options, session, verb->inputs.reading);
  return [&session, verb] { run_bench(session, *verb); };
}

}  // namespace

VerbEntry verb_bench() {
  return {13,
          "bench",
          "Measure run time against error: estimators of noise coefficients, fusion algorithms",
          bench_options,
          {{"the whole comparison on short records, under a minute", "sensorchar bench --quick"},
           {"number of sensors and length of a recording for a target",
            "sensorchar bench report/gyro_z.sensor.yaml --parts design --target 0.001 --at 10s"}}};
}

}  // namespace sensorchar
