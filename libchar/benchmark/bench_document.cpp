#include "libchar/benchmark/bench_document.hpp"

#include <algorithm>

#include "libchar/characterize/characterization.hpp"
#include "libchar/characterize/model_from_fit.hpp"
#include "libchar/core/document/coefficient_fields.hpp"
#include "libchar/core/document/document.hpp"
#include "libchar/core/refusal.hpp"
#include "libchar/model/model_file.hpp"
#include "libchar/scene/scene_file.hpp"

namespace libchar {
namespace {

const Fields<Figure> kFigureFields = always(Fields<Figure>{
    field<&Figure::value>("value"),
    field<&Figure::ci95>("ci95"),
    field<&Figure::count>("count", {.meaning = "values behind it"}),
});

template <auto Member>
auto figure(std::string_view key, const FieldText& text = {}) {
  return part<Member>(key, kFigureFields, text);
}

const Fields<Machine> kMachineFields = always(Fields<Machine>{
    field<&Machine::processor>("processor"),
    field<&Machine::cores>("processors"),
    field<&Machine::memory_gib>("memory_gib"),
    field<&Machine::system>("system"),
    field<&Machine::others>("busy_with_others"),
    field<&Machine::wall_s>("wall_s"),
    field<&Machine::cpu_s>("cpu_s"),
});

const Fields<TermAccuracy> kCharacterizationTerms = always(Fields<TermAccuracy>{
    field<&TermAccuracy::term>("term", {.words = term_words()}),
    field<&TermAccuracy::truth>("truth"),
    field<&TermAccuracy::bound>("bound"),
    figure<&TermAccuracy::error>("rmse_over_bound"),
    field<&TermAccuracy::bias>("bias_over_bound"),
    figure<&TermAccuracy::coverage>("coverage"),
});
const Fields<EstimatorAccuracy> kCharacterizationMethods = always(Fields<EstimatorAccuracy>{
    field<&EstimatorAccuracy::name>("name"),
    field<&EstimatorAccuracy::what>("what"),
    field<&EstimatorAccuracy::is_ours>("of_this_program"),
    list_of<&EstimatorAccuracy::terms>("terms", kCharacterizationTerms),
    field<&EstimatorAccuracy::error>("error"),
    figure<&EstimatorAccuracy::false_terms>("false_terms"),
    figure<&EstimatorAccuracy::ns_per_sample>("ns_per_sample"),
    figure<&EstimatorAccuracy::time_ratio>("time_ratio"),
    field<&EstimatorAccuracy::bytes_per_sample>("bytes_per_sample"),
    field<&EstimatorAccuracy::front_gap>("front_gap"),
});
const Fields<CharacterizationBench> kCharacterizationFields = always(Fields<CharacterizationBench>{
    field<&CharacterizationBench::signal, &BenchSignal::name>("signal"),
    field<&CharacterizationBench::signal, &BenchSignal::rate_hz>("rate_hz"),
    field<&CharacterizationBench::signal, &BenchSignal::samples>("samples"),
    field<&CharacterizationBench::records>("records"),
    field<&CharacterizationBench::seed>("seed"),
    list_of<&CharacterizationBench::methods>("methods", kCharacterizationMethods),
    field<&CharacterizationBench::notes>("notes"),
});

const FieldText kMethodRan{.written = Written::if_known,
                           .known = when<[](const FusionBenchCell&cell) { return cell.ran; }>},
    kMethodSkipped{.written = Written::if_known, .known = when<[](const FusionBenchCell&cell) { return !cell.ran; }>};
const Fields<FusionBenchCell> kMethodCells = always(Fields<FusionBenchCell>{
    field<&FusionBenchCell::ran>("ran"),
    field<&FusionBenchCell::why>("why", kMethodSkipped),
    figure<&FusionBenchCell::excess>("excess", kMethodRan),
    figure<&FusionBenchCell::ns_per_sample>("ns_per_instant", kMethodRan),
    field<&FusionBenchCell::learning_s>("learning_s", kMethodRan),
    field<&FusionBenchCell::bytes>("bytes", kMethodRan),
    field<&FusionBenchCell::front_gap>("front_gap"),
});
const Fields<FusionBenchRow> kMethodFields = always(Fields<FusionBenchRow>{
    field<&FusionBenchRow::label>("label"),
    field<&FusionBenchRow::name>("algorithm"),
    field<&FusionBenchRow::bound>("bound"),
    field<&FusionBenchRow::swept>("swept"),
    figure<&FusionBenchRow::excess>("excess"),
    figure<&FusionBenchRow::ns_per_sample>("ns_per_instant"),
    field<&FusionBenchRow::front_gap>("front_gap"),
    list_of<&FusionBenchRow::cells>("scenes", kMethodCells),
});

const Fields<FusionBenchScene> kFusionScenes = always(Fields<FusionBenchScene>{
    field<&FusionBenchScene::name>("name"),
    field<&FusionBenchScene::file>("file"),
    field<&FusionBenchScene::yardstick>("yardstick"),
    field<&FusionBenchScene::instants>("instants"),
    field<&FusionBenchScene::sensors>("sensors"),
    field<&FusionBenchScene::inputs>("inputs"),
    field<&FusionBenchScene::simulated>("simulated"),
    field<&FusionBenchScene::runs>("runs"),
    field<&FusionBenchScene::pooled>("pooled"),
});
const Fields<FusionBenchLeftOut> kFusionLeftOut = always(Fields<FusionBenchLeftOut>{
    field<&FusionBenchLeftOut::name>("name"),
    field<&FusionBenchLeftOut::file>("file"),
    field<&FusionBenchLeftOut::why>("why"),
});
const Fields<FusionBench> kFusionFields = always(Fields<FusionBench>{
    field<&FusionBench::seed>("seed"),
    list_of<&FusionBench::scenes>("scenes", kFusionScenes),
    list_of<&FusionBench::rows>("methods", kMethodFields),
    list_of<&FusionBench::left_out>("left_out", kFusionLeftOut, {.written = Written::when_set}),
});

const Fields<ScalingPoint> kScalingPoints = always(Fields<ScalingPoint>{
    field<&ScalingPoint::x>("x"),
    figure<&ScalingPoint::cost>("cost"),
    field<&ScalingPoint::bytes>("bytes"),
});
const Fields<ScalingSeries> kScalingSeries = always(Fields<ScalingSeries>{
    field<&ScalingSeries::name>("name"),
    field<&ScalingSeries::over>("over"),
    field<&ScalingSeries::unit>("unit"),
    list_of<&ScalingSeries::points>("points", kScalingPoints),
    figure<&ScalingSeries::exponent>("exponent"),
    field<&ScalingSeries::keeps_up_to>("keeps_up_to"),
});
const Fields<ScalingBench> kScalingFields = always(Fields<ScalingBench>{
    field<&ScalingBench::rate_hz>("rate_hz"),
    list_of<&ScalingBench::series>("series", kScalingSeries),
});

const Fields<SensorsNeeded> kDesignSensors = always(Fields<SensorsNeeded>{
    field<&SensorsNeeded::model>("model"),
    field<&SensorsNeeded::single>("single"),
    field<&SensorsNeeded::sensors>("sensors"),
    field<&SensorsNeeded::predicted>("predicted"),
    figure<&SensorsNeeded::simulated>("simulated"),
});
const Fields<RecordNeeded> kDesignRecords = always(Fields<RecordNeeded>{
    field<&RecordNeeded::model>("model"),
    field<&RecordNeeded::term>("term", {.words = term_words()}),
    field<&RecordNeeded::seconds>("seconds"),
    field<&RecordNeeded::samples>("samples"),
    figure<&RecordNeeded::simulated>("simulated"),
});
const Fields<DesignBench> kDesignFields = always(Fields<DesignBench>{
    field<&DesignBench::options, &DesignOptions::target>("target"),
    field<&DesignBench::options, &DesignOptions::tau_s>("tau_s"),
    field<&DesignBench::options, &DesignOptions::share>("share"),
    field<&DesignBench::one_of_each>("one_of_each"),
    list_of<&DesignBench::sensors>("sensors", kDesignSensors),
    list_of<&DesignBench::records>("records", kDesignRecords),
});

template <StressOutcome Outcome>
std::uint64_t count_of(const StressBench& bench) {
  return bench.count(Outcome);
}

const Fields<StressCell> kStressCells = always(Fields<StressCell>{
    field<&StressCell::subject>("of"),
    field<&StressCell::input>("input"),
    field<&StressCell::outcome>("outcome"),
    field<&StressCell::digits>("digits"),
    field<&StressCell::stated>("stated"),
    field<&StressCell::what>("what"),
});
const Fields<StressBench> kStressFields = always(Fields<StressBench>{
    field<&StressBench::seed>("seed"),
    list_of<&StressBench::cells>("cells", kStressCells),
    computed<count_of<StressOutcome::digits>>("digits"),
    computed<count_of<StressOutcome::held>>("held"),
    computed<count_of<StressOutcome::refused>>("refused"),
    computed<count_of<StressOutcome::wrong>>("wrong"),
});

}  // namespace

const Fields<BenchReport>& bench_fields() {
  using T = BenchReport;
  static const Fields<T> rows = always(Fields<T>{
      constant<T>("format", std::string("bench")),
      constant<T>("version", std::uint64_t{1}),
      field<&T::command>("command"),
      field<&T::quick>("quick"),
      field<&T::seed>("seed"),
      computed<detail::bench_verdict>("verdict", {.meaning = "a sentence for each part"}),
      part<&T::machine>("machine", kMachineFields),
      list_of<&T::characterization>("characterization", kCharacterizationFields),
      maybe_part<&T::fusion>("fusion", kFusionFields),
      maybe_part<&T::scaling>("scaling", kScalingFields),
      maybe_part<&T::design>("design", kDesignFields),
      maybe_part<&T::stress>("stress", kStressFields),
  });
  return rows;
}

BenchReport parse_bench_report(std::string_view text, const std::string& path) {
  const Document document = parse_json_document(text, path);
  const DocumentEntry* format = document.kind == Document::Kind::map ? document.find("format") : nullptr;
  if (format == nullptr || format->value.text != "bench")
    throw input_error("E0968", path)
        .says("no document of benchmarks")
        .got(format == nullptr ? "" : format->value.text)
        .hint("the bench.json of an earlier run");
  BenchReport out;
  read_fields(bench_fields(), MapReader(document, path, ""), out);
  return out;
}

namespace {

std::size_t terms_in(const SensorModel& model) {
  return static_cast<std::size_t>(std::count_if(model.noise.begin(), model.noise.end(),
                                                [](const Coefficient& c) { return simulated_value(c) > 0; }));
}

void add_model(const std::string& path, const BenchInputOptions& options, BenchInputs& inputs) {
  BenchSignal signal;
  signal.model = read_model_file(path);
  signal.name = signal.model.channel.empty() ? path : signal.model.channel;
  signal.rate_hz = options.reading.rate_hz.value_or(signal.model.rate_hz);
  if (!(signal.rate_hz > 0))
    throw input_error("E0964", path)
        .says("the model does not say its rate, and a record needs one")
        .hint("give `rate_hz`");
  const double own = signal.model.duration_s * signal.rate_hz;
  signal.samples = own > 0 ? std::min(options.most_samples, static_cast<std::uint64_t>(own)) : options.most_samples;
  inputs.signals.push_back(std::move(signal));
}

void add_log(const std::string& path, const BenchInputOptions& options, BenchInputs& inputs, Progress& progress) {
  CharacterizeOptions how;
  how.reading = options.reading;
  const Characterization found = characterize(path, how, progress);
  inputs.warnings.merge(found.log.warnings);
  std::vector<BenchSignal> signals;
  for (const ChannelResult& channel : found.channels) {
    if (!channel.fit) continue;
    BenchSignal signal;
    signal.model = sensor_model_from(channel, found.log);
    if (terms_in(signal.model) == 0) continue;
    signal.name = channel.channel.name;
    signal.rate_hz = channel.fit->rate_hz;
    signal.samples = std::min(options.most_samples, channel.fit->samples);
    signals.push_back(std::move(signal));
  }
  if (signals.empty())
    throw input_error("E0965", path)
        .says("no channel has noise that could be fitted and simulated")
        .hint("its characterization says why");
  std::stable_sort(signals.begin(), signals.end(),
                   [](const auto& a, const auto& b) { return terms_in(a.model) > terms_in(b.model); });
  if (signals.size() > options.most_channels) signals.resize(options.most_channels);
  std::move(signals.begin(), signals.end(), std::back_inserter(inputs.signals));
}

}  // namespace

void add_bench_input(const std::string& path, const BenchInputOptions& options, BenchInputs& inputs,
                     Progress& progress) {
  if (!looks_like_scene(path)) return add_log(path, options, inputs, progress);
  if (is_scene_file(path))
    inputs.scenes.push_back(read_scene_file(path));
  else
    add_model(path, options, inputs);
}

}  // namespace libchar
