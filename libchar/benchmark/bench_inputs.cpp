#include "libchar/benchmark/bench_inputs.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "libchar/characterize/characterization.hpp"
#include "libchar/characterize/model_from_fit.hpp"
#include "libchar/core/refusal.hpp"
#include "libchar/model/model_file.hpp"
#include "libchar/scene/scene_file.hpp"

namespace libchar {
namespace {

std::size_t terms_in(const SensorModel& model) {
  return static_cast<std::size_t>(
      std::count_if(model.noise.begin(), model.noise.end(), [](const Coefficient& c) {
        return simulated_value(c) > 0;
      }));
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
  signal.samples = own > 0 ? std::min(options.most_samples, static_cast<std::uint64_t>(own))
                           : options.most_samples;
  inputs.signals.push_back(std::move(signal));
}

void add_log(const std::string& path,
             const BenchInputOptions& options,
             BenchInputs& inputs,
             Progress& progress) {
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
  std::stable_sort(signals.begin(), signals.end(), [](const auto& a, const auto& b) {
    return terms_in(a.model) > terms_in(b.model);
  });
  if (signals.size() > options.most_channels) signals.resize(options.most_channels);
  std::move(signals.begin(), signals.end(), std::back_inserter(inputs.signals));
}

}  // namespace

void add_bench_input(const std::string& path,
                     const BenchInputOptions& options,
                     BenchInputs& inputs,
                     Progress& progress) {
  if (!looks_like_scene(path)) return add_log(path, options, inputs, progress);
  if (is_scene_file(path))
    inputs.scenes.push_back(read_scene_file(path));
  else
    add_model(path, options, inputs);
}

}  // namespace libchar
