#include "libchar/report/detail/svg/svg_lot.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numbers>

#include "libchar/core/text/decimal.hpp"
#include "libchar/core/text/readable.hpp"
#include "libchar/report/detail/escape.hpp"

namespace libchar {
namespace {

constexpr double kLotWidth = 560, kLotHeight = 250, kLotLeft = 84, kLotRight = 12, kLotTop = 16,
                 kLotBottom = 44;

/// Of one axis: values as they stand on it, and where that is in the drawing.
struct Scale {
  double low = 0, high = 1, from = 0, to = 1;
  double at(double value) const { return from + (to - from) * (value - low) / (high - low); }
};

Scale scale_of(double low, double high, double from, double to) {
  if (!(high > low)) {
    const double half = std::max(std::abs(low) * 0.05, 1e-9);
    low -= half;
    high += half;
  }
  const double margin = 0.03 * (high - low);
  return {low - margin, high + margin, from, to};
}

/// Some five round numbers of a stretch.
std::vector<double> round_numbers(double low, double high) {
  const double rough = (high - low) / 5, power = std::pow(10.0, std::floor(std::log10(rough)));
  double step = power;
  for (const double factor : {1.0, 2.0, 5.0, 10.0})
    if (step < rough) step = factor * power;
  std::vector<double> out;
  for (double k = std::ceil(low / step); k * step <= high && out.size() < 12; ++k)
    out.push_back(k * step);
  return out;
}

/// Values with a label, of an axis of logarithms or of values.
std::vector<double> ticks_of(const Scale& scale, bool logarithm) {
  if (!logarithm) return round_numbers(scale.low, scale.high);
  const double low = std::exp(scale.low), high = std::exp(scale.high);
  if (high / low < 4) return round_numbers(low, high);
  // In decades, which are finite where the values are not any more.
  const double first = scale.low / std::numbers::ln10, last = scale.high / std::numbers::ln10;
  const int step = std::max(1, static_cast<int>((last - first) / 6));
  std::vector<double> out;
  const bool few = high / low < 300;
  for (int e = static_cast<int>(std::floor(first)); e <= std::ceil(last); e += step)
    for (const int digit : {1, 2, 3, 5, 7}) {
      const double value = digit * std::pow(10.0, e);
      const bool shown = digit == 1 || (few && digit % 3 == 2) || high / low < 20;
      if (value >= low && value <= high && shown && value > 0 && std::isfinite(value))
        out.push_back(value);
    }
  return out;
}

std::string line(const char* css, double x1, double y1, double x2, double y2) {
  return fmt::format("<line class=\"{}\" x1=\"{:.1f}\" y1=\"{:.1f}\" x2=\"{:.1f}\" y2=\"{:.1f}\"/>",
                     css,
                     x1,
                     y1,
                     x2,
                     y2);
}

std::string label(double x, double y, const char* anchor, const std::string& text) {
  return fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"{}\">{}</text>",
                     x,
                     y,
                     anchor,
                     html_text(text));
}

std::string opening(const std::string& title) {
  return fmt::format(
      "<figure class=\"curves lot\">\n<svg viewBox=\"0 0 {} {}\" role=\"img\" aria-label=\"{}\">\n",
      kLotWidth,
      kLotHeight,
      html_attribute(title));
}

/// As few digits as the number has.
std::string tick_text(double value) {
  for (int digits = 1; digits < 5; ++digits)
    if (std::abs(rounded(value, digits) - value) < 1e-6 * std::abs(value))
      return number_text(value, digits);
  return number_text(value, 3);
}

std::string values_axis(const Scale& scale, const LotAxis& axis, bool vertical) {
  std::string out;
  for (const double value : ticks_of(scale, axis.logarithm)) {
    const double at = scale.at(axis.logarithm ? std::log(value) : value);
    const std::string text = tick_text(value);
    out += vertical ? line("fine", kLotLeft, at, kLotWidth - kLotRight, at) +
                          label(kLotLeft - 6, at + 4, "end", text)
                    : line("fine", at, kLotTop, at, kLotHeight - kLotBottom) +
                          label(at, kLotHeight - kLotBottom + 16, "middle", text);
  }
  const double middle = (kLotTop + kLotHeight - kLotBottom) / 2;
  return out + (vertical ? fmt::format("<text class=\"axis\" transform=\"translate(13 {}) "
                                       "rotate(-90)\" text-anchor=\"middle\">{}</text>",
                                       middle,
                                       html_text(axis.title))
                         : fmt::format("<text class=\"axis\" x=\"{}\" y=\"{}\" "
                                       "text-anchor=\"middle\">{}</text>",
                                       (kLotLeft + kLotWidth - kLotRight) / 2,
                                       kLotHeight - 8,
                                       html_text(axis.title)));
}

std::string bars(const Histogram& h, const Scale& x, const Scale& y) {
  std::string out;
  for (std::size_t k = 0; k < h.count.size(); ++k) {
    if (h.count[k] == 0) continue;
    const double left = x.at(h.low + h.step * static_cast<double>(k)),
                 right = x.at(h.low + h.step * static_cast<double>(k + 1)),
                 top = y.at(static_cast<double>(h.count[k]));
    out += fmt::format(
        "<rect class=\"bar\" x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\"/>",
        left,
        top,
        std::max(right - left - 0.6, 0.6),
        y.from - top);
  }
  return out;
}

/// A word over a place on the axis; what is beyond the axis stands at its end as an arrow.
struct Mark {
  double at = 0;      ///< of the line
  bool drawn = true;  ///< its line is in the picture
  const char* css = "";
  std::string text;
  double left = 0, right = 0;  ///< of the word
};

Mark mark_of(double value, const char* word, const Scale& x) {
  constexpr double kLetter = 6.5;  // of the page's font in the drawing
  Mark out;
  out.css = word;
  const bool beyond = value > x.high, before = value < x.low;
  out.drawn = !beyond && !before;
  out.at = std::clamp(x.at(value), kLotLeft, kLotWidth - kLotRight);
  out.text = beyond   ? std::string(word) + " →"
             : before ? "← " + std::string(word)
                      : std::string(word);
  const double width = kLetter * static_cast<double>(std::strlen(word) + (out.drawn ? 0 : 2));
  out.left = beyond ? out.at - width : before ? out.at : out.at - width / 2;
  out.right = out.left + width;
  return out;
}

/// Words that would stand on each other stand side by side.
void move_apart(Mark& a, Mark& b) {
  constexpr double kGap = 6;
  Mark &first = a.at <= b.at ? a : b, &second = a.at <= b.at ? b : a;
  const double overlap = first.right + kGap - second.left;
  if (overlap <= 0) return;
  const double room = std::max(0.0, kLotWidth - kLotRight - second.right);
  const double right = std::min(overlap / 2, room);
  first.left -= overlap - right;
  first.right -= overlap - right;
  second.left += right;
  second.right += right;
}

/// The mean and the limit, each with its word.
std::string marks(const LotAxis& axis, const Scale& x) {
  std::vector<Mark> all;
  if (axis.mean) all.push_back(mark_of(*axis.mean, "mean", x));
  if (axis.limit) all.push_back(mark_of(*axis.limit, "limit", x));
  if (all.size() == 2) move_apart(all[0], all[1]);
  std::string out;
  for (const Mark& m : all) {
    if (m.drawn) out += line(m.css, m.at, kLotTop, m.at, kLotHeight - kLotBottom);
    out += label((m.left + m.right) / 2, kLotTop - 4, "middle", m.text);
  }
  return out;
}

std::string closing(const std::string& caption) {
  return "\n</svg>\n<figcaption>" + html_text(caption) + "</figcaption>\n</figure>\n";
}

Scale chart_scale(const ControlChart& chart, const LotAxis& axis) {
  double low = chart.limits.low, high = chart.limits.high;
  for (const ChartPoint& p : chart.points) {
    low = std::min(low, p.low);
    high = std::max(high, p.high);
  }
  // A limit far away would squeeze the chart; one that is near is shown.
  if (axis.limit && *axis.limit < high + (high - low) && *axis.limit > low - (high - low)) {
    low = std::min(low, *axis.limit);
    high = std::max(high, *axis.limit);
  }
  return scale_of(low, high, kLotHeight - kLotBottom, kLotTop);
}

std::string chart_values(const ControlChart& chart, const Scale& x, const Scale& y) {
  const auto place = [](const ChartPoint& p) {
    return static_cast<double>(p.first) + (static_cast<double>(p.count) - 1) / 2;
  };
  std::string band, back, means, dots;
  bool single = true;
  for (const ChartPoint& p : chart.points) {
    single = single && p.count == 1;
    band += fmt::format("{:.1f},{:.1f} ", x.at(place(p)), y.at(p.high));
    back = fmt::format("{:.1f},{:.1f} ", x.at(place(p)), y.at(p.low)) + back;
    means += fmt::format("{:.1f},{:.1f} ", x.at(place(p)), y.at(p.mean));
    dots += fmt::format("<circle class=\"value\" cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"1.8\"/>",
                        x.at(place(p)),
                        y.at(p.mean));
  }
  const std::string lines = "<polyline class=\"values\" points=\"" + means + "\"/>";
  return single ? lines + dots : "<polygon class=\"band\" points=\"" + band + back + "\"/>" + lines;
}

/// Drawings stay small: of very many the furthest.
constexpr std::size_t kMostMarks = 150;

std::string marks_beyond(const ControlChart& chart,
                         const std::vector<std::string>& names,
                         const Scale& x,
                         const Scale& y) {
  std::vector<std::size_t> order(chart.beyond.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return std::abs(chart.beyond[a].value - chart.centre) >
           std::abs(chart.beyond[b].value - chart.centre);
  });
  if (order.size() > kMostMarks) order.resize(kMostMarks);
  std::string out;
  for (const std::size_t i : order)
    out += fmt::format(
        "<circle class=\"beyond\" cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"3.2\"><title>{}</title></circle>",
        x.at(static_cast<double>(chart.beyond[i].index)),
        y.at(chart.beyond[i].value),
        html_text(names[i]));
  return out;
}

/// What the zone rules found, and whether that is more than chance brings.
std::string zones_text(const ControlChart& chart, std::size_t values) {
  if (!(chart.sigma > 0)) return "All values are alike.";
  const char* const names[kZoneRules] = {"beyond 3 σ (dashed)",
                                         "two of three beyond 2 σ",
                                         "four of five beyond 1 σ",
                                         "eight in a row on one side"};
  std::string list, alarms;
  for (std::size_t r = 0; r < kZoneRules; ++r) {
    const ZoneFinding& found = chart.zones.rule[r];
    list += fmt::format("{}{} {} ({})",
                        r == 0 ? "" : ", ",
                        names[r],
                        count_text(found.signals),
                        number_text(found.by_chance, 2));
    if (found.alarm)
      alarms +=
          fmt::format("{}{} ({})", alarms.empty() ? "" : ", ", names[r], probability_text(found.p));
  }
  const std::string end =
      alarms.empty()
          ? fmt::format(
                "No alarm: {} % of charts of as many values show some signal though nothing "
                "changed.",
                number_text(100 * chart.zones.any_by_chance, 2))
          : "Alarm, more than chance brings: " + alarms + ".";
  return fmt::format(
      "{} values, mean and σ of the moving range. Signals (expected by chance): {}. {}",
      count_text(values),
      list,
      end);
}

}  // namespace

std::string svg_histogram(const Histogram& h, const LotAxis& axis, const std::string& title) {
  if (h.count.empty()) return "";
  double low = h.low, high = h.low + h.step * static_cast<double>(h.count.size());
  // A limit near the values belongs into the picture.
  if (axis.limit && *axis.limit < high + (high - low) && *axis.limit > low - (high - low)) {
    low = std::min(low, *axis.limit);
    high = std::max(high, *axis.limit);
  }
  const auto most = static_cast<double>(*std::max_element(h.count.begin(), h.count.end()));
  const Scale x = scale_of(low, high, kLotLeft, kLotWidth - kLotRight);
  const Scale y{0, std::max(most, 1.0) * 1.05, kLotHeight - kLotBottom, kLotTop};
  std::string out = opening(title) + values_axis(x, axis, false);
  for (const double n : round_numbers(0, y.high))
    if (n == std::floor(n))
      out += line("fine", kLotLeft, y.at(n), kLotWidth - kLotRight, y.at(n)) +
             label(kLotLeft - 6, y.at(n) + 4, "end", count_text(static_cast<std::uint64_t>(n)));
  out += bars(h, x, y) + marks(axis, x);
  std::string caption = "How many devices have which value";
  if (h.below + h.above > 0)
    caption += fmt::format("; {} further off to the left, {} to the right", h.below, h.above);
  return out + closing(caption + ".");
}

std::string svg_control_chart(const ControlChart& chart,
                              std::size_t values,
                              const LotAxis& axis,
                              const std::vector<std::string>& beyond,
                              const std::vector<ChartBound>& bounds,
                              const std::string& title) {
  const Scale x{-0.5, static_cast<double>(values) - 0.5, kLotLeft, kLotWidth - kLotRight};
  const Scale y = chart_scale(chart, axis);
  std::string out = opening(title) + values_axis(y, axis, true);
  for (const ChartBound& bound : bounds) {
    const double at = x.at(static_cast<double>(bound.index) - 0.5);
    out += line("bound", at, kLotTop, at, kLotHeight - kLotBottom);
    if (bounds.size() <= 6) out += label(at, kLotTop - 4, "start", bound.name);
  }
  out += chart_values(chart, x, y);
  for (const double value : {chart.limits.low, chart.limits.high})
    out += line("control", kLotLeft, y.at(value), kLotWidth - kLotRight, y.at(value));
  out += line("mean", kLotLeft, y.at(chart.centre), kLotWidth - kLotRight, y.at(chart.centre));
  if (axis.limit && *axis.limit > y.low && *axis.limit < y.high)
    out += line("limit", kLotLeft, y.at(*axis.limit), kLotWidth - kLotRight, y.at(*axis.limit)) +
           label(kLotWidth - kLotRight, y.at(*axis.limit) - 3, "end", "limit");
  out += marks_beyond(chart, beyond, x, y);
  out += fmt::format(
      "<text class=\"axis\" x=\"{}\" y=\"{}\" text-anchor=\"middle\">devices by batch and "
      "name</text>",
      (kLotLeft + kLotWidth - kLotRight) / 2,
      kLotHeight - 8);
  out += label(kLotLeft, kLotHeight - kLotBottom + 16, "start", "1") +
         label(kLotWidth - kLotRight, kLotHeight - kLotBottom + 16, "end", count_text(values));
  return out + closing(zones_text(chart, values));
}

}  // namespace libchar
