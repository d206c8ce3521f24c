// libchar._libchar: the front door of the library for Python. It takes and gives NumPy arrays and plain dictionaries;
// names, defaults, dataclasses and documentation are Python's (libchar/functions.py).

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <pybind11/stl.h>

#include <chrono>
#include <csignal>
#include <optional>
#include <string>
#include <utility>

#include "arrays.hpp"
#include "libchar/characterize/curves/log_spectra.hpp"
#include "libchar/characterize/judgement.hpp"
#include "libchar/core/document/coefficient_fields.hpp"
#include "libchar/core/file/output_files.hpp"
#include "libchar/core/refusal.hpp"
#include "libchar/core/text/quantity_text.hpp"
#include "libchar/core/units.hpp"
#include "libchar/fit/fit_json.hpp"
#include "libchar/libchar.hpp"
#include "libchar/log/detail/column_name.hpp"
#include "libchar/log/recording_json.hpp"
#include "libchar/replay/fusion_file.hpp"
#include "libchar/report/html/html_report.hpp"
#include "libchar/report/replay/replay_text.hpp"
#include "libchar/scene/scene_file.hpp"
#include "libchar/scene/text/typed_text.hpp"
#include "libchar/spectrum/spectrum.hpp"

namespace libchar_python {
namespace {

using namespace libchar;
using Column = py::array_t<double, py::array::c_style>;

/// Ctrl-C reaches Python's own handler, which is asked ten times a second.
class Interruptible : public Progress {
 public:
  void update(double, std::string_view) override {
    const auto now = std::chrono::steady_clock::now();
    if (now - asked_ < std::chrono::milliseconds(100)) return;
    asked_ = now;
    const py::gil_scoped_acquire gil;
    if (PyErr_CheckSignals() == 0) return;
    PyErr_Clear();
    throw Cancelled(SIGINT);
  }

 private:
  std::chrono::steady_clock::time_point asked_ = std::chrono::steady_clock::now();
};

/// Seconds that the last psd, simulate or replay of this thread spent in the library:
/// tests/bench/python_bench.py has what Python adds.
thread_local double g_library_seconds = 0;

class LibraryCall {
 public:
  LibraryCall() = default;
  LibraryCall(const LibraryCall&) = delete;
  LibraryCall& operator=(const LibraryCall&) = delete;
  ~LibraryCall() {
    g_library_seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin_).count();
  }

 private:
  std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
};

/// Options that were given by name; those that are None stay as they are.
class Given {
 public:
  explicit Given(const py::dict& options) : options_(options) {}
  bool has(const char* name) const { return options_.contains(name) && !options_[name].is_none(); }
  template <typename T>
  T get(const char* name) const {
    try {
      return options_[name].cast<T>();
    } catch (const py::cast_error&) {
      throw usage_error("E0208", name)
          .says("a value of another kind is expected here")
          .got(py::repr(options_[name]).cast<std::string>());
    }
  }
  template <typename T>
  void read(const char* name, T& value) const {
    if (has(name)) value = get<T>(name);
  }
  template <typename T>
  void read(const char* name, std::optional<T>& value) const {
    if (has(name)) value = get<T>(name);
  }
  template <EnumWithTable Enum>
  void word(const char* name, Enum& value) const {
    if (!has(name)) return;
    const auto text = get<std::string>(name);
    const auto found = find_enum<Enum>(text);
    if (!found) refuse(name, text, words_of<Enum>());
    value = *found;
  }
  [[noreturn]] static void refuse(const char* name, const std::string& got, const std::vector<std::string>& words) {
    throw usage_error("E0202", name).says("expected one of {}", fmt::join(words, ", ")).got(got);
  }

 private:
  const py::dict& options_;
};

ReadOptions reading_of(const py::dict& options) {
  const Given given(options);
  ReadOptions reading;
  given.read("channels", reading.channels);
  given.read("names", reading.names);
  given.read("units", reading.units);
  given.read("from_s", reading.from_s);
  given.read("to_s", reading.to_s);
  given.read("rate_hz", reading.rate_hz);
  given.read("time_column", reading.time_column);
  given.read("time_unit", reading.time_unit);
  given.read("format", reading.format);
  given.read("delimiter", reading.delimiter);
  given.read("decimal", reading.decimal);
  given.read("header", reading.header);
  given.read("encoding", reading.encoding);
  given.read("skip_rows", reading.skip_rows);
  given.read("missing", reading.missing.marks);
  given.read("overflow_as_missing", reading.missing.overflow);
  given.read("drop_bad_rows", reading.missing.bad_rows);
  given.read("skip_repeated_header", reading.skip_repeated_header);
  given.read("topic", reading.topic);
  given.read("time_source", reading.time_source);
  given.read("threads", reading.threads);
  return reading;
}

void read_taus(const Given& given, CharacterizeOptions& options) {
  if (!given.has("taus")) return;
  options.ten_a_decade = false;
  try {
    options.allan.taus_s = given.get<std::vector<double>>("taus");
    options.allan.grid = TauGrid::list;
    return;
  } catch (const Error&) {
  }
  const auto word = given.get<std::string>("taus");
  options.ten_a_decade = word == "ten";
  const auto grid = find_enum<TauGrid>(word == "ten" ? "octave" : word);
  if (!grid || *grid == TauGrid::list)
    Given::refuse("taus", word, {"octave", "decade", "dense", "ten", "a list of seconds"});
  options.allan.grid = *grid;
}

void read_terms(const Given& given, FitOptions& fit) {
  if (!given.has("terms")) return;
  fit.terms = {};
  for (const std::string& word : given.get<std::vector<std::string>>("terms")) {
    std::vector<std::string> known;
    bool found = false;
    for (std::size_t t = 0; t < kTerms; ++t) {
      known.emplace_back(kTermNames[t].key);
      if (word == kTermNames[t].key || word == kTermNames[t].letter) found = fit.terms[t] = true;
    }
    if (!found) Given::refuse("terms", word, known);
  }
}

void read_spectrum(const Given& given, WelchOptions& spectrum, double& segment_s) {
  given.word("window", spectrum.window);
  given.word("detrend", spectrum.detrend);
  given.word("sides", spectrum.sides);
  given.word("scaling", spectrum.scaling);
  given.read("segment", spectrum.segment);
  given.read("segment_s", segment_s);
  given.read("overlap", spectrum.overlap);
}

CharacterizeOptions characterize_options(const py::dict& reading, const py::dict& options) {
  const Given given(options);
  CharacterizeOptions o;
  o.reading = reading_of(reading);
  o.ten_a_decade = true;
  given.word("data", o.data);
  given.read("nominal_frequency", o.nominal_frequency);
  given.read("temperature", o.temperature);
  if (given.has("still")) {
    const auto text = given.get<std::string>("still");
    o.still.search = text == "auto";
    if (!o.still.search) o.still.stretch_s = parse_range(text);
  }
  if (given.has("type")) {
    const auto word = given.get<std::string>("type");
    const auto type = deviation_type(word);
    if (!type) Given::refuse("type", word, deviation_words());
    o.allan.type = *type;
  }
  read_taus(given, o);
  given.read("tau_min_s", o.allan.tau_min_s);
  given.read("tau_max_s", o.allan.tau_max_s);
  given.read("full_overlap", o.full_overlap);
  read_spectrum(given, o.spectrum, o.segment_s);
  read_terms(given, o.fit);
  given.read("threshold", o.fit.threshold);
  given.read("remedies", o.fit.remedies);
  given.read("second_opinion", o.fit.second_opinion);
  given.read("white_top", o.fit.white_top);
  o.allan.threads = o.spectrum.threads = o.reading.threads;
  if (given.has("only")) {
    const auto only = given.get<std::string>("only");
    o.wanted = {
        .quality = false, .allan = only == "allan" || o.fit.second_opinion, .spectrum = false, .fit = only == "fit"};
    if (only == "allan") o.fit.second_opinion = false;
  }
  return o;
}

/// Columns that Python holds, as a recording.
RecordingView recording_of(const py::dict& columns) {
  RecordingView view;
  const auto names = columns["names"].cast<std::vector<std::string>>();
  const auto units = columns["units"].cast<std::vector<std::string>>();
  for (std::size_t c = 0; c < names.size(); ++c) view.info.channels.push_back({names[c], units[c], false});
  for (const py::handle column : columns["samples"]) view.samples.push_back(samples_of(column.cast<Column>()));
  view.info.file = columns["file"].cast<std::string>();
  view.info.time.rate_hz = columns["rate_hz"].cast<double>();
  view.info.samples = view.info.rows = view.samples.empty() ? 0 : view.samples[0].size();
  view.info.rows_used = view.info.rows;
  return view;
}

py::dict recording_dict(Recording&& recording) {
  py::dict out;
  py::list names, units, samples;
  for (const Channel& channel : recording.info.channels) {
    names.append(channel.name);
    units.append(channel.unit);
  }
  for (std::vector<double>& column : recording.samples) samples.append(to_array(std::move(column)));
  out["names"] = names;
  out["units"] = units;
  out["samples"] = samples;
  out["rate_hz"] = recording.info.time.rate_hz;
  out["file"] = recording.info.file;
  out["start_ns"] = recording.info.time.start_ns;
  out["info"] = to_python(with_valid_text(recording_json(recording.info, {})));
  py::list warnings;
  for (const Finding& warning : recording.info.warnings.list()) warnings.append(one_line(warning, recording.info.file));
  out["warnings"] = warnings;
  return out;
}

py::dict read(const std::string& path, const py::dict& reading) {
  const ReadOptions options = reading_of(reading);
  Recording recording;
  {
    const py::gil_scoped_release released;
    Interruptible progress;
    recording = read_recording(path, options, progress);
  }
  return recording_dict(std::move(recording));
}

py::object of_findings(const std::vector<Finding>& findings) {
  Json list = Json::array();
  for (const Finding& one : findings) list.push_back(document_of(finding_fields(), one));
  return to_python(with_valid_text(list));
}

/// A characterization that Python keeps, to ask for parts of it.
class Characterized {
 public:
  explicit Characterized(Characterization result) : result_(std::move(result)) {}
  py::object document() const { return to_python(with_valid_text(json_report(result_))); }
  py::object allan() const {
    std::vector<Channel> channels;
    std::vector<AllanCurve> curves;
    std::vector<std::vector<Finding>> known;
    for (const ChannelResult& c : result_.channels) {
      if (c.allan.points.empty()) continue;
      channels.push_back(c.channel);
      curves.push_back(c.allan);
      known.push_back(detail::findings_of_curve(c));
    }
    return to_python(with_valid_text(allan_json(channels, curves, known)));
  }
  py::object fits() const {
    Json channels = Json::array();
    for (const ChannelResult& c : result_.channels) {
      if (!c.fit) continue;
      NoiseFit fit = *c.fit;
      fit.findings = findings_of(c);  // those of the samples as well, as the verb says them
      channels.push_back(noise_fit_json(c.channel.name, c.channel.unit, fit));
    }
    return to_python(with_valid_text(noise_fit_document(std::move(channels))));
  }
  std::vector<std::pair<std::string, py::object>> findings() const {
    std::vector<std::pair<std::string, py::object>> out;
    for (const ChannelResult& c : result_.channels) out.emplace_back(c.channel.name, of_findings(judge(c).findings));
    return out;
  }
  std::vector<std::string> models() const {
    std::vector<std::string> out;
    for (const SensorModel& model : sensor_models(result_)) out.push_back(model_yaml(model));
    return out;
  }
  std::string html() const { return html_report(result_); }
  std::vector<std::string> write(const std::string& folder, bool overwrite) const {
    const py::gil_scoped_release released;
    const CharacterizationView view = characterization_view(result_);
    const std::vector<OutputFile> files = report_files(view, folder);
    write_outputs(files, folder, {result_.log.file}, overwrite);
    std::vector<std::string> paths;
    for (const OutputFile& file : files) paths.push_back(file.path);
    return paths;
  }
  double seconds() const { return result_.seconds; }

 private:
  Characterization result_;
};

Characterized characterize_file(const std::string& path, const py::dict& reading, const py::dict& options) {
  const CharacterizeOptions o = characterize_options(reading, options);
  const py::gil_scoped_release released;
  Interruptible progress;
  return Characterized(libchar::characterize(path, o, progress));
}

Characterized characterize_columns(const py::dict& columns, const py::dict& reading, const py::dict& options) {
  const CharacterizeOptions o = characterize_options(reading, options);
  const RecordingView view = recording_of(columns);
  const py::gil_scoped_release released;
  Interruptible progress;
  return Characterized(libchar::characterize(view, o, progress));
}

py::list psd(const py::object& source, const py::dict& reading, const py::dict& options) {
  CharacterizeOptions o;
  o.wanted.lines = false;
  o.spectrum_bins = 0;
  o.reading = reading_of(reading);
  read_spectrum(Given(options), o.spectrum, o.segment_s);
  Given(options).read("bins", o.spectrum_bins);
  const bool file = py::isinstance<py::str>(source);
  const auto path = file ? source.cast<std::string>() : "";
  const RecordingView view = file ? RecordingView{} : recording_of(source.cast<py::dict>());
  LogSpectra spectra;
  std::vector<std::vector<std::optional<Interval>>> intervals;
  {
    const py::gil_scoped_release released;
    Interruptible progress;
    const LibraryCall call;
    spectra = file ? log_spectra(path, o, progress) : log_spectra(view, o);
    IntervalFactors factors(0.95);
    for (const ChannelResult& c : spectra.channels) intervals.push_back(spectrum_intervals(c.spectrum, factors));
  }
  py::list out;
  for (std::size_t k = 0; k < spectra.channels.size(); ++k) {
    ChannelResult& c = spectra.channels[k];
    std::vector<double> ends;
    ends.reserve(2 * intervals[k].size());
    for (const std::optional<Interval>& interval : intervals[k]) {
      ends.push_back(interval ? interval->low : kMissing);
      ends.push_back(interval ? interval->high : kMissing);
    }
    py::dict one;
    one["name"] = c.channel.name;
    one["unit"] = c.channel.unit;
    one["sides"] = std::string(name_of(c.spectrum.sides));
    one["scaling"] = std::string(name_of(c.spectrum.scaling));
    one["window"] = std::string(name_of(c.spectrum.window));
    one["segment"] = c.spectrum.segment;
    one["segments"] = c.spectrum.segments;
    one["enbw_hz"] = c.spectrum.enbw_hz;
    one["frequency_hz"] = to_array(std::move(c.spectrum.frequency_hz));
    one["value"] = to_array(std::move(c.spectrum.value));
    one["dof"] = to_array(std::move(c.spectrum.dof));
    one["ci95"] = to_array(std::move(ends)).attr("reshape")(-1, 2);
    one["notes"] = spectra.notes;
    one["findings"] = of_findings(findings_of(c));
    out.append(one);
  }
  return out;
}

py::dict simulate(const std::string& model, bool text, const py::dict& options) {
  const Given given(options);
  const SensorModel sensor = text ? parse_sensor_model(model, "model") : read_model_file(model);
  SimulateOptions o;
  given.read("duration_s", o.duration_s);
  given.read("rate_hz", o.rate_hz);
  given.read("seed", o.seed);
  given.read("devices", o.devices);
  if (given.has("truth")) o.truth = parse_signal(given.get<std::string>("truth"), "truth");
  std::vector<std::string> names;
  const std::string name = sensor.channel.empty() ? "sensor" : sensor.channel;
  for (std::uint64_t k = 1; k <= o.devices; ++k) names.push_back(o.devices == 1 ? name : name + std::to_string(k));
  if (given.has("faults"))
    for (const std::string& fault : given.get<std::vector<std::string>>("faults"))
      o.faults.push_back(parse_fault(fault, names));
  Recording recording;
  {
    const py::gil_scoped_release released;
    const LibraryCall call;
    recording = libchar::simulate(sensor, o);
  }
  return recording_dict(std::move(recording));
}

Scene scene_of(const std::string& path, const py::dict& reading, const Given& given) {
  Scene scene;
  if (looks_like_scene(path)) {
    SceneReadOptions how;
    given.read("allow_outside", how.allow_outside);
    scene = read_scene_file(path, how);
  } else {
    SensorRecording recording;
    recording.file = path;
    recording.reading = reading_of(reading);
    given.read("sensors", recording.sensors);
    given.read("reference", recording.reference);
    given.read("models_folder", recording.models_folder);
    scene = scene_from_recording(recording);
  }
  const auto window = [&](const char* name, std::optional<TimeWindow>& out) {
    if (!given.has(name)) return;
    const auto [from, to] = given.get<std::pair<double, double>>(name);
    out = TimeWindow{from, to};
  };
  window("learning", scene.learning);
  window("evaluation", scene.evaluation);
  window("rest", scene.rest);
  given.read("warm_up_s", scene.warm_up_s);
  return scene;
}

/// A replay that Python keeps, to ask for parts of it: its page takes as long as a short replay.
class Replayed {
 public:
  explicit Replayed(ReplayResult result) : result_(std::move(result)) {}
  py::object document() const { return to_python(with_valid_text(replay_json(replay_view(result_)))); }
  std::string html() const { return replay_html(replay_view(result_)); }
  std::string markdown() const { return replay_markdown(replay_view(result_)); }
  std::string fusion() const { return fusion_yaml(result_.learnt); }

 private:
  ReplayResult result_;
};

Replayed replay(const std::string& path, const py::dict& reading, const py::dict& options) {
  const Given given(options);
  const Scene scene = scene_of(path, reading, given);
  ReplayOptions o;
  if (given.has("algorithms"))
    for (const std::string& name : given.get<std::vector<std::string>>("algorithms")) {
      fusion::algorithm(name);
      o.algorithms.push_back({name, {}, 0, 0});
    }
  given.read("window_s", o.window_s);
  given.read("allan", o.allan);
  given.read("budget_s", o.budget_s);
  given.read("timing", o.timing);
  const py::gil_scoped_release released;
  Interruptible progress;
  const LibraryCall call;
  return Replayed(libchar::replay(scene, o, progress));
}

/// The three classes that Python has for the kinds of Error: set by libchar/errors.py.
PyObject* g_errors[3] = {nullptr, nullptr, nullptr};

void set_errors(const py::object& usage, const py::object& input, const py::object& numeric) {
  g_errors[0] = usage.inc_ref().ptr();
  g_errors[1] = input.inc_ref().ptr();
  g_errors[2] = numeric.inc_ref().ptr();
}

void raise_error(const Error& error) {
  const Problem& problem = error.problem();
  const std::size_t which = problem.kind == ErrorKind::usage ? 0 : problem.kind == ErrorKind::numeric ? 2 : 1;
  const py::object made =
      py::reinterpret_borrow<py::object>(g_errors[which])(one_line(problem), problem.code, problem.where, problem.hint);
  PyErr_SetObject(g_errors[which], made.ptr());
}

/// The unit that the name of a column ends in, "" where that is not one: "Gyro X (deg/s)".
std::string unit_of_name(const std::string& column) {
  const std::string unit = name_and_unit(column).second;
  return find_unit(unit) ? unit : "";
}

}  // namespace

PYBIND11_MODULE(_libchar, module) {
  py::register_exception_translator([](std::exception_ptr thrown) {
    try {
      if (thrown) std::rethrow_exception(thrown);
    } catch (const Error& error) {
      raise_error(error);
    } catch (const Cancelled&) {
      PyErr_SetNone(PyExc_KeyboardInterrupt);
    }
  });
  py::class_<Characterized>(module, "Characterized")
      .def("document", &Characterized::document)
      .def("allan", &Characterized::allan)
      .def("fits", &Characterized::fits)
      .def("findings", &Characterized::findings)
      .def("models", &Characterized::models)
      .def("html", &Characterized::html)
      .def("write", &Characterized::write)
      .def("seconds", &Characterized::seconds);
  py::class_<Replayed>(module, "Replayed")
      .def("document", &Replayed::document)
      .def("html", &Replayed::html)
      .def("markdown", &Replayed::markdown)
      .def("fusion", &Replayed::fusion);
  module.def("set_errors", &set_errors);
  module.def("version", [] { return std::string(version()); });
  module.def("build", &build);
  module.def("unit_of_name", &unit_of_name);
  module.def("read", &read);
  module.def("characterize_file", &characterize_file);
  module.def("characterize_columns", &characterize_columns);
  module.def("psd", &psd);
  module.def("simulate", &simulate);
  module.def("replay", &replay);
  module.def("library_seconds", [] { return g_library_seconds; });
  module.def("write_recording", [](const std::string& path, const py::dict& columns, bool overwrite) {
    const RecordingView view = recording_of(columns);
    const py::gil_scoped_release released;
    WriteOptions options;
    options.overwrite = overwrite;
    const auto writer = open_log_writer(path, view.info, options);
    writer->write(view.samples);
    writer->finish();
  });
}

}  // namespace libchar_python
