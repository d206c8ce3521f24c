// The figures of one channel's section: titles, axes, captions that say what is drawn. page.js
// draws into them.

#include "libchar/report/detail/html_plots.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "libchar/characterize/model_curve.hpp"
#include "libchar/core/readable.hpp"
#include "libchar/report/detail/escape.hpp"

namespace libchar {
namespace {

std::string spectrum_title(const Spectrum& s) {
  const char* sides = s.sides == Sides::one ? "One-sided" : "Two-sided";
  switch (s.scaling) {
    case Scaling::psd:
      return fmt::format("{} power spectral density", sides);
    case Scaling::ps:
      return fmt::format("{} power spectrum", sides);
    case Scaling::lsd:
      return fmt::format("{} linear spectral density", sides);
    case Scaling::ls:
      return fmt::format("{} linear spectrum", sides);
  }
  return sides;
}

std::string spectrum_axis(const Spectrum& s) {
  std::string scaling(name_of(s.scaling));
  std::transform(scaling.begin(), scaling.end(), scaling.begin(), [](char c) {
    return static_cast<char>(c - 'a' + 'A');
  });
  return (s.sides == Sides::one ? "one-sided " : "two-sided ") + scaling;
}

std::string window_title(Window window) {
  switch (window) {
    case Window::hann:
      return "Hann window";
    case Window::rectangular:
      return "no window";
    case Window::blackman_harris:
      return "Blackman–Harris window";
    case Window::flat_top:
      return "flat-top window";
    case Window::hann_nonzero:
      return "Hann window without its zeros";
  }
  return "";
}

// What is drawn, in full: two programs agree only when these do.
std::string spectrum_caption(const Spectrum& s) {
  return fmt::format(
      "Blue: Welch's method, {} segment{} of {} samples ({}), {}, averaged in bins of equal width "
      "on the "
      "logarithmic axis, with the 95 % interval; the lowest bins are low where each segment's mean "
      "was removed. "
      "Line: fitted model. Dashed: its terms.",
      count_text(s.segments),
      s.segments == 1 ? "" : "s",
      count_text(s.segment),
      duration_text(static_cast<double>(s.segment) / s.rate_hz),
      window_title(s.window));
}

}  // namespace

std::string plot_figure(const char* kind,
                        std::size_t index,
                        const PlotText& text,
                        const std::string& channel) {
  return fmt::format(
      "<figure class=\"plot {0}\" data-kind=\"{0}\" data-channel=\"{1}\" data-axis=\"{2}\" "
      "data-unit=\"{3}\">\n<h3>{4}</h3>\n"
      "<div class=\"canvas\"><canvas role=\"img\" aria-label=\"{5} of "
      "{6}\"></canvas></div>\n<figcaption>{7}</figcaption>\n</figure>\n",
      kind,
      index,
      html_attribute(text.axis),
      html_attribute(text.unit),
      html_text(text.title),
      html_attribute(text.title),
      html_attribute(channel),
      html_text(text.caption));
}

std::string curve_plots(const ChannelView& view, std::size_t index) {
  const ChannelResult& c = *view.result;
  const std::string& name = c.channel.name;
  std::string out = "<div class=\"plots\">\n";
  if (view.draws_allan)
    out += plot_figure("allan",
                       index,
                       {std::string(deviation_row(c.allan.type).title),
                        std::string(name_of(c.allan.type)),
                        view.unit.empty() ? "U" : view.unit,
                        "Points: measured, with 68 % and 95 % chi-square intervals; hollow where "
                        "fewer than 5 degrees of freedom make them unreliable. Line: fitted model. "
                        "Dashed: its terms; marked: where each coefficient is read off."},
                       name);
  if (view.draws_spectrum)
    out += plot_figure("spectrum",
                       index,
                       {spectrum_title(c.spectrum),
                        spectrum_axis(c.spectrum),
                        spectrum_unit(c.spectrum.scaling, view.unit),
                        spectrum_caption(c.spectrum)},
                       name);
  return out + "</div>\n";
}

}  // namespace libchar
