#include "replay_source.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "help/fault_help.hpp"
#include "libchar/core/refusal.hpp"
#include "libchar/core/text/decimal.hpp"
#include "libchar/core/text/quantity_text.hpp"
#include "libchar/core/text/term_cells.hpp"
#include "libchar/core/text/text.hpp"
#include "libchar/scene/scene_file.hpp"
#include "libchar/scene/text/typed_text.hpp"
#include "reading_options.hpp"

namespace sensorchar {
namespace {

using namespace libchar;

TimeWindow window_from_words(const std::string& text, const std::string& option) {
  const Interval range = parse_range(text, RangeOf::duration_s, option);
  return {range.low, range.high};
}

std::vector<std::string> parts_of(const std::string& text, char between) {
  std::vector<std::string> out;
  for (std::size_t from = 0; from <= text.size();) {
    const std::size_t to = std::min(text.find(between, from), text.size());
    out.push_back(text.substr(from, to - from));
    from = to + 1;
  }
  return out;
}

// "all", "delay,gain", "all@rest", "bias@0..50".
SceneAlign align_from_words(const std::string& text, const Scene& scene) {
  SceneAlign align;
  const std::size_t at = text.find('@');
  const std::string terms = text.substr(0, at);
  align.choose = terms == "auto";
  if (align.choose && !scene.reference)
    throw usage_error("E0910", "--align")
        .says("a reference judges which terms pay")
        .got(terms)
        .hint("name the terms instead");
  if (terms != "all" && !align.choose)
    for (const std::string& term : parts_of(terms, ',')) {
      if (std::find(std::begin(kAlignTerms), std::end(kAlignTerms), term) == std::end(kAlignTerms))
        throw usage_error("E0910", "--align")
            .says("no term of an alignment")
            .got(term)
            .hint("auto, all, or some of {}", fmt::join(kAlignTerms, ", "));
      align.terms.push_back(term);
    }
  const std::string where = at == std::string::npos ? "" : text.substr(at + 1);
  if (where.find("..") != std::string::npos) {
    align.window = window_from_words(where, "--align");
    return align;
  }
  if (!where.empty() && where != "rest" && where != "learning" && where != "run")
    throw usage_error("E0910", "--align").says("expected rest, learning, run or FROM..TO after the @").got(where);
  if ((where == "rest" && !scene.rest) || (where == "learning" && !scene.learning))
    throw usage_error("E0910", "--align")
        .says("there is no such window")
        .got(where)
        .hint("--" + where + " FROM..TO says one");
  align.learn = !where.empty() ? where : scene.learning ? "learning" : "run";
  return align;
}

void set_grid(const ReplaySource& source, Scene& scene) {
  if (!source.prepare.resample_hz) return;
  if (scene.simulate) throw usage_error("E0910", "--resample").says("a simulation has an even grid");
  if (scene.reading.rate_hz)
    throw usage_error("E0910", "--resample").says("uses the stamps of the log; --rate is for logs without stamps");
  scene.resample_hz = source.prepare.resample_hz;
}

// What is said replaces the scene's own; a band is a filter of its own.
void set_preparation(const ReplaySource& source, Scene& scene) {
  ScenePreparation& p = scene.preparation;
  if (!source.prepare.detrend.empty()) p.detrend = source.prepare.detrend;
  if (source.prepare.high_pass_hz) {
    p.from_hz = *source.prepare.high_pass_hz;
    p.to_hz = 0;
  }
  if (!source.prepare.band.empty()) {
    const Interval band = parse_range(source.prepare.band, RangeOf::rate_hz, "--band");
    p.from_hz = band.low;
    p.to_hz = std::isinf(band.high) ? 0 : band.high;  // 0: a high-pass filter
  }
  const char* option = !source.prepare.band.empty()      ? "--band"
                       : source.prepare.high_pass_hz     ? "--high-pass"
                       : !source.prepare.detrend.empty() ? "--detrend"
                                                         : "--reference-offset";
  if (const std::string why = why_not_prepared(scene); !why.empty()) throw usage_error("E0910", option).says(why);
}

// A number, or estimate.
void set_of_reference(const std::string& words, const std::string& option, const Scene& scene, double& value,
                      bool& estimate) {
  if (words.empty()) return;
  if (scene.simulate) throw usage_error("E0910", option).says("a simulation knows its truth").got(words);
  const auto number = parse_double(words);
  estimate = words == "estimate";
  if (!number && !estimate) throw usage_error("E0910", option).says("expected a number, or estimate").got(words);
  value = number.value_or(0);
}

void set_reference(const ReplaySource& source, Scene& scene) {
  if (scene.reference) {
    SceneReference& r = *scene.reference;
    set_of_reference(source.reference_lag, "--reference-lag", scene, r.lag_s, r.estimate_lag);
    set_of_reference(source.reference_offset, "--reference-offset", scene, r.offset, r.estimate_offset);
  } else if (!source.reference_lag.empty() || !source.reference_offset.empty()) {
    throw usage_error("E0910", source.reference_lag.empty() ? "--reference-offset" : "--reference-lag")
        .says("there is no reference");
  }
}

// A scene says itself what its data are.
void refuse_words_of_recordings(const ReplaySource& source) {
  const std::string reading = reading_flags(source.reading, {});
  const char* option = !source.sensors.empty()         ? "--sensors"
                       : !source.reference.empty()     ? "--reference"
                       : !source.reference_log.empty() ? "--reference-log"
                       : !source.models.empty()        ? "--model"
                       : !source.models_folder.empty() ? "--models"
                                                       : nullptr;
  if (option == nullptr && reading.empty()) return;
  const std::string flag = reading.empty() ? "" : reading.substr(1, reading.find(' ', 1) - 1);
  throw usage_error("E0910", option != nullptr ? option : flag)
      .says("describes a recording, and {} is a scene, which has its own", printable(source.path))
      .hint("change the scene, or give its recording instead");
}

Scene scene_of(const ReplaySource& source, const std::string& scene_file) {
  if (looks_like_scene(source.path)) {
    refuse_words_of_recordings(source);
    Scene scene = read_scene_file(source.path, {source.allow_outside});
    return scene;
  }
  SensorRecording recording;
  recording.file = source.path;
  recording.reading = source.reading;
  recording.sensors = source.sensors;
  recording.reference = source.reference;
  recording.reference_file = source.reference_log;
  recording.models_folder = source.models_folder;
  recording.scene_file = scene_file;
  for (const std::string& words : source.models) {
    const std::size_t equals = words.find('=');
    if (equals == std::string::npos || equals == 0 || equals + 1 == words.size())
      throw usage_error("E0910", "--model").says("expected SENSOR=FILE").got(words);
    recording.models.emplace_back(words.substr(0, equals), words.substr(equals + 1));
  }
  return scene_from_recording(recording);
}

void set_faults(const ReplaySource& source, Scene& scene) {
  if (source.no_faults) {
    scene.faults.clear();
    if (scene.simulate) scene.simulate->faults.clear();
  }
  std::vector<std::string> names;
  for (const SceneSensor& sensor : scene.sensors) names.push_back(sensor.name);
  for (const std::string& words : source.faults) {
    const SensorFault fault = parse_fault(words, names);
    scene.faults.push_back(fault);
    if (scene.simulate) scene.simulate->faults.push_back(fault);
  }
}

void add_data_options(VerbOptions& options, Session& session, ReplaySource& source) {
  const std::string group = "A recording instead of a scene";
  options
      .add_texts("--sensors", source.sensors,
                 "channels that measure one quantity: names, positions c0, c1…, or patterns ('gyro*'); separate by "
                 "commas or repeat")
      .separated_by_commas()
      .once_each()
      .one_value_each()
      .value_name("NAME,…")
      .group(group);
  options.add_texts("--reference", source.reference, "channel with the truth; the mean of several (default: none)")
      .separated_by_commas()
      .once_each()
      .one_value_each()
      .value_name("NAME")
      .group(group);
  options.add_text("--reference-log", source.reference_log, "log of the reference (default: the recording)")
      .value_name("FILE")
      .group(group);
  options.add_texts("--model", source.models, "noise model of a sensor, SENSOR=FILE.sensor.yaml")
      .one_value_each()
      .once_each()
      .value_name("SENSOR=FILE")
      .group(group);
  options
      .add_text("--models", source.models_folder,
                "folder with CHANNEL.sensor.yaml of every sensor, as characterize writes it")
      .value_name("DIR")
      .group(group);
  add_reading_options_without_channel(options, session, source.reading);
}

void add_window(VerbOptions& options, const std::string& name, std::string& value, const std::string& help) {
  options.add_text(name, value, help).value_name("FROM..TO");
}

void add_preparation_options(VerbOptions& options, ReplaySource& source) {
  options.add_rate("--resample", source.prepare.resample_hz,
                   "interpolate each channel by its own stamps to an even grid of this rate, for uneven stamps and "
                   "channels with different rates (default: the scene's)");
  options.add_choice("--detrend", source.prepare.detrend, {"none", "mean", "line"},
                     "subtract this from each sensor and the reference, of the whole recording (default: the scene's)");
  const Option high_pass = options.add_rate("--high-pass", source.prepare.high_pass_hz,
                                            "one high-pass for all sensors and the reference (default: the scene's)");
  options
      .add_text("--band", source.prepare.band,
                "band-pass from LOW to HIGH in Hz, in place of --high-pass (default: the scene's)")
      .value_name("LOW..HIGH")
      .excludes(high_pass);
  options
      .add_text("--reference-lag", source.reference_lag,
                "lag of the sensors relative to the reference in seconds, or estimate (default: the scene's)")
      .value_name("S|estimate");
  options
      .add_text("--reference-offset", source.reference_offset,
                "offset of the reference relative to the sensors, or estimate (default: the scene's)")
      .value_name("NUMBER|estimate");
}

}  // namespace

void add_replay_source(VerbOptions& options, Session& session, ReplaySource& source) {
  options
      .add_text("SCENE", source.path,
                "scene file (docs/scenes.md) of a recording or a simulation, or a recording, with --sensors")
      .value_name("SCENE|LOG");
  add_data_options(options, session, source);
  add_window(options, "--learning", source.learning,
             "learning window in seconds, or none (default: the scene's, else with a reference the first half of a "
             "recording)");
  add_window(options, "--evaluation", source.evaluation,
             "stretch that is scored, in seconds (default: the scene's, else all after the learning window)");
  add_window(options, "--rest", source.rest,
             "stretch in which the true input is zero, to measure offsets and noise (default: the scene's)");
  options
      .add_text("--align", source.align,
                "correct the sensors first: auto (terms that pay), all, or some of "
                "delay,bias,gain,misalignment; learnt @rest, @learning, @run or @FROM..TO (default: the scene's)")
      .value_name("TERMS[@WHERE]");
  add_preparation_options(options, source);
  options.add_instant("--warm-up", source.warm_up_s,
                      "time at the start of the evaluation that is run but not scored (default: the scene's)");
  options.add_texts("--fault", source.faults, std::string(kFaultHelp) + "; injected on top of the scene's")
      .value_name("FAULT");
  options.add_flag("--no-faults", source.no_faults, "leave out the faults that the scene injects");
  options.add_flag("--allow-outside", source.allow_outside, "the scene may name files outside its folder");
}

Scene read_replay_source(const ReplaySource& source, const std::string& scene_file) {
  Scene scene = scene_of(source, scene_file);
  if (source.learning == "none") {
    scene.learning.reset();
    if (scene.reference) scene.reference->teach = false;
  } else if (!source.learning.empty()) {
    scene.learning = window_from_words(source.learning, "--learning");
  }
  if (!source.evaluation.empty()) scene.evaluation = window_from_words(source.evaluation, "--evaluation");
  if (!source.rest.empty()) scene.rest = window_from_words(source.rest, "--rest");
  if (source.warm_up_s) scene.warm_up_s = source.warm_up_s;
  if (!source.align.empty()) {
    if (scene.tilt) throw usage_error("E0910", "--align").says("the sensors of a tilt measure different quantities");
    scene.align = align_from_words(source.align, scene);
  }
  set_reference(source, scene);
  set_grid(source, scene);
  set_preparation(source, scene);
  set_faults(source, scene);
  return scene;
}

}  // namespace sensorchar
