// The file becomes a scene without a reference, read, scaled and aligned by what a replay reads with, so
// that the same log gives the same bits; the algorithm takes in what it learnt and runs.
#include "libchar/replay/fuse.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "libchar/core/numeric/whole.hpp"
#include "libchar/core/refusal.hpp"
#include "libchar/core/text/readable.hpp"
#include "libchar/core/text/shown.hpp"
#include "libchar/core/text/spelling.hpp"
#include "libchar/core/text/term_cells.hpp"
#include "libchar/core/text/text.hpp"
#include "libchar/core/units.hpp"
#include "libchar/fusion/alignment_learning.hpp"
#include "libchar/fusion/registry.hpp"
#include "libchar/fusion/runner.hpp"
#include "libchar/replay/detail/align/instants.hpp"
#include "libchar/replay/detail/learnt_fusion.hpp"
#include "libchar/replay/detail/pass_progress.hpp"
#include "libchar/replay/detail/plan/reading_meter.hpp"
#include "libchar/replay/detail/plan/sensor_knowledge.hpp"
#include "libchar/replay/detail/plan/sensor_words.hpp"
#include "libchar/replay/detail/plan/step_noise.hpp"
#include "libchar/replay/detail/sensor_doubt.hpp"
#include "libchar/replay/device_source.hpp"

namespace libchar {
namespace {

constexpr std::size_t kFusedBlock = 4096;

// The channels of a log without its samples.
std::vector<Channel> channels_of(const std::string& log, ReadOptions reading, Progress& progress) {
  struct Enough {};
  struct Head final : BlockSink {
    void begin(const LogInfo& so_far) override {
      channels = so_far.channels;
      throw Enough{};
    }
    void block(const SampleBlock&) override {}
    std::vector<Channel> channels;
  } head;
  reading.hash = false;
  try {
    read_log(log, reading, head, progress);
  } catch (const Enough&) {
  }
  return head.channels;
}

class Fusing {
 public:
  Fusing(const std::string& log, const LearntFusion& learnt, const FuseOptions& options, Progress& progress)
      : log_(log),
        learnt_(learnt),
        options_(options),
        progress_(progress),
        algorithm_(detail::algorithm_to_apply(learnt, options.algorithm)) {
    if (learnt.average_s)
      throw input_error("E0934", learnt.file)
          .says("it was learnt on means over the intervals of a slow reference, which are not applied to a log yet")
          .got(duration_text(*learnt.average_s));
    find_entry();
    find_channels();
    describe_scene();
    instants_ = std::make_unique<Instants>(scene_, progress_, copies());
    tell_frozen();
    prepare_instants();
    make_runner();
  }

  FuseResult run(ColumnSink& sink);

 private:
  void find_entry();
  void find_channels();
  std::string channel_of(const LearntSensor& sensor) const;
  void check_map() const;
  double to_recorded(const LearntSensor& sensor, const Channel& channel) const;
  void without(const std::string& sensor);
  void describe_scene();
  OfCopies copies() const;
  void tell_frozen();
  void prepare_instants();
  void make_runner();
  void look_ahead();
  double fault_free_s() const;
  void check_rate();
  LogInfo columns() const;
  std::size_t block() const { return options_.block > 0 ? options_.block : kFusedBlock; }
  void take(const Eigen::MatrixXd& samples, ColumnSink& sink);
  const Eigen::MatrixXd& given(const Eigen::MatrixXd& samples);
  void note_faults(std::int64_t end);
  void fill_flags(const Eigen::MatrixXd& samples, std::size_t first);
  double stated(Eigen::Index input, double variance, const Eigen::VectorXd& samples) const;
  void begin_check();
  void check_readings();
  detail::ReadingMeter::Readings learnt_readings() const;
  void check_noise();
  void tell_learnt();
  void tell();

  const std::string& log_;
  const LearntFusion& learnt_;
  const FuseOptions& options_;
  Progress& progress_;
  const LearntAlgorithm& algorithm_;
  const fusion::Entry* entry_ = nullptr;
  bool dressed_ = false;                // somebody says what the channels of the log are in
  std::vector<std::size_t> present_;    // sensors of the file that the log has
  std::vector<double> to_recorded_;     // of these
  std::vector<std::ptrdiff_t> row_;     // of each sensor of the file in the algorithm; -1: left out
  std::vector<std::size_t> sensor_of_;  // of each row of the algorithm
  Scene scene_;
  std::unique_ptr<Instants> instants_;
  SceneAlignment alignment_;
  std::unique_ptr<fusion::Runner> runner_;
  double output_scale_ = 1;
  FuseResult result_;
  Eigen::MatrixXd full_, x_, variance_;
  std::vector<std::vector<double>> out_;
  // Faults: what the log of the algorithm says of the sensors, up to where it was read.
  struct FaultsRead {
    std::size_t events = 0;
    std::vector<char> out_now;  // of each row
    std::int64_t done = 0;
  } faults_;
  // Is the noise that of where it was learnt?
  struct {
    std::vector<Eigen::Index> rows;  // of the algorithm, whose sensors are in the log
    std::optional<StepNoiseMeter> steps;
    std::optional<detail::ReadingMeter> readings;
    std::optional<detail::SensorDoubt> doubt;
  } check_;
};

void Fusing::find_entry() {
  entry_ = fusion::find_algorithm(algorithm_.name);
  if (entry_ == nullptr)
    throw input_error("E0930", fmt::format("{}:{}:{}", learnt_.file, algorithm_.line, algorithm_.column))
        .says("this program has no algorithm of this name")
        .got(algorithm_.name)
        .hint("sensorchar replay lists what there is");
}

void Fusing::check_map() const {
  for (const auto& [sensor, channel] : options_.map) {
    std::vector<std::string> names;
    for (const LearntSensor& known : learnt_.sensors) names.push_back(known.name);
    if (std::find(names.begin(), names.end(), sensor) != names.end()) continue;
    const auto near = nearest(sensor, names);
    throw usage_error("E0935", "`map`")
        .says("{} has no sensor of this name", learnt_.file)
        .got(sensor)
        .hint(did_you_mean(near, "it has " + first_names(names)));
  }
}

std::string Fusing::channel_of(const LearntSensor& sensor) const {
  for (const auto& [name, channel] : options_.map)
    if (name == sensor.name) return channel;
  return sensor.channel;
}

// What takes the numbers of a channel to the unit that the sensor's had.
double Fusing::to_recorded(const LearntSensor& sensor, const Channel& channel) const {
  const bool as_read = dressed_ || !sensor.cross.empty() || channel.stated.empty();
  const std::string& unit = as_read ? channel.unit : channel.stated;
  if (const auto factor = Unit::sample_factor(unit, sensor.recorded_unit)) return *factor;
  throw input_error("E0936", log_)
      .says("channel {} is in another unit than that of sensor {}, {}", printable(channel.name, 40),
            printable(sensor.name, 40), sensor.recorded_unit)
      .got(unit)
      .hint("convert the log, or say with `units` what the channels are in");
}

// A sensor that the log does not have.
void Fusing::without(const std::string& sensor) {
  if (!entry_->description->needs.accepts_missing)
    throw input_error("E0937", log_)
        .says("the log has no channel for this sensor, and {} cannot run without it", algorithm_.label)
        .got(sensor)
        .hint("name its column with `map`, or choose another algorithm");
  result_.warnings.add("sensor_not_in_log", "the log does not have these sensors: fused without them", sensor);
}

void Fusing::find_channels() {
  check_map();
  const ReadOptions& reading = options_.reading;
  dressed_ = !reading.units.empty() || !reading.channel_unit.empty() || !reading.channel_scale.empty();
  const std::vector<Channel> channels = channels_of(log_, options_.reading, progress_);
  std::vector<std::string> names;
  names.reserve(channels.size());
  for (const Channel& channel : channels) names.push_back(channel.name);
  const auto find = [&](const std::string& name) {
    return std::find(names.begin(), names.end(), name) - names.begin();
  };
  const auto there = [&](const std::string& name) { return find(name) < std::ssize(names); };
  const bool aligned = !learnt_.interpolation.empty();
  for (std::size_t i = 0; i < learnt_.sensors.size(); ++i) {
    const LearntSensor& sensor = learnt_.sensors[i];
    const std::string channel = channel_of(sensor);
    result_.sensors.push_back({sensor.name, "", sensor.unit});
    const bool axes = !aligned || std::all_of(sensor.cross.begin(), sensor.cross.end(), there);
    if (there(channel) && axes) {
      to_recorded_.push_back(to_recorded(sensor, channels[static_cast<std::size_t>(find(channel))]));
      result_.sensors[i].channel = channel;
      present_.push_back(i);
    } else if (channel != sensor.channel) {
      const auto near = nearest(channel, names);
      throw usage_error("E0935", "`map`")
          .says("{} has no channel of this name", log_)
          .got(channel)
          .hint(did_you_mean(near, "it has " + first_names(names)));
    }
  }
  if (present_.empty())
    throw input_error("E0937", log_)
        .says("the log has none of the channels that the sensors had where this was learnt")
        .got(first_names(names))
        .hint("name them with `map`: SENSOR=CHANNEL; the sensors are " + first_names([&] {
                std::vector<std::string> out;
                for (const LearntSensor& s : learnt_.sensors) out.push_back(s.name);
                return out;
              }()));
  for (std::size_t i = 0; i < learnt_.sensors.size(); ++i)
    if (result_.sensors[i].channel.empty() && !learnt_.sensors[i].left_out) without(learnt_.sensors[i].name);
}

void Fusing::describe_scene() {
  scene_.file = log_;
  scene_.recording = log_;
  scene_.reading = options_.reading;
  scene_.resample_hz = learnt_.resample_hz;
  scene_.preparation = learnt_.preparation;
  const bool tilt = !learnt_.tilt.gyroscope.empty();
  if (tilt) scene_.tilt = SceneTilt{};
  if (!learnt_.interpolation.empty()) scene_.align = SceneAlign{};
  for (std::size_t k = 0; k < present_.size(); ++k) {
    const std::size_t i = present_[k];
    const LearntSensor& from = learnt_.sensors[i];
    SceneSensor sensor;
    sensor.name = from.name;
    sensor.channel = result_.sensors[i].channel;
    sensor.h = from.h;
    sensor.scale = from.scale * to_recorded_[k];
    if (!dressed_ && from.cross.empty()) scene_.reading.channel_scale.push_back(sensor.channel + "=1");
    sensor.unit = from.unit.empty() && (std::abs(from.scale) == 1 || tilt) ? from.recorded_unit : from.unit;
    sensor.cross = from.cross;
    const std::size_t place = scene_.sensors.size();
    if (tilt && from.name == learnt_.tilt.gyroscope) scene_.tilt->gyroscope = place;
    if (tilt && from.name == learnt_.tilt.accelerometer_x) scene_.tilt->accelerometer_x = place;
    if (tilt && from.name == learnt_.tilt.accelerometer_z) scene_.tilt->accelerometer_z = place;
    scene_.sensors.push_back(std::move(sensor));
  }
  if (tilt && present_.size() < learnt_.sensors.size())
    throw input_error("E0937", log_)
        .says("a tilt needs its gyroscope and both accelerometer axes")
        .hint("name their columns with `map`");
}

// How the rates compare, once the log's is known.
void Fusing::check_rate() {
  const double ratio = instants_->info().rate_hz / learnt_.rate_hz;
  if (std::abs(ratio - 1) <= fusion::kSameRate) return;
  if (entry_->description->needs.noise_models)
    throw input_error("E0867", log_)
        .says(
            "the log's rate is {} times that of the log where this was learnt: the noise of a sample, which {} weighs "
            "against the drifts, is not known there",
            brief_text(ratio, 4), algorithm_.label)
        .got(detail::frequency_text(instants_->info().rate_hz, 6))
        .hint("learn on a log of this rate, or choose another algorithm");
  result_.warnings.add(
      "another_rate",
      "the log's rate is not that of the log where this was learnt: delays and times are kept, what counts samples "
      "(memories, noise of a sample) is not",
      fmt::format("{}, learnt at {}", detail::frequency_text(instants_->info().rate_hz, 6),
                  detail::frequency_text(learnt_.rate_hz, 6)));
}

// The original may be one that the algorithm does without.
OfCopies Fusing::copies() const {
  const auto out = [](const LearntSensor& sensor) { return sensor.left_out; };
  const bool all = std::none_of(learnt_.sensors.begin(), learnt_.sensors.end(), out);
  return all && entry_->description->needs.accepts_missing ? OfCopies::missing : OfCopies::recorded;
}

void Fusing::tell_frozen() {
  const SourceInfo& source = instants_->source().info();
  result_.warnings.merge(source.samples_say);
  say_copies(source, scene_, result_.warnings, [&](std::size_t i) { return !learnt_.sensors[present_[i]].left_out; });
  for (std::size_t i = 0; i < std::min(source.frozen.size(), scene_.sensors.size()); ++i)
    if (!source.frozen[i].empty())
      result_.warnings.add("frozen_sensor", kFrozenMissing,
                           frozen_words(scene_.sensors[i].name, source.frozen[i], source));
}

void Fusing::prepare_instants() {
  check_rate();
  std::vector<double> offsets;
  for (const std::size_t i : present_) offsets.push_back(learnt_.sensors[i].offset);
  instants_->set_offsets(std::move(offsets));
  for (std::size_t k = 0; k < present_.size(); ++k) result_.sensors[present_[k]].unit = instants_->info().units[k];
  if (!learnt_.interpolation.empty()) {
    alignment_ = alignment_of(learnt_, present_, instants_->info().rate_hz);
    for (const fusion::ChannelAlignment& channel : alignment_.alignment.channels)
      if (std::abs(channel.delay) > fusion::kMostDelay)
        throw input_error("E0867", log_)
            .says("at this rate a sensor's delay is more than {} samples", fusion::kMostDelay)
            .got(brief_text(channel.delay, 4));
    instants_->set_alignment(&alignment_);
  }
  if (const std::string& unit = learnt_.inputs[0].unit; scene_.tilt)
    if (const auto known = find_unit(unit); known && known->quantity == Quantity::angle)
      output_scale_ = 1 / known->to_si;
}

void Fusing::make_runner() {
  fusion::Array array = array_of(learnt_);
  const InstantsInfo& info = instants_->info();
  array.rate_hz = info.rate_hz;
  array.fault_free_samples = clamped_whole<std::int64_t>(std::round(fault_free_s() * info.rate_hz), 0, info.count);
  if (entry_->description->needs.fault_free_start && array.fault_free_samples == 0)
    throw usage_error("E0934", "`fault_free_s`")
        .says("{} learns its thresholds at the start of a log, where no sensor fails", algorithm_.label)
        .hint("say how long that is in this log, or choose another algorithm");
  for (std::size_t i = 0; i < learnt_.sensors.size(); ++i) {
    row_.push_back(learnt_.sensors[i].left_out ? -1 : std::ssize(sensor_of_));
    if (!learnt_.sensors[i].left_out) sensor_of_.push_back(i);
  }
  faults_.out_now.assign(sensor_of_.size(), 0);
  try {
    fusion::Settings settings(entry_->options);
    for (const auto& [name, value] : algorithm_.options) settings.set(name, value);
    runner_ = entry_->make(array, settings);
    fusion::LearntExchange with(algorithm_.learnt, info.rate_hz / learnt_.rate_hz);
    runner_->exchange(with);
  } catch (const Error& error) {
    Problem problem = error.problem();
    problem.kind = ErrorKind::input;
    problem.where = fmt::format("{}:{}:{}", learnt_.file, algorithm_.line, algorithm_.column);
    throw Error(problem);
  }
  result_.watches_faults = runner_->faults() != nullptr;
}

// A smoother sees the whole log before its first estimate.
void Fusing::look_ahead() {
  fusion::Settings settings(entry_->options);
  for (const auto& [name, value] : algorithm_.options) settings.set(name, value);
  if (!entry_->looks_ahead(settings)) return;
  PassProgress passing(progress_, "looking ahead");
  instants_->pass(0, instants_->info().count, block(), passing,
                  [&](const InstantBlock& b) { runner_->look(given(b.samples)); });
  runner_->finish_learning();
}

// What is known of the log that was learnt from is not known of another one.
double Fusing::fault_free_s() const {
  if (options_.fault_free_s) return *options_.fault_free_s;
  const std::string& sha256 = instants_->info().logs[0].sha256;
  const bool same = !sha256.empty() && !options_.reading.from_s &&
                    std::any_of(learnt_.learnt_from.begin(), learnt_.learnt_from.end(),
                                [&](const LearntFrom& from) { return from.sha256 == sha256; });
  return same ? learnt_.fault_free_s : 0;
}

LogInfo Fusing::columns() const {
  const InstantsInfo& info = instants_->info();
  LogInfo out;
  out.samples = out.rows = static_cast<std::uint64_t>(info.count);
  out.time = info.logs[0].time;
  out.time.rate_hz = info.rate_hz;
  for (const LearntInput& input : learnt_.inputs) out.channels.push_back({input.name, input.unit, false});
  for (const LearntInput& input : learnt_.inputs) out.channels.push_back({input.name + " sd", input.unit, false});
  for (const LearntSensor& sensor : learnt_.sensors) out.channels.push_back({sensor.name + " used", "", true});
  return out;
}

/// A row a sensor of the algorithm; those that the log has not are missing.
const Eigen::MatrixXd& Fusing::given(const Eigen::MatrixXd& samples) {
  if (present_.size() == learnt_.sensors.size() && sensor_of_.size() == present_.size()) return samples;
  full_.setConstant(std::ssize(sensor_of_), samples.cols(), kMissing);
  for (std::size_t k = 0; k < present_.size(); ++k)
    if (const std::ptrdiff_t row = row_[present_[k]]; row >= 0)
      full_.row(row) = samples.row(static_cast<Eigen::Index>(k));
  return full_;
}

/// One flag a sensor and instant of the block, from the events of the algorithm.
void Fusing::fill_flags(const Eigen::MatrixXd& samples, std::size_t first) {
  const fusion::FaultLog* const log = runner_->faults();
  for (Eigen::Index k = 0; k < samples.cols(); ++k) {
    if (log != nullptr) note_faults(faults_.done + k + 1);
    for (std::size_t i = 0; i < learnt_.sensors.size(); ++i) {
      const std::ptrdiff_t row = row_[i];
      FusedSensor& sensor = result_.sensors[i];
      double flag = kMissing;
      if (row < 0 || !fusion::usable(samples(row, k))) {
        ++sensor.missing;
      } else if (faults_.out_now[static_cast<std::size_t>(row)] != 0) {
        flag = 0;
      } else {
        flag = 1;
      }
      if (row >= 0 && faults_.out_now[static_cast<std::size_t>(row)] != 0) ++sensor.out;
      out_[first + i][static_cast<std::size_t>(k)] = flag;
    }
  }
}

/// Events of the instants before `end`. What scatters only stays in use, with less weight.
void Fusing::note_faults(std::int64_t end) {
  const auto events = runner_->faults()->events();
  for (; faults_.events < events.size() && events[faults_.events].sample < end; ++faults_.events) {
    const fusion::FaultEvent& event = events[faults_.events];
    faults_.out_now[static_cast<std::size_t>(event.channel)] =
        event.faulty && event.rule != fusion::FaultRule::noise ? 1 : 0;
  }
}

void Fusing::take(const Eigen::MatrixXd& samples, ColumnSink& sink) {
  const Eigen::MatrixXd& all = given(samples);
  const auto inputs = static_cast<Eigen::Index>(learnt_.inputs.size());
  const auto r = static_cast<std::size_t>(inputs);
  const auto rows = static_cast<std::size_t>(all.cols());
  x_.resize(inputs, all.cols());
  variance_.resize(inputs, all.cols());
  runner_->run(all, x_, variance_);
  const auto* const doubt = check_.doubt ? &check_.doubt->push(all, x_.row(0)) : nullptr;
  x_ *= output_scale_;
  for (std::vector<double>& column : out_) column.resize(rows);
  for (Eigen::Index j = 0; j < inputs; ++j)
    for (std::size_t k = 0; k < rows; ++k) {
      const auto at = static_cast<Eigen::Index>(k);
      const double x = x_(j, at);
      double sd = stated(j, variance_(j, at), all.col(at));
      if (doubt != nullptr && (*doubt)[k].any()) sd = std::sqrt((*doubt)[k].of(sd * sd));
      sd = learnt_.inputs[static_cast<std::size_t>(j)].with_common(sd, x);
      out_[static_cast<std::size_t>(j)][k] = std::isfinite(x) ? x : kMissing;
      out_[r + static_cast<std::size_t>(j)][k] = std::isfinite(x) && std::isfinite(sd) ? sd : kMissing;
    }
  for (std::size_t k = 0; k < rows; ++k) {
    result_.estimates += std::isfinite(out_[0][k]) ? 1 : 0;
    result_.deviations += std::isfinite(out_[r][k]) ? 1 : 0;
  }
  fill_flags(all, 2 * r);
  if (check_.steps && check_.rows.size() == sensor_of_.size()) check_.steps->push(all);
  if (check_.steps && check_.rows.size() < sensor_of_.size())
    check_.steps->push(all(check_.rows, Eigen::indexing::all));
  if (check_.readings) check_.readings->push(all);
  faults_.done += all.cols();
  const std::vector<std::span<const double>> columns(out_.begin(), out_.end());
  sink.block(columns);
}

/// A deviation by the variance that the algorithm states, and by what the replay measured: of its coverage, or of the
/// errors of one that states none, as long as it has what it had there.
double Fusing::stated(Eigen::Index input, double variance, const Eigen::VectorXd& samples) const {
  const std::vector<double>&factor = algorithm_.sd_factor, &sd = algorithm_.sd;
  const auto j = static_cast<std::size_t>(input);
  if (std::isnan(variance) && sd.size() == learnt_.inputs.size() && samples.allFinite()) return sd[j];
  return output_scale_ * (factor.size() == learnt_.inputs.size() ? factor[j] : 1) * std::sqrt(variance);
}

void Fusing::begin_check() {
  if (scene_.tilt) return;
  for (const std::size_t i : present_)
    if (row_[i] >= 0) check_.rows.push_back(row_[i]);
  const fusion::Array array = array_of(learnt_);
  const Eigen::MatrixXd h = array.h();
  if (array.one_common_input() && array.channels >= 2) {
    check_.readings.emplace(array.channels, instants_->info().count);
    check_.readings->expect(learnt_readings());
    check_.doubt.emplace(learnt_readings(), algorithm_.usual);
  }
  check_.steps.emplace(h(check_.rows, Eigen::indexing::all), instants_->info().count);
  // The sum of two sensors' noises is comparable only where the same two are there.
  if (!check_.steps->identifiable() && check_.rows.size() < sensor_of_.size()) check_.steps.reset();
}

void Fusing::check_noise() {
  if (!check_.steps) return;
  std::vector<std::string> names;
  std::vector<std::optional<StepNoise>> learnt;
  for (const Eigen::Index row : check_.rows) {
    const LearntSensor& sensor = learnt_.sensors[sensor_of_[static_cast<std::size_t>(row)]];
    names.push_back(sensor.name);
    learnt.emplace_back();
    if (sensor.step_noise && sensor.step_noise_error)
      learnt.back() = {2 * std::log(*sensor.step_noise), *sensor.step_noise_error};
  }
  warn_of_noise(names, learnt, check_.steps->result(), result_.warnings);
}

detail::ReadingMeter::Readings Fusing::learnt_readings() const {
  detail::ReadingMeter::Readings out;
  for (const std::size_t i : sensor_of_) out.push_back(learnt_.sensors[i].reading);
  return out;
}

void Fusing::check_readings() {
  if (!check_.readings) return;
  std::vector<std::string> names, units;
  for (const std::size_t i : sensor_of_) {
    names.push_back(learnt_.sensors[i].name);
    units.push_back(result_.sensors[i].unit);
  }
  detail::warn_of_changes(*check_.readings, learnt_readings(), names, units, {0, instants_->info().rate_hz},
                          result_.warnings);
}

// Weights of there are those of a sensor that failed, whether it fails here or not.
void Fusing::tell_learnt() {
  for (const Finding& one : learnt_.findings) {
    if (!detail::doubts_sensors(one) || one.code == "sensor_unlike") continue;
    Finding& told = result_.warnings.add(one.code, "where this was learnt: " + as_part(one.sentence), {}, one.count);
    told.severity = one.severity;
    told.where = one.where;
  }
}

void Fusing::tell() {
  tell_learnt();
  check_noise();
  check_readings();
  runner_->remarks(result_.warnings);
  const fusion::FaultLog* const log = runner_->faults();
  if (log == nullptr) return;
  result_.faults = found_faults(*log, sensor_of_, 0, instants_->info().rate_hz);
  if (log->dropped() > 0)
    result_.warnings.add("faults_not_kept",
                         "more faults than are kept: flags of sensors after the last one are incomplete", "",
                         log->dropped());
}

FuseResult Fusing::run(ColumnSink& sink) {
  const InstantsInfo& info = instants_->info();
  result_.log = info.logs[0];
  result_.file = learnt_.file;
  result_.file_sha256 = learnt_.sha256;
  result_.algorithm = algorithm_;
  result_.rate_hz = info.rate_hz;
  result_.instants = static_cast<std::uint64_t>(info.count);
  result_.inputs = learnt_.inputs;
  out_.resize(2 * learnt_.inputs.size() + learnt_.sensors.size());
  begin_check();
  look_ahead();
  sink.begin(columns());
  PassProgress named(progress_, "fusing");
  instants_->pass(0, info.count, block(), named, [&](const InstantBlock& b) { take(b.samples, sink); });
  tell();
  return std::move(result_);
}

}  // namespace

FuseResult fuse(const std::string& log, const LearntFusion& learnt, ColumnSink& sink, const FuseOptions& options,
                Progress& progress) {
  if (read_once(log))
    throw usage_error("E0934", log)
        .says("a log is read twice, for its rate and for its samples: it must be a file")
        .hint("write what the pipe holds to a file first");
  if (!options.reading.channels.empty())
    throw usage_error("E0934", "`channels`")
        .says("the file names the channels that are read")
        .hint("where they have other names say so with `map`: SENSOR=CHANNEL");
  return Fusing(log, learnt, options, progress).run(sink);
}

}  // namespace libchar
