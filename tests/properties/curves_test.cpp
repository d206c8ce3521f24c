// What holds for Allan deviations and spectra of any record.

#include <catch2/catch.hpp>
#include <numeric>

#include "libchar/allan/allan_deviation.hpp"
#include "libchar/allan/allan_pyramid.hpp"
#include "libchar/allan/noise_curves.hpp"
#include "libchar/benchmark/detail/stress_cells.hpp"
#include "libchar/core/error.hpp"
#include "libchar/spectrum/fft.hpp"
#include "libchar/spectrum/spectrum.hpp"
#include "libchar/spectrum/welch.hpp"
#include "libchar/spectrum/welch_sums.hpp"
#include "tests/properties/generate.hpp"

using namespace libchar;
using namespace props;

namespace {

DeviationType any_type() {
  const auto rows = deviation_rows();
  return rows[static_cast<std::size_t>(*rc::gen::inRange(0, static_cast<int>(rows.size())))].type;
}

int fewest(DeviationType type) { return std::max(8, static_cast<int>(deviation_row(type).span(1)) + 2); }

AllanCurve curve(const Record& y, DeviationType type, double dt = 1, TauGrid grid = TauGrid::dense, int threads = 1) {
  AllanOptions options;
  options.type = type;
  options.grid = grid;
  options.threads = threads;
  return allan_deviation(y, dt, options);
}

Record values(const AllanCurve& c) {
  Record out;
  for (const AllanPoint& p : c.points) out.push_back(p.deviation);
  return out;
}

Record deviations(const Record& y, DeviationType type, double dt = 1) { return values(curve(y, type, dt)); }

Spectrum welch_of(const Record& y, std::uint64_t segment, Window window = Window::hann, double overlap = 0.5,
                  Detrend detrend = Detrend::constant, Sides sides = Sides::one, Scaling scaling = Scaling::psd,
                  int threads = 1) {
  WelchOptions options;
  options.segment = segment;
  options.window = window;
  options.overlap = overlap;
  options.detrend = detrend;
  options.sides = sides;
  options.scaling = scaling;
  options.threads = threads;
  return welch(y, 50, options);
}

std::uint64_t any_segment(const Record& y) {
  return static_cast<std::uint64_t>(*rc::gen::inRange(8, static_cast<int>(y.size()) + 1));
}

/// Of the samples of whole segments side by side, without offset taken off.
double mean_square(const Record& y, std::size_t samples) {
  return std::inner_product(y.begin(), y.begin() + static_cast<std::ptrdiff_t>(samples), y.begin(), 0.0) /
         static_cast<double>(samples);
}

}  // namespace

TEST_CASE("property: a power of two scales every deviation exactly") {
  holds([] {
    const DeviationType type = any_type();
    const Record y = record(fewest(type), 120);
    const int power = *rc::gen::inRange(-300, 300);
    RC_ASSERT(same_bits(deviations(scaled(y, power), type), scaled(deviations(y, type), power)));
  });
}
TEST_CASE("property: an offset on the grid changes no bit of a deviation") {
  holds([] {
    const DeviationType type = any_type();
    const Record y = record(fewest(type), 120);
    RC_PRE(deviation_row(type).family != DeviationFamily::interval);
    RC_ASSERT(same_bits(deviations(shifted(y, 0x1p30), type), deviations(y, type)));
  });
}
TEST_CASE("property: overlapping deviations of a record read backwards are the same") {
  holds([] {
    const Record y = record(8, 120);
    const DeviationType type =
        *rc::gen::element(DeviationType::oadev, DeviationType::mdev, DeviationType::ohdev, DeviationType::totdev);
    RC_ASSERT(near(deviations(turned(y), type), deviations(y, type), 1e-13));
  });
}
TEST_CASE("property: at one sample plain, overlapping, modified and total deviation are one") {
  holds([] {
    const Record y = record(8, 120);
    const double plain = deviations(y, DeviationType::adev)[0];
    RC_ASSERT(near(deviations(y, DeviationType::oadev)[0], plain, 1e-13));
    RC_ASSERT(near(deviations(y, DeviationType::mdev)[0], plain, 1e-13));
    RC_ASSERT(near(deviations(y, DeviationType::totdev)[0], plain, 1e-13));
    RC_ASSERT(near(deviations(y, DeviationType::hdev)[0], deviations(y, DeviationType::ohdev)[0], 1e-14));
  });
}
TEST_CASE("property: the plain deviation at m is that of means of m at one") {
  holds([] {
    const int m = *rc::gen::inRange(1, 9);
    const Record y = record(4 * m, 160);
    Record means;
    for (std::size_t i = 0; i + static_cast<std::size_t>(m) <= y.size(); i += static_cast<std::size_t>(m))
      means.push_back(std::accumulate(y.begin() + static_cast<std::ptrdiff_t>(i),
                                      y.begin() + static_cast<std::ptrdiff_t>(i) + m, 0.0) /
                      m);
    AllanOptions options;
    options.type = DeviationType::adev;
    options.grid = TauGrid::list;
    options.taus_s = {static_cast<double>(m)};
    RC_ASSERT(
        near(allan_deviation(y, 1, options).points[0].deviation, deviations(means, DeviationType::adev)[0], 1e-12));
  });
}
TEST_CASE("property: the time deviation is the modified one times tau over root three") {
  holds([] {
    const Record y = record(8, 120);
    const double dt = *between(0.001, 10);
    const AllanCurve modified = curve(y, DeviationType::mdev, dt), time = curve(y, DeviationType::tdev, dt);
    for (std::size_t i = 0; i < modified.points.size(); ++i)
      RC_ASSERT(near(time.points[i].deviation, modified.points[i].tau_s * modified.points[i].deviation / std::sqrt(3.0),
                     1e-14));
  });
}
TEST_CASE("property: a constant has no deviation") {
  holds([] {
    const Record y(static_cast<std::size_t>(*rc::gen::inRange(24, 200)), *any_finite());
    RC_PRE(std::abs(y[0]) < 1e150);
    const DeviationType type = any_type();
    RC_PRE(deviation_row(type).family != DeviationFamily::interval);
    for (const double d : deviations(y, type)) RC_ASSERT(d == 0);
  });
}
TEST_CASE("property: a drift of a is a tau over root two, and none by Hadamard") {
  holds([] {
    const double slope = std::ldexp(*rc::gen::inRange(1, 1 << 16), -10), offset = *on_grid();
    Record y(static_cast<std::size_t>(*rc::gen::inRange(9, 150)));
    for (std::size_t i = 0; i < y.size(); ++i) y[i] = offset + slope * static_cast<double>(i);
    for (const AllanPoint& p : curve(y, DeviationType::oadev).points)
      RC_ASSERT(near(p.deviation, slope * p.tau_s / std::sqrt(2.0), 1e-13));
    for (const double d : deviations(y, DeviationType::ohdev)) RC_ASSERT(d < 1e-9 * slope);
  });
}
TEST_CASE("property: every deviation is its definition to twelve digits") {
  holds([] {
    const DeviationType type = any_type();
    const Record y = shifted(record(fewest(type), 90), *between(-1e6, 1e6));
    for (const AllanPoint& p : curve(y, type, 0.1).points) {
      const auto exact = static_cast<double>(exact_deviation(y, 0.1, type, p.m, 1));
      RC_ASSERT(std::abs(p.deviation - exact) <= 1e-12 * exact + 1e-9 * (exact == 0));
    }
  });
}
TEST_CASE("property: terms are those that fit into the record") {
  holds([] {
    const Record y = record(8, 120);
    for (const AllanPoint& p : curve(y, DeviationType::oadev).points) RC_ASSERT(p.terms == y.size() + 1 - 2 * p.m);
    for (const AllanPoint& p : curve(y, DeviationType::ohdev).points) RC_ASSERT(p.terms == y.size() + 1 - 3 * p.m);
    for (const AllanPoint& p : curve(y, DeviationType::adev).points) RC_ASSERT(p.terms == y.size() / p.m - 1);
  });
}
TEST_CASE("property: another interval between samples changes tau and no deviation") {
  holds([] {
    const Record y = record(8, 120);
    const DeviationType type =
        *rc::gen::element(DeviationType::adev, DeviationType::oadev, DeviationType::mdev, DeviationType::hdev);
    RC_ASSERT(same_bits(deviations(y, type, 0.01), deviations(y, type, 3)));
  });
}
TEST_CASE("property: the phase of a rate has the rate's deviations") {
  holds([] {
    const Record y = record(8, 120);
    Record phase{0};
    for (const double v : y) phase.push_back(phase.back() + v);
    AllanOptions options;
    options.type =
        *rc::gen::element(DeviationType::adev, DeviationType::oadev, DeviationType::mdev, DeviationType::ohdev);
    options.grid = TauGrid::dense;
    const Record of_rate = values(allan_deviation(y, 1, options));
    options.data = DataKind::phase;
    RC_ASSERT(near(values(allan_deviation(phase, 1, options)), of_rate, 1e-12));
  });
}
TEST_CASE("property: threads change no bit of a deviation") {
  holds([] {
    const Record y = with_gaps(record(60, 300), 40);
    const DeviationType type = any_type();
    try {
      RC_ASSERT(
          same_bits(values(curve(y, type, 1, TauGrid::octave, 1)), values(curve(y, type, 1, TauGrid::octave, 4))));
    } catch (const Error& error) {
      RC_ASSERT(!error.problem().what.empty());
    }
  });
}
TEST_CASE("property: a stream gives the bits of the whole, missing samples or not") {
  holds([] {
    const Record y = with_gaps(record(2, 300), *rc::gen::element(3, 30, 1000));
    const auto of = [](AllanPyramid pyramid) -> Record {
      try {
        return values(std::move(pyramid).finish(1));
      } catch (const Error&) {
        return {};
      }
    };
    AllanPyramid whole, parts;
    whole.push(y);
    in_pieces(y, [&](std::span<const double> piece) { parts.push(piece); });
    RC_ASSERT(same_bits(of(std::move(whole)), of(std::move(parts))));
  });
}
TEST_CASE("property: the stream's first three octaves are those of full overlap") {
  holds([] {
    const Record y = record(8, 300);
    const Record full = values(curve(y, DeviationType::oadev, 1, TauGrid::octave)),
                 streamed = values(pyramid_deviation(y, 1));
    for (std::size_t i = 0; i < 3 && i < streamed.size(); ++i) RC_ASSERT(near(streamed[i], full[i], 1e-13));
  });
}
TEST_CASE("property: one missing sample hurts the terms that touch it, no more") {
  holds([] {
    Record y = record(16, 120);
    const AllanCurve whole = curve(y, DeviationType::adev);
    y[static_cast<std::size_t>(*rc::gen::inRange(0, static_cast<int>(y.size())))] = std::nan("");
    for (const AllanPoint& p : curve(y, DeviationType::adev).points) {
      RC_ASSERT(std::isfinite(p.deviation));
      RC_ASSERT(p.terms + 2 >= y.size() / p.m - 1);
    }
    RC_ASSERT(whole.missing == 0);
  });
}
TEST_CASE("property: a mixture's Allan variance is the sum of its terms'") {
  holds([] {
    Mixture theta{};
    for (double& t : theta) t = *between(0, 4);
    const double m = *rc::gen::inRange(1, 5000), dt = *between(0.001, 1);
    double sum = 0;
    for (std::size_t i = 0; i < kTerms; ++i) sum += theta[i] * unit_allan_variance(static_cast<Term>(i), m, dt);
    RC_ASSERT(near(allan_variance(theta, m, dt), sum, 1e-13));
  });
}
TEST_CASE("property: a density integrates to the mean square (rectangular window, side by side)") {
  holds([] {
    const Record y = record(16, 200);
    const std::uint64_t segment = any_segment(y);
    const Spectrum s = welch_of(y, segment, Window::rectangular, 0, Detrend::none);
    const double integral = std::accumulate(s.value.begin(), s.value.end(), 0.0) * 50 / static_cast<double>(segment);
    const double square = mean_square(y, static_cast<std::size_t>(s.segments * segment));
    RC_ASSERT(std::abs(integral - square) <= 1e-12 * square);
  });
}
TEST_CASE("property: a power of two scales a density by its square, exactly") {
  holds([] {
    const Record y = record(16, 200);
    const std::uint64_t segment = any_segment(y);
    const int power = *rc::gen::inRange(-200, 200);
    RC_ASSERT(same_bits(welch_of(scaled(y, power), segment).value, scaled(welch_of(y, segment).value, 2 * power)));
  });
}
TEST_CASE("property: an offset that is taken off leaves the density") {
  holds([] {
    const Record y = record(16, 200);
    const std::uint64_t segment = any_segment(y);
    RC_ASSERT(near(welch_of(shifted(y, 0x1p30), segment).value, welch_of(y, segment).value, 1e-10));
  });
}
TEST_CASE("property: a straight line is nothing to linear detrending") {
  holds([] {
    const Record y = record(16, 200);
    const double slope = *on_grid();
    Record line = y;
    for (std::size_t i = 0; i < y.size(); ++i) line[i] += slope * static_cast<double>(i);
    const std::uint64_t segment = any_segment(y);
    const Record plain = welch_of(y, segment, Window::hann, 0.5, Detrend::linear).value;
    Record found = welch_of(line, segment, Window::hann, 0.5, Detrend::linear).value;
    double scale = 0;
    for (const double p : plain) scale = std::max(scale, p);
    RC_PRE(scale > 1);
    RC_ASSERT(near(found, plain, 1e-7));
  });
}
TEST_CASE("property: one segment turned round in a circle keeps its density") {
  holds([] {
    const Record y = record(16, 200);
    Record circled = y;
    std::rotate(circled.begin(), circled.begin() + *rc::gen::inRange(0, static_cast<int>(y.size())), circled.end());
    const auto of = [](const Record& x) { return welch_of(x, x.size(), Window::rectangular, 0).value; };
    RC_ASSERT(near(of(circled), of(y), 1e-12));
    RC_ASSERT(near(of(turned(y)), of(y), 1e-12));
  });
}
TEST_CASE("property: one side holds what both hold, and the root is the root") {
  holds([] {
    const Record y = record(16, 200);
    const std::uint64_t segment = any_segment(y);
    const Spectrum one = welch_of(y, segment),
                   two = welch_of(y, segment, Window::hann, 0.5, Detrend::constant, Sides::two),
                   root = welch_of(y, segment, Window::hann, 0.5, Detrend::constant, Sides::one, Scaling::lsd);
    const auto sum = [](const Spectrum& s) { return std::accumulate(s.value.begin(), s.value.end(), 0.0); };
    RC_ASSERT(near(sum(one), sum(two), 1e-12));
    for (std::size_t k = 0; k < one.value.size(); ++k) RC_ASSERT(root.value[k] == std::sqrt(one.value[k]));
  });
}
TEST_CASE("property: density and power differ by the noise bandwidth") {
  holds([] {
    const Record y = record(16, 200);
    const std::uint64_t segment = any_segment(y);
    const Window window =
        *rc::gen::element(Window::hann, Window::rectangular, Window::blackman_harris, Window::flat_top);
    const Spectrum density = welch_of(y, segment, window),
                   power = welch_of(y, segment, window, 0.5, Detrend::constant, Sides::one, Scaling::ps);
    for (std::size_t k = 0; k < density.value.size(); ++k)
      RC_ASSERT(std::abs(power.value[k] - density.value[k] * density.enbw_hz) <= 1e-12 * std::abs(power.value[k]));
  });
}
TEST_CASE("property: a streamed spectrum has the bits of the whole, threads or not") {
  holds([] {
    const Record y = with_gaps(record(64, 400), 60);
    WelchOptions options;
    options.segment = static_cast<std::uint64_t>(*rc::gen::inRange(8, 33));
    options.threads = *rc::gen::inRange(1, 4);
    options.overlap = *rc::gen::element(0.0, 0.5, 0.75);
    WelchStream stream(options);
    in_pieces(y, [&](std::span<const double> piece) { stream.push(piece); });
    const auto guarded = [](auto&& of) -> Record {
      try {
        return of();
      } catch (const Error&) {
        return {};
      }
    };
    const Record streamed = guarded([&] { return stream.finish(50).value; });
    if (streamed.empty()) return;  // welch shortens its segments where a stream cannot
    RC_ASSERT(same_bits(streamed, welch(y, 50, options).value));
  });
}
TEST_CASE("property: bins of a logarithmic axis share out all degrees of freedom") {
  holds([] {
    const Record y = record(64, 400);
    const Spectrum s = welch_of(y, 64);
    const Spectrum binned = log_binned(s, 10);
    const double before = std::accumulate(s.dof.begin() + 1, s.dof.end(), 0.0),
                 after = std::accumulate(binned.dof.begin(), binned.dof.end(), 0.0);
    RC_ASSERT(after <= before * (1 + 1e-12) + s.dof[0]);
    for (const double v : binned.value) RC_ASSERT(v >= 0);
  });
}
TEST_CASE("property: cosine transform keeps lengths, and sums of cosines undo it") {
  holds([] {
    const Record y = record(2, 200);
    Dct transform(y.size());
    const auto found = transform.transform(y);
    const Record c(found.begin(), found.end());
    const double before = std::inner_product(y.begin(), y.end(), y.begin(), 0.0),
                 after = std::inner_product(c.begin(), c.end(), c.begin(), 0.0);
    RC_ASSERT(std::abs(before - after) <= 1e-12 * before);
    CosineSums sums(y.size());
    std::copy(c.begin(), c.end(), sums.input().begin());
    const auto back = sums.transform();
    RC_ASSERT(near(Record(back.begin(), back.end()), y, 1e-13));
  });
}
TEST_CASE("property: a real transform and its inverse are n times the record") {
  holds([] {
    const Record y = record(2, 200);
    RealFft fft(y.size());
    std::copy(y.begin(), y.end(), fft.input().begin());
    const auto there = fft.transform();
    const std::vector<std::complex<double>> kept(there.begin(), there.end());
    std::copy(kept.begin(), kept.end(), fft.coefficients().begin());
    const auto back = fft.inverse();
    Record out(back.begin(), back.end());
    for (double& v : out) v /= static_cast<double>(y.size());
    RC_ASSERT(near(out, y, 1e-13));
  });
}
TEST_CASE("property: windows are symmetric about their middle") {
  holds([] {
    const auto n = static_cast<std::size_t>(*rc::gen::inRange(8, 300));
    const Record w = window_values(
        *rc::gen::element(Window::hann, Window::rectangular, Window::blackman_harris, Window::flat_top), n);
    for (std::size_t i = 1; i < n; ++i) RC_ASSERT(std::abs(w[i] - w[n - i]) < 1e-14);
  });
}
