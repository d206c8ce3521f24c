// Any samples through the streaming statistics in pieces of any size, and whole: the same bits; and
// the direct computation beside them.

#include <cmath>
#include <vector>

#include "libchar/allan/allan_deviation.hpp"
#include "libchar/allan/allan_pyramid.hpp"
#include "libchar/core/numeric/moments.hpp"
#include "libchar/spectrum/welch_sums.hpp"
#include "tests/fuzz/fuzz_support.hpp"

using namespace libchar;

namespace {

/// What f says, or its refusal.
template <class Function>
std::string outcome(Function f) {
  try {
    return f();
  } catch (const Error& error) {
    return fuzz::said(error);
  }
}

template <class Stream>
void push(Stream& stream, std::span<const double> samples, std::size_t piece) {
  for (std::size_t i = 0; i < samples.size(); i += piece)
    stream.push(samples.subspan(i, std::min(piece, samples.size() - i)));
}

std::string moments(std::span<const double> samples, std::size_t piece) {
  Moments m;
  push(m, samples, piece);
  return std::to_string(m.count()) + " " + std::to_string(m.missing()) + " " + fuzz::bits(m.mean()) + " " +
         fuzz::bits(m.variance()) + " " + fuzz::bits(m.skewness()) + " " + fuzz::bits(m.kurtosis()) + " " +
         fuzz::bits(m.minimum()) + " " + fuzz::bits(m.maximum());
}

std::string curve_text(const AllanCurve& curve) {
  std::string text = std::to_string(curve.samples) + " " + std::to_string(curve.missing);
  for (const AllanPoint& p : curve.points)
    text += " " + std::to_string(p.m) + ":" + fuzz::bits(p.deviation) + ":" + std::to_string(p.terms);
  return text;
}

std::string pyramid(std::span<const double> samples, std::size_t piece) {
  return outcome([&] {
    AllanPyramid stream;
    push(stream, samples, piece);
    return curve_text(stream.finish(0.01));
  });
}

std::string spectrum(std::span<const double> samples, std::size_t piece, std::uint64_t segment) {
  return outcome([&] {
    WelchOptions options;
    options.segment = segment;
    options.threads = 1;
    WelchStream stream(options);
    push(stream, samples, piece);
    std::string text;
    for (const double value : stream.finish(100).value) text += fuzz::bits(value) + " ";
    return text;
  });
}

/// The direct computation, at octaves below m = 8, where the stream leaves no term out.
void against_direct(std::span<const double> samples) {
  AllanOptions options;
  options.threads = 1;
  AllanCurve direct, stream;
  try {
    direct = allan_deviation(samples, 0.01, options);
    stream = pyramid_deviation(samples, 0.01);
  } catch (const Error& error) {
    fuzz::said(error);
    return;
  }
  for (const AllanPoint& a : direct.points)
    for (const AllanPoint& b : stream.points)
      if (a.m == b.m && a.m < 8 && a.terms != b.terms)
        fuzz::fail("another number of terms", curve_text(direct), curve_text(stream));
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fuzz::Input input(data, size);
  const unsigned choice = input.byte();
  const std::size_t piece = 1 + input.byte() * input.byte() % 5000;
  const std::uint64_t segment = 8 + input.byte();
  std::vector<double> samples;
  while (!input.empty() && samples.size() < 20000) {
    // Counts, any doubles, or a count repeated: long records from short inputs.
    double value = 0;
    std::size_t times = 1;
    switch (choice % 4) {
      case 0:
        value = static_cast<double>(input.take<std::int16_t>());
        break;
      case 1:
        value = input.take<double>();
        break;
      case 2:
        value = input.take<float>();
        break;
      default:
        value = static_cast<double>(static_cast<std::int8_t>(input.byte()));
        times = 1 + input.byte() * 4U;
        if (value == 127) value = std::nan("");
    }
    if (std::isinf(value)) value = std::nan("");
    samples.insert(samples.end(), times, value);
  }
  if (samples.empty()) return 0;
  fuzz::expect_same("moments", moments(samples, samples.size()), moments(samples, piece));
  fuzz::expect_same("pyramid", pyramid(samples, samples.size()), pyramid(samples, piece));
  fuzz::expect_same("spectrum", spectrum(samples, samples.size(), segment), spectrum(samples, piece, segment));
  against_direct(samples);
  return 0;
}
