// What the program says of the recordings in ../shared/data: goodness inside the band, coefficients
// beside those that two unlike methods agree on, the loop through a simulation; whether the
// quarters of a long record agree and the first half predicts the second; what is known of
// published curves and of clocks. Usage: real_bench [parts = 123] [folder = ../shared/data]
#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include "libchar/characterize/characterization.hpp"
#include "libchar/characterize/compare/runs.hpp"
#include "libchar/characterize/compare/verification.hpp"
#include "libchar/characterize/curves/model_curve.hpp"
#include "libchar/fit/curve/curve_table.hpp"
#include "tests/support/places.hpp"

namespace {

using namespace libchar;

struct Source {
  std::string file;
  double rate_hz;
  SampleKind data = SampleKind::rate;
  double nominal_frequency = 0;
};

const Source kImu = {"static_adis16405_run1.npy", 100};
const Source kCaesium = {"clock_cs5071a_vs_hmaser_phase.npy", 1, SampleKind::phase};
const Source kQuartz = {"clock_ocxo10mhz_freq.npy", 1, SampleKind::frequency, 1e7};

CharacterizeOptions options_for(const Source& source) {
  CharacterizeOptions options;
  options.reading.rate_hz = source.rate_hz;
  options.data = source.data;
  options.nominal_frequency = source.nominal_frequency;
  return options;
}

std::string text(const Coefficient& c) {
  if (c.status == Status::not_fitted) return "-";
  if (!c.value) return fmt::format("<= {:.3g}", c.upper95.value_or(NAN));
  return fmt::format("{:.4g} [{:.3g}, {:.3g}]{}", *c.value, c.ci95.low, c.ci95.high,
                     c.status == Status::detected ? "" : fmt::format(" {}", name_of(c.status)));
}

void print_fit(const std::string& name, const NoiseFit& fit) {
  fmt::print("  {:12} p {:7.2g}, band to {:.4g} Hz |", name, fit.goodness.p, fit.band.top_hz);
  for (std::size_t t = 0; t < kTerms; ++t)
    if (fit.term[t].status != Status::not_fitted) fmt::print(" {} {};", kTermNames[t].letter, text(fit.term[t]));
  fmt::print("\n");
}

/// Gyroscopes of the first recording: ranges that two unlike methods agree on, a shape on the whole
/// spectrum and a cut without one.
struct Agreed {
  Interval q, b, k;
};
const std::vector<Agreed> kGyroscopes = {{{.0403, .0405}, {.0066, .0088}, {0, .0007}},
                                         {{.0424, .0426}, {.0093, .0101}, {.0005, .00063}},
                                         {{.0379, .0381}, {.0072, .0080}, {.00075, .00092}}};

std::string place(const Coefficient& c, Interval range) {
  if (!c.value) return "no value";
  if (*c.value >= range.low && *c.value <= range.high) return "inside";
  const bool reached = c.ci95.low <= range.high && c.ci95.high >= range.low;
  return fmt::format("{:+.1f} % ({})", 100 * (*c.value / (*c.value < range.low ? range.low : range.high) - 1),
                     reached ? "interval reaches it" : "interval does not reach it");
}

void print_whole(const std::filesystem::path& folder) {
  fmt::print("1. {}\n", kImu.file);
  const CharacterizeOptions options = options_for(kImu);
  Characterization imu = characterize((folder / kImu.file).string(), options);
  verify(imu, options);
  int passes = 0, agree = 0;
  for (std::size_t i = 0; i < imu.channels.size(); ++i) {
    const ChannelResult& channel = imu.channels[i];
    if (!channel.fit) continue;
    print_fit(channel.channel.name, *channel.fit);
    passes += channel.fit->goodness.p > 1e-3 ? 1 : 0;
    if (channel.verification) {
      agree += channel.verification->agrees ? 1 : 0;
      fmt::print("    {}\n", channel.verification->sentences.front());
    }
    if (i >= kGyroscopes.size()) continue;
    const NoiseFit& fit = *channel.fit;
    fmt::print("    agreed ranges: Q {}, B {}, K {}\n", place(fit[Term::white], kGyroscopes[i].q),
               place(fit[Term::flicker], kGyroscopes[i].b), place(fit[Term::walk], kGyroscopes[i].k));
  }
  fmt::print("  p > 0.001 in {} of {}, --verify agrees on {}\n\n", passes, imu.channels.size(), agree);
}

Recording part_of(const Recording& whole, std::size_t part, std::size_t parts) {
  Recording out;
  out.info = whole.info;
  out.info.file += fmt::format(", part {} of {}", part + 1, parts);
  out.info.sha256.clear();
  for (const std::vector<double>& samples : whole.samples) {
    const std::size_t length = samples.size() / parts;
    const auto from = samples.begin() + static_cast<std::ptrdiff_t>(part * length);
    out.samples.emplace_back(from, from + static_cast<std::ptrdiff_t>(length));
    out.info.samples = length;
  }
  return out;
}

struct Predicted {
  int inside = 0, points = 0;
};

/// Does the second half's curve lie where the model of the first says, its own interval beside?
Predicted predicted(const NoiseFit& model, const AllanCurve& measured) {
  Predicted out;
  for (const AllanPoint& point : measured.points) {
    if (!point.reliable || !(point.deviation > 0)) continue;
    const double m = static_cast<double>(point.m);
    const auto expected = model_deviation(model, measured.type, m, measured.dt_s);
    const auto stated = model_interval(model, measured.type, m, measured.dt_s);
    if (!expected || !stated) continue;
    const double apart = std::log(*expected / point.deviation);
    const double own = apart > 0 ? std::log(*expected / stated->low) : std::log(stated->high / *expected);
    const double measured_side =
        apart > 0 ? std::log(point.ci95.high / point.deviation) : std::log(point.deviation / point.ci95.low);
    ++out.points;
    out.inside += std::abs(apart) <= std::hypot(own, measured_side) ? 1 : 0;
  }
  return out;
}

struct Pairs {
  int rejected = 0, count = 0;
};

Pairs print_quarters(const Source& source, const Recording& recording) {
  std::vector<Characterization> quarters;
  for (std::size_t part = 0; part < 4; ++part)
    quarters.push_back(characterize(part_of(recording, part, 4), options_for(source)));
  Pairs pairs;
  for (std::size_t a = 0; a < 4; ++a)
    for (std::size_t b = a + 1; b < 4; ++b) {
      const std::vector<Characterization> two = {quarters[a], quarters[b]};
      PoolOptions options;
      options.data = source.data;
      const PooledRuns pooled = pool_runs(two, options);
      for (const PooledChannel& channel : pooled.channels) {
        ++pairs.count;
        if (!(channel.p < 0.01)) continue;
        ++pairs.rejected;
        fmt::print("  quarters {} and {} of {} differ: 2 ln L {:.1f}, p {:.3g}\n", a + 1, b + 1, channel.channel.name,
                   channel.ratio, channel.p);
      }
      for (const Finding& one : pooled.findings) fmt::print("  {}\n", one.sentence);
    }
  return pairs;
}

void print_parts(const std::filesystem::path& folder, const Source& source) {
  fmt::print("2. {}\n", source.file);
  const Recording recording = read_recording((folder / source.file).string(), options_for(source).reading);
  const Pairs pairs = print_quarters(source, recording);
  fmt::print("  {} of {} pairs of quarters rejected at 1 %\n", pairs.rejected, pairs.count);
  const Characterization whole = characterize(recording, options_for(source));
  for (const ChannelResult& channel : whole.channels) {
    for (const Finding& problem : channel.findings)
      fmt::print("  whole record, {}: {}\n", channel.channel.name, problem.sentence);
    if (!channel.fit) continue;
    for (const Event& event : channel.fit->events)
      fmt::print("  whole record, {}: {}\n", channel.channel.name, event_sentence(event, ""));
    fmt::print("  whole record, {}: {}\n", channel.channel.name,
               channel.fit->stationarity.steady ? "steady" : channel.fit->stationarity.sentence);
  }
  const Characterization first = characterize(part_of(recording, 0, 2), options_for(source)),
                         second = characterize(part_of(recording, 1, 2), options_for(source));
  Predicted all;
  for (std::size_t i = 0; i < first.channels.size(); ++i) {
    if (!first.channels[i].fit) continue;
    const Predicted here = predicted(*first.channels[i].fit, second.channels[i].allan);
    fmt::print("  first half predicts the second, {}: {} of {} averaging times\n", first.channels[i].channel.name,
               here.inside, here.points);
    all.inside += here.inside;
    all.points += here.points;
  }
  fmt::print("  all: {} of {} ({:.0f} %)\n\n", all.inside, all.points, 100.0 * all.inside / all.points);
}

void print_curves(const std::filesystem::path& folder, const std::string& file) {
  fmt::print("3. {}\n", file);
  const auto table = read_curve_table((folder / file).string(), true);
  if (!table) return;
  for (const NamedCurve& curve : table->curves) {
    const NoiseFit fit = fit_curve(curve.curve);
    print_fit(curve.name, fit);
    for (const Finding& one : fit.findings) fmt::print("    {}\n", one.sentence);
  }
  fmt::print("\n");
}

void print_clock(const std::filesystem::path& folder, const Source& source) {
  fmt::print("3. {}\n", source.file);
  const Characterization clock = characterize((folder / source.file).string(), options_for(source));
  for (const ChannelResult& channel : clock.channels)
    if (channel.fit) {
      print_fit(channel.channel.name, *channel.fit);
      for (const Finding& one : channel.fit->findings) fmt::print("    {}\n", one.sentence);
    }
  fmt::print("\n");
}

}  // namespace

int main(int argc, char** argv) {
  const std::string parts = argc > 1 ? argv[1] : "123";
  const std::filesystem::path folder = argc > 2 ? std::filesystem::path(argv[2]) : test::shared_folder() / "data";
  if (parts.find('1') != std::string::npos) print_whole(folder);
  if (parts.find('2') != std::string::npos)
    for (const Source& source : {kImu, kCaesium, kQuartz}) print_parts(folder, source);
  if (parts.find('3') == std::string::npos) return 0;
  print_curves(folder, "avarcurve_navchip_published.csv");
  print_curves(folder, "avarcurve_ln200_published.csv");
  print_clock(folder, kCaesium);
  print_clock(folder, kQuartz);
}
