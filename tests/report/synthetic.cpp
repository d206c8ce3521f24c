#include "tests/report/synthetic.hpp"

#include <boost/math/distributions/chi_squared.hpp>
#include <cmath>
#include <numbers>

#include "libchar/core/numeric/distributions.hpp"

namespace test {

using namespace libchar;

Interval chi_square_band(double value, double dof, double confidence, double power) {
  const boost::math::chi_squared chi2(dof);
  const double tail = (1 - confidence) / 2;
  return {value * std::pow(dof / boost::math::quantile(chi2, 1 - tail), power),
          value * std::pow(dof / boost::math::quantile(chi2, tail), power)};
}

double scattered(double value, double dof, std::mt19937_64& random) {
  std::gamma_distribution<double> gamma(dof / 2, 2 / dof);
  return value * gamma(random);
}

AllanCurve synthetic_allan(const Truth& t, std::mt19937_64& random) {
  AllanCurve curve;
  curve.dt_s = 1 / t.rate_hz;
  curve.samples = t.samples;
  for (std::uint64_t m = 1; 2 * m <= t.samples; m *= 2) {
    const double mm = static_cast<double>(m), tau = mm * curve.dt_s;
    const double variance = t.q * t.q / tau + 2 * std::numbers::ln2 / std::numbers::pi * t.b * t.b +
                            t.k * t.k * curve.dt_s * (2 * mm * mm + 1) / (6 * mm);
    AllanPoint p;
    p.m = m;
    p.tau_s = tau;
    p.terms = t.samples - 2 * m + 1;
    p.edf = std::max(1.0, 1.4 * (static_cast<double>(t.samples) / mm - 1));
    p.deviation = std::sqrt(scattered(variance, 2 * p.edf, random));
    p.ci68 = chi_square_band(p.deviation, p.edf, 0.6827, 0.5);
    p.ci95 = chi_square_band(p.deviation, p.edf, 0.95, 0.5);
    p.reliable = p.edf >= 5;
    curve.points.push_back(p);
  }
  return curve;
}

double density(const Truth& t, double f) {
  const double w = 2 * std::numbers::pi * f;
  return t.q * t.q + t.b * t.b / w + t.k * t.k / (w * w);
}

Spectrum synthetic_spectrum(const Truth& t, std::mt19937_64& random) {
  Spectrum s;
  s.rate_hz = t.rate_hz;
  s.segment = t.samples / 4;
  s.segments = 7;
  s.enbw_hz = 1.5 * t.rate_hz / static_cast<double>(s.segment);
  const double first = t.rate_hz / static_cast<double>(s.segment), last = t.rate_hz / 2;
  const int bins = 320;
  for (int i = 0; i < bins; ++i) {
    const double f = first * std::pow(last / first, (i + 0.5) / bins);
    const double dof = std::max(9.0, 9.0 * f * 0.03 / first);
    s.frequency_hz.push_back(f);
    s.dof.push_back(dof);
    s.value.push_back(scattered(2 * density(t, f), dof, random));
  }
  return s;
}

Coefficient synthetic_coefficient(double truth, double relative_sd, double limit, std::mt19937_64& random) {
  Coefficient c;
  c.bound = relative_sd;
  if (truth == 0) {
    c.status = Status::not_detected;
    c.upper95 = limit;
    c.bound.reset();
    return c;
  }
  c.status = Status::detected;
  c.value = truth * std::exp(relative_sd * std::normal_distribution<double>()(random));
  c.relative_sd = relative_sd;
  c.ci95 = {*c.value * std::exp(-1.96 * relative_sd), *c.value * std::exp(1.96 * relative_sd)};
  c.profile = relative_sd > 0.15;
  c.likelihood_ratio = 1 / (relative_sd * relative_sd);
  c.seconds_for_10_percent = 1000 * relative_sd * relative_sd / 0.01;
  return c;
}

NoiseFit synthetic_fit(const Truth& t, std::mt19937_64& random) {
  NoiseFit fit;
  fit.rate_hz = t.rate_hz;
  fit.samples = t.samples;
  fit.duration_s = static_cast<double>(t.samples) / t.rate_hz;
  fit.search.method = "DCT-II Whittle likelihood, 128 bins";
  fit.search.iterations = 4;
  fit.term[0] = synthetic_coefficient(t.q, 0.0016, 1e-4, random);
  fit.term[1] = synthetic_coefficient(t.b, 0.064, 4e-4, random);
  fit.term[2] = synthetic_coefficient(t.k, 0.21, 2e-5, random);
  SecondOpinion opinion;
  for (std::size_t i = 0; i < 3; ++i) {
    if (!fit.term[i].value) continue;
    fit.theta[i] = *fit.term[i].value * *fit.term[i].value;
    opinion.value[i] = *fit.term[i].value * (1 + 0.7 * fit.term[i].relative_sd);
    opinion.sd[i] = 1.4 * fit.term[i].relative_sd * *fit.term[i].value;
  }
  opinion.goodness = {14.2, 15, 0.51};
  opinion.sentence = "The Allan fit agrees with the spectral fit within 0.7 sd.";
  fit.second_opinion = opinion;
  fit.goodness = {118.3, 125, 0.65};
  std::normal_distribution<double> normal;
  for (int i = 0; i < 128; ++i) {
    FitResidual r;
    r.frequency_hz = 1e-3 * std::pow(1e5, (i + 0.5) / 128);
    r.model = density(t, r.frequency_hz);
    r.dof = 1 + 0.02 * i * i;
    r.z = normal(random);
    r.measured = r.model * (1 + r.z * std::sqrt(2 / r.dof) * 0.3);
    fit.residuals.push_back(r);
  }
  return fit;
}

Trace synthetic_trace(const Truth& t, std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  Trace trace;
  trace.block = t.samples / 400;
  const double sd = t.q * std::sqrt(t.rate_hz);
  for (int i = 0; i < 400; ++i) {
    trace.low.push_back(0.0123 - sd * (3 + 0.3 * std::abs(normal(random))));
    trace.high.push_back(0.0123 + sd * (3 + 0.3 * std::abs(normal(random))));
    trace.missing.push_back(i == 200 ? 37 : 0);
  }
  return trace;
}

ChannelResult synthetic_channel(const std::string& name, const std::string& unit, const Truth& t, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  ChannelResult c;
  c.channel = {name, unit, false};
  c.allan = synthetic_allan(t, random);
  c.spectrum = synthetic_spectrum(t, random);
  c.fit = synthetic_fit(t, random);
  c.trace = synthetic_trace(t, random);
  c.trace_unit = unit;
  ChannelQuality& q = c.quality;
  q.samples = t.samples;
  q.mean = 0.0123;
  q.standard_deviation = t.q * std::sqrt(t.rate_hz) * 1.01;
  q.minimum = q.mean - 4.6 * q.standard_deviation;
  q.maximum = q.mean + 4.5 * q.standard_deviation;
  q.resolution = 0.0025;
  q.distinct_values = 312;
  q.longest_stuck = 3;
  q.difference_kurtosis = 3.01;
  return c;
}

Characterization synthetic_imu() {
  Characterization result;
  LogInfo& log = result.log;
  log.file = "recordings/imu_2h.csv";
  log.format = "csv";
  log.sha256 = "6b86b273ff34fce19d6b804eff5a3f5747ada4eaa22f1d49c01e52ddb7875b4b";
  log.bytes = 18234567;
  log.rows = log.samples = 200000;
  log.time.rate_hz = 200;
  log.time.from_stamps = true;
  log.time.column = "time";
  log.time.unit = "us";
  log.time.unit_guessed = true;
  log.time.jitter_s = 3.4e-6;
  log.time.max_deviation_s = 9.1e-5;
  log.time.gaps = 2;
  log.time.missing_samples = 37;
  log.warnings.add("gap", "grid points without a row are kept as missing", "line 4211", 37);
  log.warnings.add("duplicate_timestamp", "rows with the stamp of the row before are dropped", "line 90112", 1);
  log.guesses = {"time unit: us, from the magnitude of the stamps"};
  log.dialect = {"delimiter ,", "header in line 1", "units in square brackets"};
  const Truth gyro, accelerometer{2e-3, 3e-4, 2e-5, 200, 200000};
  Truth calm = gyro;
  calm.k = 0;
  result.channels.push_back(synthetic_channel("gyr_x", "deg/s", gyro, 1));
  result.channels.push_back(synthetic_channel("gyr_y", "deg/s", gyro, 2));
  result.channels.push_back(synthetic_channel("gyr_z", "deg/s", calm, 3));
  result.channels.push_back(synthetic_channel("acc_x", "m/s^2", accelerometer, 4));
  result.channels.push_back(synthetic_channel("acc_y", "m/s^2", accelerometer, 5));
  result.channels.push_back(synthetic_channel("acc_z", "m/s^2", accelerometer, 6));
  Event step;
  step.at_s = 300;
  step.size = 0.02;
  result.channels[1].fit->events = {step};
  result.channels[3].motion.moving_s = {{120, 180}};
  ChannelResult& bad = result.channels.back();
  bad.fit->goodness = {412.0, 125, 3e-33};
  bad.fit->second_opinion->agrees = false;
  bad.fit->second_opinion->sentence = "White noise differs by 6.1 combined sd.";
  bad.fit->remedies.push_back(
      {"spikes", "kurtosis of differences 29.8 > 3.2", "212 samples replaced by the mean of their neighbours", 212});
  bad.fit->term[1].status = Status::undetermined;
  bad.fit->findings = {
      finding("lowest_left_out", "The record cannot tell bias instability from random walk: record 4 × as long.")};
  bad.fit->bandwidth_hz = 62.0;
  bad.fit->bandwidth_ci95 = Interval{60.5, 63.6};
  bad.lines = {{50.0, 2.1e-3, 340, 0.02}, {100.0, 4e-4, 21, 0.02}};
  bad.quality.saturated = 14;
  bad.quality.missing = 37;
  bad.quality.difference_kurtosis = 29.8;
  bad.quality.findings = {finding("saturated", "14 samples stand at 19.6133: widen the range")};
  for (ChannelResult& c : result.channels) c.quality.missing = 37;
  result.settings = {part_entry("allan", {{"type", "oadev"}, {"grid", "octave"}}),
                     part_entry("spectrum", {{"window", "hann"}, {"segment", std::uint64_t{50000}}, {"overlap", 0.5}})};
  result.command = {"sensorchar", "characterize", "recordings/imu_2h.csv", "-o", "out dir"};
  result.seconds = 1.25;
  return result;
}

const std::vector<std::string>& hostile_names() {
  static const std::vector<std::string> names = {"<img src=x onerror=alert(1)>",
                                                 "</script><script>window.broken=1</script>",
                                                 "\" onmouseover=\"window.broken=2",
                                                 "' onfocus='x",
                                                 "<!--<script>",
                                                 "]]><svg onload=window.broken=3>",
                                                 "=HYPERLINK(\"x\")",
                                                 "a\xE2\x80\xAE"
                                                 "b\xE2\x80\xA8"
                                                 "c",
                                                 "bad\xFF\x01utf8",
                                                 "&lt;b&gt;",
                                                 "{{constructor}} ${x} `y`",
                                                 std::string("nul\0in", 6)};
  return names;
}

Characterization hostile() {
  Characterization result = synthetic_imu();
  const ChannelResult model = result.channels[0];
  result.channels.clear();
  for (const std::string& name : hostile_names()) {
    ChannelResult c = model;
    c.channel.name = name;
    c.channel.unit = c.trace_unit = name;
    c.fit->search.method = c.fit->second_opinion->sentence = name;
    c.fit->findings = {finding("heavy_tails", name)};
    c.fit->remedies = {{name, name, name, 1}};
    c.quality.findings = c.findings = {finding("spiky", name)};
    c.allan.notes = c.spectrum.notes = {name};
    result.channels.push_back(std::move(c));
    result.log.warnings.add("wild_stamp", name, name);
    result.log.guesses.push_back(name);
    result.log.dialect.push_back(name);
    result.command.push_back(name);
  }
  result.log.file = hostile_names()[1] + hostile_names()[0];
  result.log.time.column = result.log.time.unit = result.log.format = hostile_names()[0];
  result.settings.push_back({"note", hostile_names()[1]});
  return result;
}

Characterization many_channels(std::size_t count) {
  Characterization result = synthetic_imu();
  result.channels.clear();
  for (std::size_t i = 0; i < count; ++i) {
    result.channels.push_back(synthetic_channel("thermistor_" + std::to_string(i), "degC", {}, 100 + i));
  }
  return result;
}

Characterization barely_anything() {
  Characterization result = synthetic_imu();
  result.channels.resize(2);
  for (ChannelResult& c : result.channels) {
    c.fit.reset();
    c.findings = {finding("no_fit", "5 samples are too few for a fit")};
  }
  result.channels[0].allan.points.clear();
  result.channels[0].spectrum = {};
  result.channels[1].allan.points.resize(1);
  result.channels[1].allan.points[0] = {1, 0.005, 0,  4,
                                        0, {},    {}, false};  // constant data: a deviation of zero, no edf
  result.channels[1].channel.unit = "";
  result.channels[1].spectrum.value[3] = 0;
  result.log.time.from_stamps = false;
  return result;
}

Characterization at_the_ends_of_doubles() {
  Characterization result = synthetic_imu();
  const double units[] = {1e-310, 5e-324, 1e308, 1e-160, 1e160};
  for (std::size_t k = 0; k < std::size(units); ++k) {
    ChannelResult& c = result.channels[k];
    for (std::size_t i = 0; i < c.trace.low.size(); ++i) {
      c.trace.low[i] = i % 3 == 0 ? -units[k] : 0;
      c.trace.high[i] = i % 2 == 0 ? units[k] : c.trace.low[i];
    }
    for (AllanPoint& p : c.allan.points) p.deviation *= units[k];
    for (double& value : c.spectrum.value) value *= units[k];
  }
  return result;
}

}  // namespace test
