#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>
#include <thread>

#include "libchar/allan/allan_deviation.hpp"
#include "libchar/allan/allan_pyramid.hpp"
#include "libchar/benchmark/bench_document.hpp"
#include "libchar/benchmark/turns.hpp"
#include "libchar/core/numeric/distributions.hpp"
#include "libchar/fit/noise_fit.hpp"
#include "libchar/fusion/registry.hpp"
#include "libchar/fusion/runner.hpp"
#include "libchar/fusion/why_not.hpp"
#include "libchar/simulate/random.hpp"
#include "libchar/spectrum/welch.hpp"

namespace libchar {
namespace {

constexpr Eigen::Index kInstants = 2000;

/// One cost to be measured: a place in a series, and what is run for it.
struct Task {
  std::size_t series = 0;
  double x = 0;
  std::function<double()> run;  // its cost in the unit of the series
};

struct RecordWork {
  const char* name;
  std::size_t most;  // samples; longer records are not tried
  void (*run)(std::span<const double>, int threads);
};

void octaves(std::span<const double> y, int) { pyramid_deviation(y, 0.01); }
void overlap(std::span<const double> y, int threads) {
  AllanOptions options;
  options.threads = threads;
  allan_deviation(y, 0.01, options);
}
void dense(std::span<const double> y, int threads) {
  AllanOptions options;
  options.threads = threads;
  options.grid = TauGrid::dense;
  allan_deviation(y, 0.01, options);
}
void spectrum_of(std::span<const double> y, int threads) {
  WelchOptions options;
  options.threads = threads;
  options.segment = 4096;
  welch(y, 100, options);
}
void fit(std::span<const double> y, int) { fit_record(y, 100, nullptr); }

constexpr std::size_t kAny = std::numeric_limits<std::size_t>::max();
constexpr RecordWork kRecordWork[] = {{"Allan deviation at octaves, streamed", kAny, octaves},
                                      {"Allan deviation at octaves, full overlap", kAny, overlap},
                                      {"Allan deviation at every averaging time", 1U << 22U, dense},
                                      {"spectrum, segments of 4096", kAny, spectrum_of},
                                      {"fit of the noise terms", kAny, fit}};

std::vector<double> white(std::size_t samples, std::uint64_t seed) {
  std::vector<double> out(samples);
  DeviateStream({seed, 0, Purpose::white}).fill_normal(out);
  return out;
}

double wall_seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

/// What is measured and what it is measured into.
class Plan {
 public:
  Plan(const ScalingBenchOptions& options, HeapMeter* heap) : options_(options), heap_(heap) {}

  std::size_t series(const std::string& name, const char* over, const char* unit) {
    out_.push_back({name, over, unit, {}, {}, {}});
    return out_.size() - 1;
  }
  /// `run` returns its cost.
  void task(std::size_t series, double x, std::function<double()> run) {
    tasks_.push_back({series, x, std::move(run)});
  }
  std::vector<ScalingSeries> measured(Progress& progress) {
    std::vector<std::vector<double>> costs(tasks_.size());
    std::vector<double> bytes(tasks_.size(), NAN);
    for (std::size_t round = 0; round < options_.rounds; ++round)
      for (const std::size_t i : order_of_round(tasks_.size(), round)) {
        progress.update(static_cast<double>(round) / static_cast<double>(options_.rounds),
                        fmt::format("growth of cost: round {} of {}", round + 1, options_.rounds));
        if (heap_ != nullptr) heap_->begin();
        costs[i].push_back(tasks_[i].run());
        if (heap_ != nullptr) bytes[i] = static_cast<double>(heap_->end().peak);
      }
    for (std::size_t i = 0; i < tasks_.size(); ++i) {
      ScalingPoint point{tasks_[i].x, time_figure(costs[i]), {}};
      if (heap_ != nullptr) point.bytes = bytes[i];
      out_[tasks_[i].series].points.push_back(point);
    }
    return std::move(out_);
  }

 private:
  const ScalingBenchOptions& options_;
  HeapMeter* heap_;
  std::vector<Task> tasks_;
  std::vector<ScalingSeries> out_;
};

void add_samples(const ScalingBenchOptions& options, const std::vector<double>& record, Plan& plan) {
  for (const RecordWork& work : kRecordWork) {
    const std::size_t series = plan.series(work.name, "samples", "ms");
    for (std::size_t n = 1U << 12U; n <= std::min(record.size(), work.most); n *= options.quick ? 4 : 8)
      plan.task(series, static_cast<double>(n), [&record, n, run = work.run] {
        const double from = thread_seconds();
        run({record.data(), n}, 1);
        return 1e3 * (thread_seconds() - from);
      });
  }
}

void add_threads(const std::vector<double>& record, Plan& plan) {
  const std::size_t series = plan.series("Allan deviation at octaves, full overlap: time of the wall", "threads", "ms");
  const auto most = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
  for (int threads = 1; threads <= most; threads *= 2)
    plan.task(series, threads, [&record, threads] {
      const double from = wall_seconds();
      overlap(record, threads);
      return 1e3 * (wall_seconds() - from);
    });
}

/// An array that has whatever an algorithm may need.
fusion::Array fed_array(Eigen::Index n, Eigen::Index inputs) {
  fusion::Array array;
  array.channels = n;
  array.noise_levels = Eigen::VectorXd::LinSpaced(n, 1, 7);
  array.learning_samples = kInstants;
  array.reference_throughout = true;
  array.rate_hz = 200;
  if (inputs > 1) {
    array.observation_matrix = Eigen::MatrixXd::Ones(n, inputs);
    for (Eigen::Index i = 0; i < n; ++i)
      for (Eigen::Index j = 1; j < inputs; ++j)
        array.observation_matrix(i, j) = std::cos(static_cast<double>(j * (i + 1)));
  }
  return array;
}

struct Samples {
  Eigen::MatrixXd y, truth;
};

Samples samples_of(const fusion::Array& array, std::uint64_t seed) {
  Samples out{Eigen::MatrixXd(array.channels, kInstants), Eigen::MatrixXd(array.inputs(), kInstants)};
  DeviateStream noise({seed, 0, Purpose::white}), truth({seed, 0, Purpose::truth});
  truth.fill_normal({out.truth.data(), static_cast<std::size_t>(out.truth.size())});
  noise.fill_normal({out.y.data(), static_cast<std::size_t>(out.y.size())});
  out.y = (array.noise_levels.cwiseSqrt().asDiagonal() * out.y + array.h() * out.truth).eval();
  return out;
}

/// ns per instant of a runner that has learnt.
std::function<double()> instants_of(const fusion::Entry& entry, const fusion::Array& array, std::uint64_t seed) {
  const auto samples = std::make_shared<Samples>(samples_of(array, seed));
  return [&entry, array, samples] {
    const auto runner = entry.make(array, fusion::Settings(entry.options));
    runner->learn(samples->y, samples->truth);
    runner->finish_learning();
    Eigen::MatrixXd x(array.inputs(), kInstants), variance(array.inputs(), kInstants);
    const double from = thread_seconds();
    runner->run(samples->y, x, variance);
    return 1e9 * (thread_seconds() - from) / static_cast<double>(kInstants);
  };
}

bool is_bound(const fusion::Entry& entry) { return entry.description->needs.reference_throughout; }

void add_sensors(const ScalingBenchOptions& options, Plan& plan) {
  const std::vector<Eigen::Index> sizes = options.quick ? std::vector<Eigen::Index>{2, 4, 8, 16, 32}
                                                        : std::vector<Eigen::Index>{2, 3, 6, 12, 25, 50, 100, 200};
  for (const fusion::Entry& entry : fusion::algorithms()) {
    if (is_bound(entry) || entry.description->needs.tilt) continue;
    const std::size_t series = plan.series(std::string(entry.description->name), "sensors", "ns per instant");
    for (const Eigen::Index n : sizes)
      if (const fusion::Array array = fed_array(n, 1); why_not(*entry.description, array).empty())
        plan.task(series, static_cast<double>(n), instants_of(entry, array, options.seed));
  }
}

void add_inputs(const ScalingBenchOptions& options, Plan& plan) {
  for (const fusion::Entry& entry : fusion::algorithms()) {
    if (is_bound(entry) || !why_not(*entry.description, fed_array(16, 4)).empty()) continue;
    const std::size_t series =
        plan.series(std::string(entry.description->name) + ", 16 sensors", "inputs", "ns per instant");
    for (const Eigen::Index r : {1, 2, 4})
      plan.task(series, static_cast<double>(r), instants_of(entry, fed_array(16, r), options.seed));
  }
}

/// Where the cost of an instant reaches the time between two.
std::optional<double> keeps_up_to(const ScalingSeries& series, double rate_hz) {
  constexpr double kMost = 1e6;
  const double budget = 1e9 / rate_hz;
  const auto over = std::find_if(series.points.begin(), series.points.end(),
                                 [&](const ScalingPoint& p) { return p.cost.value > budget; });
  if (series.points.empty() || series.exponent.count == 0) return std::nullopt;
  if (over == series.points.begin()) return std::nullopt;
  const ScalingPoint& below = *std::prev(over);
  if (over == series.points.end()) {
    const double p = std::max(series.exponent.value, 0.1);
    return std::min(kMost, below.x * std::pow(budget / below.cost.value, 1 / p));
  }
  const double share = std::log(budget / below.cost.value) / std::log(over->cost.value / below.cost.value);
  return below.x * std::pow(over->x / below.x, share);
}

}  // namespace

Figure growth_exponent(const std::vector<ScalingPoint>& points) {
  double most = 0;
  for (const ScalingPoint& p : points) most = std::max(most, p.x);
  std::vector<std::pair<double, double>> logs;
  for (const ScalingPoint& p : points)
    if (p.x >= most / 8 && p.x > 0 && p.cost.value > 0) logs.emplace_back(std::log(p.x), std::log(p.cost.value));
  Figure out;
  const auto n = static_cast<double>(logs.size());
  if (logs.size() < 2) return out;
  double mean_x = 0, mean_y = 0, sxx = 0, sxy = 0, residual = 0;
  for (const auto& [x, y] : logs) mean_x += x / n, mean_y += y / n;
  for (const auto& [x, y] : logs) sxx += (x - mean_x) * (x - mean_x), sxy += (x - mean_x) * (y - mean_y);
  out.value = sxy / sxx;
  out.count = logs.size();
  if (logs.size() < 3) return out;
  for (const auto& [x, y] : logs) residual += std::pow(y - mean_y - out.value * (x - mean_x), 2);
  const double half = student_quantile(0.975, n - 2) * std::sqrt(residual / (n - 2) / sxx);
  out.ci95 = {out.value - half, out.value + half};
  return out;
}

ScalingBench bench_scaling(const ScalingBenchOptions& options, Progress& progress, HeapMeter* heap) {
  const std::vector<double> record = white(options.quick ? std::size_t{1} << 18U : std::size_t{1} << 24U, options.seed);
  const std::vector<double> part(record.begin(), record.begin() + static_cast<std::ptrdiff_t>(std::min<std::size_t>(
                                                                      record.size(), std::size_t{1} << 22U)));
  Plan plan(options, heap);
  add_samples(options, record, plan);
  add_threads(part, plan);
  add_sensors(options, plan);
  add_inputs(options, plan);
  ScalingBench out{options.rate_hz, plan.measured(progress)};
  for (ScalingSeries& series : out.series) {
    if (series.over != "threads") series.exponent = growth_exponent(series.points);
    if (series.over == "sensors") series.keeps_up_to = keeps_up_to(series, options.rate_hz);
  }
  return out;
}

}  // namespace libchar
