#include "libchar/replay/detail/scene_source.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <set>

#include "libchar/core/numeric/median.hpp"
#include "libchar/core/numeric/whole.hpp"
#include "libchar/core/refusal.hpp"
#include "libchar/core/text/readable.hpp"
#include "libchar/core/text/spelling.hpp"
#include "libchar/log/quality.hpp"
#include "libchar/replay/detail/align/resampled.hpp"

namespace libchar {
namespace {

constexpr std::size_t kSimulatedRows = 4096, kKeptRows = 4096;
/// Of samples of a text that is parsed once; of longer ones a pass costs a parse and no memory.
constexpr std::size_t kMostParsedOnce = std::size_t{4} << 20U;

// What makes the numbers of a sensor worthless: marks for missing values, a dead band, a wrapping phase.
// One that hangs is missing there (hides: hide_frozen), and a truth that rests (truth) has no noise.
void note_bad_samples(const ChannelQuality& quality, const std::string& sensor, bool hides, bool truth, Findings& to) {
  for (const Finding& one : quality.findings)
    if (one.severity == Severity::bad && one.code != "no_value" && (one.code != "stuck" || !hides) &&
        (one.code != "dead_band" || !truth))
      to.add(one.code, find_finding_kind(one.code)->meaning, sensor + ": " + one.sentence).help = one.help;
}

// The first reading, for length and rate, sees which channels have samples, and keeps them where they are few.
struct FirstReading final : BlockSink {
  void begin(const LogInfo& log) override {
    channels.resize(log.channels.size());
    meters.resize(log.channels.size());
    keeps = log.format == "csv";
  }
  void block(const SampleBlock& samples) override {
    channels.resize(std::max(channels.size(), samples.channels.size()));
    meters.resize(channels.size());
    for (std::size_t c = 0; c < samples.channels.size(); ++c) {
      channels[c].push(samples.first, {samples.channels[c], samples.rows});
      meters[c].push({samples.channels[c], samples.rows});
    }
    each.assign(samples.channels.size(), {});
    for (std::size_t c = 0; c < each.size(); ++c) each[c] = {samples.channels[c], samples.rows};
    copies.push(each);
    keep(samples);
  }
  void keep(const SampleBlock& samples) {
    keeps = keeps && (samples.first + samples.rows) * samples.channels.size() <= kMostParsedOnce;
    if (!keeps) {
      kept = decltype(kept)();  // `{}` would keep the memory
      return;
    }
    kept.resize(samples.channels.size());
    for (std::size_t c = 0; c < kept.size(); ++c) {
      kept[c].resize(detail::in_memory(samples.first), kMissing);
      kept[c].insert(kept[c].end(), samples.channels[c], samples.channels[c] + samples.rows);
    }
  }
  std::vector<Presence> channels;
  std::vector<QualityMeter> meters;
  CopiedSensors copies;
  std::vector<std::span<const double>> each;
  bool keeps = false;
  std::vector<std::vector<double>> kept;  // all or none
};

struct Forward final : BlockSink {
  explicit Forward(std::function<void(const SampleBlock&)> to) : next(std::move(to)) {}
  void begin(const LogInfo&) override {}
  void block(const SampleBlock& samples) override { next(samples); }
  std::function<void(const SampleBlock&)> next;
};

std::size_t position(const std::vector<std::string>& names, const std::string& name) {
  return static_cast<std::size_t>(std::find(names.begin(), names.end(), name) - names.begin());
}

// What the sensors of one pass go through on their way.
class SensorPath {
 public:
  SensorPath(const Scene& scene, const std::vector<SensorFault>& faults, const SourceInfo& source)
      : scene_(scene), source_(source), hidden_(source.frozen) {
    const std::uint64_t seed = scene.simulated ? scene.simulated->seed : 1;
    for (std::size_t i = 0; i < scene.sensors.size(); ++i) {
      std::vector<SensorFault> own;
      for (const SensorFault& fault : faults)
        if (fault.sensor == i) own.push_back(fault);
      injectors_.emplace_back(std::move(own), source.rate_hz, seed, i);
    }
    changed_.resize(std::max(scene.sensors.size(), hidden_.size()));
    next_.resize(hidden_.size(), 0);
  }
  /// Samples `first` and on of a channel: of the sensors, then of the others.
  std::span<const double> operator()(std::size_t channel, std::uint64_t first, std::span<const double> y) {
    const bool sensor = channel < injectors_.size(), hides = channel < hidden_.size() && !hidden_[channel].empty();
    if (sensor && source_.copies_missing && source_.copies[channel]) {
      changed_[channel].assign(y.size(), kMissing);
      return changed_[channel];
    }
    const double scale = sensor ? scene_.sensors[channel].scale : 1;
    if (scale == 1 && !hides && (!sensor || injectors_[channel].idle())) return y;
    std::vector<double>& out = changed_[channel];
    out.assign(y.begin(), y.end());
    if (scale != 1)
      for (double& value : out) value *= scale;
    if (sensor && !injectors_[channel].idle()) injectors_[channel].apply(out);
    if (hides) hide(channel, first, out);
    return out;
  }

 private:
  void hide(std::size_t channel, std::uint64_t first, std::span<double> y) {
    const std::vector<Presence::Run>& runs = hidden_[channel];
    const std::uint64_t end = first + y.size();
    for (std::size_t& next = next_[channel]; next < runs.size() && runs[next].from < end; ++next) {
      const std::uint64_t from = std::max(first, runs[next].from), to = runs[next].from + runs[next].count;
      for (std::uint64_t k = from; k < std::min(end, to); ++k) y[detail::in_memory(k - first)] = kMissing;
      if (to > end) return;
    }
  }

  const Scene& scene_;
  const SourceInfo& source_;
  const std::vector<std::vector<Presence::Run>>& hidden_;
  std::vector<FaultInjector> injectors_;
  std::vector<std::vector<double>> changed_;
  std::vector<std::size_t> next_;  // run of each channel
};

}  // namespace

std::size_t column_of(const LogInfo& log, const std::string& channel, const std::string& scene, const char* role) {
  std::vector<std::string> names;
  for (const Channel& one : log.channels) names.push_back(one.name);
  const std::size_t column = position(names, channel);
  if (column < names.size()) return column;
  const auto near = nearest(channel, names);
  throw input_error("E0900", scene)
      .says("the {} {} has no channel of this name", role, log.file)
      .got(channel)
      .hint(did_you_mean(near, "inspect lists the channels"));
}

Error of_scene(const Error& error, const std::string& file) {
  Problem problem = error.problem();
  if (problem.kind != ErrorKind::usage) return error;
  problem.kind = ErrorKind::input;
  if (problem.code.empty()) problem.code = "E0900";
  if (problem.where.empty() || problem.where.starts_with("--")) problem.where = file;
  return Error(problem);
}

SceneSource::SceneSource(const Scene& scene, Progress& progress, OfCopies copies) : scene_(&scene) {
  want_channels();
  known_faults_ = injected_ = scene.faults;
  if (scene.simulate) {
    describe_simulation();
  } else {
    if (scene.simulated)
      known_faults_.insert(known_faults_.end(), scene.simulated->faults.begin(), scene.simulated->faults.end());
    if (scene.resample_hz)
      read_even(progress);
    else
      scan(progress);
    if (hides_frozen()) hide_frozen();
    info_.copies_missing = info_.copies_missing && copies == OfCopies::missing;
  }
}

// What a sensor repeats while it hangs is no measurement: runs that its noise does not give, which `scan` has found, or
// the longest one of a sensor beside others.
void SceneSource::hide_frozen() {
  info_.frozen.resize(own_);
  for (std::size_t i = 0; i < info_.presence.size(); ++i)
    if (is_frozen(info_.presence, i, info_.samples) && info_.frozen[i].empty())
      info_.frozen[i].push_back({info_.presence[i].still_from, info_.presence[i].still});
}

// Two others at least are left to be fused.
void SceneSource::note_copies(const CopiedSensors& copies) {
  std::size_t own = 0;
  for (std::size_t k = 0; k < scene_->sensors.size(); ++k) {
    std::optional<SourceInfo::Copy> found;
    for (std::size_t i = 0; i < k && !found; ++i)
      if (const Likeness how = copies.between(columns_[i], columns_[k]); how != Likeness::none)
        found = SourceInfo::Copy{i, how};
    own += found ? 0 : 1;
    info_.copies.push_back(found);
  }
  info_.copies_missing = hides_frozen() && own >= 2 && own < scene_->sensors.size();
}

bool SceneSource::hides_frozen() const { return scene_->faults.empty() && !scene_->tilt; }  // else it is to be found

void SceneSource::want_channels() {
  for (const SceneSensor& sensor : scene_->sensors) wanted_.push_back(sensor.channel);
  if (scene_->reference && !scene_->reference->recording)
    for (const std::string& channel : scene_->reference->channels) wanted_.push_back(channel);
  own_ = wanted_.size();
  // Only the alignment looks at them.
  info_.further_axes = scene_->align ? scene_->sensors[0].cross.size() : 0;
  for (std::size_t axis = 0; axis < info_.further_axes; ++axis)
    for (const SceneSensor& sensor : scene_->sensors) wanted_.push_back(sensor.cross[axis]);
}

void SceneSource::describe_simulation() {
  simulation_ = *scene_->simulate;
  info_.rate_hz = simulation_.rate_hz;
  info_.samples = simulation_.samples;
  std::vector<std::string> names;
  for (const SimulatedSensor& sensor : simulation_.sensors) {
    names.push_back(sensor.name);
    const SensorModel& m = sensor.model;
    info_.units.push_back(m.sensitivity.unit.empty() ? m.unit : m.sensitivity.unit);
  }
  for (const std::string& truth : simulation_.truth_names) names.push_back(truth);
  for (const std::string& name : wanted_) {
    columns_.push_back(position(names, name));
    if (columns_.back() == names.size())
      throw input_error("E0900", scene_->file)
          .says("the simulation has no sensor and no truth signal of this name")
          .got(name)
          .hint("cross: names of sensors or truth signals");
  }
  for (std::size_t k = scene_->sensors.size(); k < own_; ++k)
    info_.reference_units.push_back(simulation_.truth.size() == 1 ? simulation_.sensors[0].model.unit : "");
}

void SceneSource::read_even(Progress& progress) {
  ResampledLog even = read_resampled(scene_->recording, scene_->reading, wanted_, *scene_->resample_hz,
                                     scene_->tilt ? scene_->sensors.size() : wanted_.size(), progress);
  kept_ = std::move(even.samples);
  for (std::size_t k = 0; k < kept_.size(); ++k) columns_.push_back(k);
  info_.kept = true;
  info_.rate_hz = *scene_->resample_hz;
  info_.samples = even.log.samples;
  for (std::size_t k = 0; k < own_; ++k)
    for (const Channel& channel : even.log.channels)
      if (channel.name == wanted_[k])
        (k < scene_->sensors.size() ? info_.units : info_.reference_units).push_back(channel.unit);
  info_.logs.push_back(std::move(even.log));
  for (std::size_t k = 0; k < scene_->sensors.size(); ++k) info_.presence.emplace_back().push(0, kept_[k]);
  CopiedSensors copies;
  copies.push(std::vector<std::span<const double>>(kept_.begin(), kept_.end()));
  note_copies(copies);
}

void SceneSource::say_of(std::size_t k, const ChannelQuality& quality, const std::vector<Presence::Run>& runs) {
  const bool sensor = k < scene_->sensors.size();
  const std::uint64_t fewest = detail::frozen_run(quality);
  info_.frozen.resize(own_);
  if (hides_frozen() && fewest > 0 && runs.size() < Presence::kMostRuns)
    std::copy_if(runs.begin(), runs.end(), std::back_inserter(info_.frozen[k]),
                 [&](const Presence::Run& run) { return run.count >= fewest; });
  if (!sensor && !info_.frozen[k].empty())
    info_.samples_say.add("stuck", "the reference is frozen: missing there",
                          frozen_words(wanted_[k], info_.frozen[k], info_));
  const bool compared = sensor && scene_->sensors.size() >= 3 && !scene_->tilt;
  note_bad_samples(quality, sensor ? scene_->sensors[k].name : wanted_[k] + ", the reference",
                   compared || !info_.frozen[k].empty(), !sensor, info_.samples_say);
}

void SceneSource::scan(Progress& progress) {
  reading_ = scene_->reading;
  // Half of the usual: blocks on their way are most of what a replay holds.
  reading_.block_bytes = std::min<std::size_t>(reading_.block_bytes, std::size_t{1} << 20U);
  // New names stand for the columns in their order, so all of them must be read.
  if (reading_.names.empty()) {
    std::set<std::string> once;
    for (const std::string& name : wanted_)
      if (once.insert(name).second) reading_.channels.push_back(name);
  }
  // A scale of the scene's own is of the numbers as they are recorded.
  if (!reading_.units.empty())
    for (const SceneSensor& sensor : scene_->sensors)
      if (sensor.scale != 1) reading_.channel_scale.push_back(sensor.channel + "=1");
  FirstReading first;
  LogInfo log;
  try {
    log = read_log(scene_->recording, reading_, first, progress);
  } catch (const Error& error) {
    if (scene_->file == scene_->recording) throw;  // a recording whose options were said, no scene
    throw of_scene(error, scene_->recording);
  }
  info_.rate_hz = log.time.rate_hz;
  info_.samples = log.samples;
  for (std::size_t k = 0; k < wanted_.size(); ++k) {
    const std::size_t column = column_of(log, wanted_[k], scene_->file, "recording");
    columns_.push_back(column);
    if (k >= own_) continue;
    const bool sensor = k < scene_->sensors.size(), seen = column < first.channels.size();
    if (sensor) info_.presence.push_back(seen ? first.channels[column] : Presence{});
    if (seen) say_of(k, first.meters[column].finish(), first.channels[column].runs);
    (k < scene_->sensors.size() ? info_.units : info_.reference_units).push_back(log.channels[column].unit);
  }
  if (!(log.time.rate_hz > 0))
    throw input_error("E0901", scene_->file)
        .says("the recording {} states no sampling rate", scene_->recording)
        .hint(scene_->file == scene_->recording ? "give `rate_hz` RATE" : "recording: {file: …, rate_hz: …}");
  note_copies(first.copies);
  info_.logs.push_back(std::move(log));
  if (first.keeps) kept_ = std::move(first.kept);
  info_.kept = !kept_.empty();
}

void SceneSource::stream(std::uint64_t until, const SourceBlock& block, Progress& progress) const {
  if (scene_->simulate)
    stream_simulation(until, block, progress);
  else if (!kept_.empty())
    stream_kept(until, block);
  else
    stream_recording(until, block, progress);
}

std::vector<std::vector<double>> SceneSource::reference_columns(Progress& progress) const {
  std::vector<std::vector<double>> out(info_.reference_units.size());
  const std::size_t sensors = info_.units.size();
  stream(
      info_.samples,
      [&](std::uint64_t, std::span<const std::span<const double>> columns) {
        for (std::size_t c = 0; c < out.size(); ++c)
          out[c].insert(out[c].end(), columns[sensors + c].begin(), columns[sensors + c].end());
      },
      progress);
  return out;
}

void SceneSource::stream_kept(std::uint64_t until, const SourceBlock& block) const {
  SensorPath path(*scene_, injected_, info_);
  std::vector<std::span<const double>> out(columns_.size());
  const std::uint64_t end = std::min(until, info_.samples);
  for (std::uint64_t done = 0; done < end;) {
    const auto rows = static_cast<std::size_t>(std::min<std::uint64_t>(kKeptRows, end - done));
    for (std::size_t k = 0; k < columns_.size(); ++k) {
      const std::span<const double> column(kept_[columns_[k]].data() + done, rows);
      out[k] = path(k, done, column);
    }
    block(done, out);
    done += rows;
  }
}

void SceneSource::stream_recording(std::uint64_t until, const SourceBlock& block, Progress& progress) const {
  ReadOptions reading = reading_;
  reading.hash = false;
  if (until < info_.samples) {
    // One sample more than is wanted, so that rounding cannot cut one off.
    const double end_s = reading.from_s.value_or(0) + static_cast<double>(until + 1) / info_.rate_hz;
    reading.to_s = std::min(reading.to_s.value_or(end_s), end_s);
  }
  SensorPath path(*scene_, injected_, info_);
  std::vector<std::span<const double>> out(columns_.size());
  Forward forward([&](const SampleBlock& samples) {
    if (samples.first >= until) return;
    const auto rows = static_cast<std::size_t>(std::min<std::uint64_t>(samples.rows, until - samples.first));
    for (std::size_t k = 0; k < columns_.size(); ++k) {
      const std::span<const double> column(samples.channels[columns_[k]], rows);
      out[k] = path(k, samples.first, column);
    }
    block(samples.first, out);
  });
  read_log(scene_->recording, reading, forward, progress);
}

void SceneSource::stream_simulation(std::uint64_t until, const SourceBlock& block, Progress& progress) const {
  ArraySimulator simulator(simulation_, 0);
  std::vector<std::span<const double>> out(columns_.size());
  for (std::uint64_t done = 0; done < std::min(until, info_.samples);) {
    progress.update(static_cast<double>(done) / static_cast<double>(info_.samples), "simulating");
    const auto made = simulator.next(static_cast<std::size_t>(std::min<std::uint64_t>(kSimulatedRows, until - done)));
    for (std::size_t k = 0; k < columns_.size(); ++k) out[k] = made[columns_[k]];
    block(done, out);
    done += out[0].size();
  }
}

void Presence::push(std::uint64_t at, std::span<const double> values) {
  for (std::size_t k = 0; k < values.size(); ++k) {
    if (!std::isfinite(values[k])) continue;
    if (samples++ == 0) first = at + k;
    last = at + k;
    if (run == 0 || values[k] != value) {
      run = 0;
      run_from = at + k;
    }
    value = values[k];
    if (run + 1 == detail::kFrozenRun && runs.size() < kMostRuns) runs.push_back({run_from, 0});
    if (run + 1 >= detail::kFrozenRun && runs.back().from == run_from) runs.back().count = at + k + 1 - run_from;
    const bool longest = run_from == still_from;
    if (++run <= still) {
      if (!longest) next_still = std::max(next_still, run);
      continue;
    }
    if (!longest) next_still = still;
    still = run;
    still_from = run_from;
  }
}

bool is_frozen(std::span<const Presence> presence, std::size_t i, std::uint64_t samples) {
  constexpr double kShortest = 100, kShareOfRun = 0.01, kLonger = 8;
  if (presence.size() < 3) return false;
  std::vector<double> others;
  for (std::size_t k = 0; k < presence.size(); ++k)
    if (k != i) others.push_back(static_cast<double>(presence[k].still));
  const double usual = std::max(median_in_place(others, Middle::upper), static_cast<double>(presence[i].next_still));
  return static_cast<double>(presence[i].still) >
         std::max({kShortest, kShareOfRun * static_cast<double>(samples), kLonger * usual});
}

void say_copies(const SourceInfo& source, const Scene& scene, Findings& to,
                const std::function<bool(std::size_t)>& used) {
  for (std::size_t i = 0; i < source.copies.size(); ++i)
    if (const auto& copy = source.copies[i]; copy && used(i))
      to.add("copied_sensor",
             source.copies_missing
                 ? "sensors that repeat another one, sample by sample, were left out: they measure nothing of their own"
                 : "sensors that repeat another one, sample by sample: one sensor counted twice",
             fmt::format("{} repeats {}{}", scene.sensors[i].name, scene.sensors[copy->original].name,
                         copy->how == Likeness::line ? ", scaled or shifted" : ""));
}

std::string frozen_words(const std::string& name, const std::vector<Presence::Run>& runs, const SourceInfo& source) {
  const auto time = [&](std::uint64_t at) { return place_text(static_cast<double>(at) / source.rate_hz); };
  if (runs.size() == 1)
    return fmt::format("{} from {} to {} s", name, time(runs[0].from), time(runs[0].from + runs[0].count));
  std::uint64_t shortest = source.samples, longest = 0, all = 0;
  for (const Presence::Run& run : runs) {
    shortest = std::min(shortest, run.count);
    longest = std::max(longest, run.count);
    all += run.count;
  }
  return fmt::format("{} in {} stretches of {}{} samples, {} of the recording", name, runs.size(),
                     shortest < longest ? fmt::format("{} to ", shortest) : "", longest,
                     percent_text(static_cast<double>(all) / static_cast<double>(source.samples)));
}

}  // namespace libchar
