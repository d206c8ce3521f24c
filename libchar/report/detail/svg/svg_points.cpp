#include "libchar/report/detail/svg/svg_points.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "libchar/core/text/text_table.hpp"
#include "libchar/report/detail/escape.hpp"
#include "libchar/report/detail/svg/svg_frame.hpp"

namespace libchar {
namespace {

// Okabe & Ito's blue and vermilion.
constexpr const char *kOurs = "#0072b2", *kOthers = "#d55e00";
constexpr double kLetter = 6.4, kLine = 13, kRightEnd = 746;

struct Box {
  double left, top, right, bottom;
  bool meets(const Box& o) const {
    return left < o.right && o.left < right && top < o.bottom && o.top < bottom;
  }
};

/// The first place beside the point where nothing stands yet; above, below, left, right, then further off.
Box place_of(double x, double y, double width, const std::vector<Box>& taken) {
  Box best{};
  for (const double far : {0.0, 1.0, 2.0, 3.0})
    for (const auto& [dx, dy] : {std::pair{8.0, -kLine / 2 - far * kLine},
                                 std::pair{8.0, -kLine / 2 + far * kLine},
                                 std::pair{-8.0 - width, -kLine / 2 - far * kLine},
                                 std::pair{-8.0 - width, -kLine / 2 + far * kLine}}) {
      const Box box{x + dx, y + dy, x + dx + width, y + dy + kLine};
      if (box.left < 80 || box.right > kRightEnd) continue;
      if (std::none_of(taken.begin(), taken.end(), [&](const Box& b) { return b.meets(box); }))
        return box;
      if (best.right == 0) best = box;
    }
  return best;
}

double limited(double value, double otherwise) {
  return std::isfinite(value) && value > 0 ? value : otherwise;
}

SvgFrame frame_of(const BenchChart& chart) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  double x0 = kInfinity, x1 = 0, y0 = kInfinity, y1 = 0;
  for (const BenchPoint& p : chart.points) {
    if (!drawable(p.x, p.y)) continue;
    x0 = std::min(x0, limited(p.x95.low, p.x));
    x1 = std::max(x1, limited(p.x95.high, p.x));
    y0 = std::min(y0, limited(p.y95.low, p.y));
    y1 = std::max(y1, limited(p.y95.high, p.y));
  }
  return svg_frame(x0, x1, y0, y1);
}

/// Steps through the points of the front: what can be had for at most so much.
std::string front_line(const BenchChart& chart, const SvgFrame& frame, bool told) {
  std::vector<BenchPoint> front;
  std::copy_if(
      chart.points.begin(),
      chart.points.end(),
      std::back_inserter(front),
      [&](const BenchPoint& p) { return p.on_front && p.told == told && drawable(p.x, p.y); });
  std::sort(front.begin(), front.end(), [](const auto& a, const auto& b) { return a.x < b.x; });
  std::string points;
  for (std::size_t i = 0; i < front.size(); ++i) {
    if (i > 0)
      points += fmt::format("{:.1f},{:.1f} ", frame.x.at(front[i].x), frame.y.at(front[i - 1].y));
    points += fmt::format("{:.1f},{:.1f} ", frame.x.at(front[i].x), frame.y.at(front[i].y));
  }
  return "<polyline fill=\"none\" stroke=\"currentColor\" stroke-dasharray=\"6 4\" "
         "stroke-width=\"1.2\" points=\"" +
         points + "\"/>\n";
}

std::string bars(const BenchPoint& p, const SvgFrame& frame, const char* colour) {
  const double x = frame.x.at(p.x), y = frame.y.at(p.y);
  std::string out;
  const auto bar = [&](double x1, double y1, double x2, double y2) {
    out += fmt::format(
        "<line stroke=\"{}\" stroke-width=\"1\" x1=\"{:.1f}\" y1=\"{:.1f}\" x2=\"{:.1f}\" "
        "y2=\"{:.1f}\"/>",
        colour,
        x1,
        y1,
        x2,
        y2);
  };
  if (drawable(p.x95.low, p.x95.high)) bar(frame.x.at(p.x95.low), y, frame.x.at(p.x95.high), y);
  if (drawable(p.y95.low, p.y95.high)) bar(x, frame.y.at(p.y95.low), x, frame.y.at(p.y95.high));
  return out;
}

}  // namespace

std::string svg_points(const BenchChart& chart, const std::string& title) {
  if (std::none_of(chart.points.begin(), chart.points.end(), [](const BenchPoint& p) {
        return drawable(p.x, p.y);
      }))
    return "";
  const SvgFrame frame = frame_of(chart);
  std::string out =
      svg_opening(frame, title) + front_line(chart, frame, false) + front_line(chart, frame, true);
  std::vector<Box> taken;
  for (const BenchPoint& p : chart.points)
    if (drawable(p.x, p.y)) {
      const double x = frame.x.at(p.x), y = frame.y.at(p.y);
      taken.push_back({x - 5, y - 5, x + 5, y + 5});
    }
  for (const BenchPoint& p : chart.points) {
    if (!drawable(p.x, p.y)) continue;
    const double x = frame.x.at(p.x), y = frame.y.at(p.y);
    const char* colour = p.is_ours ? kOurs : kOthers;
    const Box label = place_of(x, y, kLetter * static_cast<double>(width_of(p.name)), taken);
    taken.push_back(label);
    out += bars(p, frame, colour);
    out += fmt::format(
        "<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"{}\" fill=\"{}\" stroke=\"{}\" "
        "stroke-width=\"1.5\"/>",
        x,
        y,
        p.on_front ? 5 : 3.5,
        p.told ? "#ffffff" : colour,
        colour);
    out += fmt::format(
        "<text x=\"{:.1f}\" y=\"{:.1f}\" paint-order=\"stroke\" stroke=\"#ffffff\" "
        "stroke-width=\"3\">{}</text>\n",
        label.left,
        label.bottom - 3,
        html_text(p.name));
  }
  return out + svg_closing(chart.x, chart.y) +
         "<figcaption>Lower and further left is better. Dashed: the front, on which nobody is "
         "better in both; large: on it. Lines: 95 % intervals. Blue: this program; orange: recipes "
         "of others. Open: told which terms there are, with a front of their "
         "own.</figcaption>\n</figure>\n";
}

}  // namespace libchar
