// usage: consumer [LOG…]; prints two known answers, then the number of channels of each log.

#include <cstdio>
#include <vector>

#include "libchar/figure/draw_figure.hpp"
#include "libchar/figure/make_figure.hpp"
#include "libchar/libchar.hpp"

int main(int argc, char** argv) {
  const std::vector<double> ramp = {0, 1, 2, 3, 4, 5, 6, 7};
  const libchar::AllanCurve curve = libchar::allan_deviation(ramp, 1.0);
  libchar::SensorModel model;
  model.noise[0].value = 0.1;
  libchar::SimulateOptions options;
  options.rate_hz = 100;
  options.duration_s = 100;
  const libchar::Recording recording = libchar::simulate(model, options);
  const libchar::NoiseFit fit = libchar::fit(recording.channel(0), options.rate_hz);
  // A ramp of slope 1: tau / sqrt 2. The white noise that was put in, to a digit.
  std::printf("%.6f %.1f", curve.points.at(0).deviation, fit[libchar::Term::white].value.value_or(0));
  // Readers and figures link libraries of their own, which the package has to name as well.
  for (int i = 1; i < argc; ++i) std::printf(" %zu", libchar::read_recording(argv[i]).samples.size());
  std::printf("\n");
  libchar::FigureSource source;
  source.curves.push_back(libchar::source_curve("ramp", "m", curve));
  const auto format = libchar::draws_with_cairo() ? libchar::FigureFormat::pdf : libchar::FigureFormat::svg;
  libchar::Findings warnings;
  const libchar::Chart figure = libchar::make_figure({&source, 1}, {});
  return libchar::draw_figure(figure, format, {}, warnings).empty() ? 1 : 0;
}
