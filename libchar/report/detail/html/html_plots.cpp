// The figures of one channel's section: titles, axes, captions that say what is drawn. page.js draws into them.

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <set>

#include "libchar/characterize/curves/model_curve.hpp"
#include "libchar/core/text/readable.hpp"
#include "libchar/core/units.hpp"
#include "libchar/fit/remedies.hpp"
#include "libchar/report/detail/html/html_tables.hpp"
#include "libchar/spectrum/spectrum_words.hpp"

namespace libchar {
namespace {

// More curves than these would hide each other's intervals; page.js draws alike.
constexpr std::size_t kShadedChannels = 3;

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
  std::transform(scaling.begin(), scaling.end(), scaling.begin(),
                 [](char c) { return static_cast<char>(c - 'a' + 'A'); });
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
      "Blue: Welch's method, {} segment{} of {} samples ({}), {}, averaged in bins of equal width on the logarithmic "
      "axis, with the 95 % interval; the lowest bins are low because each segment's mean was removed. Line: fitted "
      "model. Dashed: its terms. Grey: left out of the fit, only shown.",
      count_text(s.segments), s.segments == 1 ? "" : "s", count_text(s.segment),
      duration_text(static_cast<double>(s.segment) / s.rate_hz), window_title(s.window));
}

}  // namespace

std::string plot_figure(const char* kind, const std::vector<std::size_t>& indices, const PlotText& text,
                        const std::string& of) {
  std::string all;
  for (const std::size_t index : indices) all += (all.empty() ? "" : ",") + std::to_string(index);
  return fmt::format(
      "<figure class=\"plot {0}\" data-kind=\"{0}\" data-channel=\"{1}\" data-channels=\"{2}\" data-axis=\"{3}\" "
      "data-unit=\"{4}\">\n<h3>{5}</h3>\n"
      "<div class=\"canvas\"><canvas role=\"img\" aria-label=\"{6} of "
      "{7}\"></canvas></div>\n<figcaption>{8}</figcaption>\n</figure>\n",
      kind, indices.front(), all, html_attribute(text.axis), html_attribute(text.unit), html_text(text.title),
      html_attribute(text.title), html_attribute(of), html_text(text.caption));
}

std::string plot_figure(const char* kind, std::size_t index, const PlotText& text, const std::string& channel) {
  return plot_figure(kind, std::vector<std::size_t>{index}, text, channel);
}

std::string trace_plot(const ChannelView& view, std::size_t index, const LogInfo& log) {
  const ChannelResult& c = *view.result;
  if (c.trace.low.size() < 2) return "";
  const std::string what =
      c.trace.block == 1
          ? "Every sample; the line is their running mean."
          : fmt::format("Range of every {} samples{}; the line is the running mean of its middle.",
                        count_text(c.trace.block),
                        log.rate_hz_of(c.channel) > 0
                            ? " (" + duration_text(static_cast<double>(c.trace.block) / log.rate_hz_of(c.channel)) + ")"
                            : "");
  const std::string marked = view.marks.empty() ? "" : " Marked: what was found in it and is not noise.";
  return plot_figure("trace", index, {c.channel.name, "", view.trace_unit, what + marked}, c.channel.name);
}

std::string group_plot(const CharacterizationView& view, const ChannelGroup& group) {
  std::vector<std::size_t> drawn;
  bool shaped = false;
  std::set<std::string> taken_out;
  for (const std::size_t i : group.channels) {
    if (!view.channels[i].in_detail) continue;
    if (view.channels[i].draws_allan) drawn.push_back(i);
    const auto& fit = view.channels[i].result->fit;
    if (fit && !fit->events.empty()) taken_out.insert("steps, warm-up and ramps");
    if (fit && find_remedy(*fit, "spikes") != nullptr) taken_out.insert("spikes");
    if (fit && find_remedy(*fit, "temperature") != nullptr) taken_out.insert("temperature");
    shaped = shaped || (view.channels[i].draws_allan && view.channels[i].plain_from_s > 0);
  }
  if (drawn.empty()) return "";
  const DeviationType type = view.channels[drawn[0]].result->allan.type;
  std::string caption = drawn.size() <= kShadedChannels
                            ? "Points: measured, hollow where unreliable; shaded: 95 % intervals; lines: fitted models."
                            : "Lines: measured. A click on a name hides its curve.";
  if (!taken_out.empty())
    caption += fmt::format(" Removed before the fit, so contained in the points but not in the models: {}.",
                           fmt::join(taken_out, "; "));
  if (shaped)
    caption +=
        " Grey on the left, one shade per channel: averaging times at which a filter or noise outside the band also "
        "shapes the curve.";
  return plot_figure("group", drawn,
                     {std::string(deviation_row(type).title), "deviation", shown_unit(group.unit), caption},
                     group.title.empty() ? "these channels" : group.title);
}

std::string curve_plots(const ChannelView& view, std::size_t index) {
  const ChannelResult& c = *view.result;
  const std::string& name = c.channel.name;
  std::string out = "<div class=\"plots\">\n";
  if (view.draws_allan)
    out += plot_figure(
        "allan", index,
        {std::string(deviation_row(c.allan.type).title), "deviation", view.shown_unit,
         "Points: measured, with 68 % and 95 % chi-square intervals; hollow where fewer than 5 degrees of freedom make "
         "them unreliable. Line: fitted model. Dashed: its terms; marked: where each coefficient is read off. Grey: "
         "outside the band in which the terms were fitted."},
        name);
  if (view.draws_spectrum)
    out += plot_figure("spectrum", index,
                       {spectrum_title(c.spectrum), spectrum_axis(c.spectrum),
                        spectrum_unit(c.spectrum.scaling, view.unit), spectrum_caption(c.spectrum)},
                       name);
  return out + "</div>\n";
}

}  // namespace libchar
