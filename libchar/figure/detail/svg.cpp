// SVG 1.1: texts are <text>, in a family of fonts that all have the widths the layout was made with.

#include <fmt/format.h>

#include <cmath>

#include "libchar/core/numeric/whole.hpp"
#include "libchar/core/text/markup.hpp"
#include "libchar/core/text/text.hpp"
#include "libchar/figure/detail/drawing.hpp"

namespace libchar {
namespace {

std::string number(double value) {
  std::string out = fmt::format("{:.2f}", value);
  while (out.back() == '0') out.pop_back();
  if (out.back() == '.') out.pop_back();
  return out == "-0" ? "0" : out;
}

std::string hex(const Colour& c) {
  const auto part = [](double v) { return clamped_whole<int>(std::round(255 * v)); };
  return fmt::format("#{:02x}{:02x}{:02x}", part(c.red), part(c.green), part(c.blue));
}

/// Of the frame that is drawn in: names in one page differ.
std::string frame_name(const std::string& name) { return name.empty() ? "frame" : "frame-" + name; }

std::string tip_of(const DrawnPath& p, const std::string& name) {
  return name.empty() || p.tip.empty() ? "" : "<title>" + markup_entities(printable(p.tip)) + "</title>";
}

std::string looks(const DrawnPath& p, const std::string& name) {
  std::string out = p.filled ? fmt::format(" fill=\"{}\"", hex(p.fill)) : " fill=\"none\"";
  if (p.filled && p.opacity < 1) out += fmt::format(" fill-opacity=\"{}\"", number(p.opacity));
  if (p.stroked) {
    out += fmt::format(" stroke=\"{}\" stroke-width=\"{}\"", hex(p.stroke), number(p.width));
    if (!p.dash.empty()) {
      std::string dashes;
      for (const double d : p.dash) dashes += (dashes.empty() ? "" : " ") + number(d);
      out += fmt::format(" stroke-dasharray=\"{}\"", dashes);
    }
  }
  if (p.clipped) out += fmt::format(" clip-path=\"url(#{})\"", frame_name(name));
  return out;
}

std::string svg_path(const DrawnPath& p, const std::string& name) {
  std::string out;
  if (!p.lines.empty()) {
    std::string d;
    for (const std::vector<Place>& line : p.lines) {
      for (std::size_t i = 0; i < line.size(); ++i)
        d += fmt::format("{}{} {}", i == 0 ? "M" : i == 1 ? "L" : " ", number(line[i].x), number(line[i].y));
      if (p.filled) d += "Z";
    }
    const std::string tip = tip_of(p, name);
    out += fmt::format("<path d=\"{}\"{} stroke-linejoin=\"round\"", d, looks(p, name)) +
           (tip.empty() ? "/>\n" : ">" + tip + "</path>\n");
  }
  if (p.circles.empty()) return out;
  out += fmt::format("<g{}>{}\n", looks(p, name), tip_of(p, name));
  for (const Place& c : p.circles)
    out += fmt::format("<circle cx=\"{}\" cy=\"{}\" r=\"{}\"/>\n", number(c.x), number(c.y), number(p.radius));
  return out + "</g>\n";
}

std::string svg_text(const DrawnText& t) {
  constexpr const char* kAnchors[] = {"start", "middle", "end"};
  std::string out =
      t.upright ? fmt::format("<text transform=\"translate({} {}) rotate(-90)\"", number(t.at.x), number(t.at.y))
                : fmt::format("<text x=\"{}\" y=\"{}\"", number(t.at.x), number(t.at.y));
  if (t.anchor != Anchor::start)
    out += fmt::format(" text-anchor=\"{}\"", kAnchors[static_cast<std::size_t>(t.anchor)]);
  out += fmt::format(" font-size=\"{}\"", number(t.size));
  if (t.bold) out += " font-weight=\"bold\"";
  if (t.colour != Colour{}) out += fmt::format(" fill=\"{}\"", hex(t.colour));
  if (t.halo) out += " stroke=\"#ffffff\" stroke-width=\"1.8\" stroke-linejoin=\"round\" paint-order=\"stroke\"";
  out += ">";
  bool raised = false;
  for (const TextRun& run : t.runs) {
    const std::string down =
        raised != run.raised ? fmt::format(" dy=\"{}\"", number((run.raised ? -1 : 1) * kRaisedBy * t.size)) : "";
    raised = run.raised;
    const std::string size = run.raised ? fmt::format(" font-size=\"{}\"", number(kRaisedSize * t.size)) : "";
    out += down.empty() && size.empty() ? markup_entities(run.text)
                                        : fmt::format("<tspan{}{}>{}</tspan>", down, size, markup_entities(run.text));
  }
  return out + "</text>\n";
}

}  // namespace

std::string svg_of(const Drawing& drawing, const std::string& name) {
  const Box& f = drawing.frame;
  std::string about;
  for (const TextRun& run : text_runs(drawing.about)) about += run.text;
  // On a page its style says how large it is.
  const std::string file = fmt::format(
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{}pt\" height=\"{}pt\"",
      number(drawing.width), number(drawing.height));
  std::string out =
      (name.empty() ? file : "<svg") +
      fmt::format(
          " viewBox=\"0 0 {0} {1}\" role=\"img\" font-family=\"'{2}', Arial, Helvetica, "
          "sans-serif\">\n<title>{3}</title>\n"
          "<clipPath id=\"{8}\"><rect x=\"{4}\" y=\"{5}\" width=\"{6}\" height=\"{7}\"/></clipPath>\n",
          number(drawing.width), number(drawing.height), kFigureFont, markup_entities(about), number(f.left),
          number(f.top), number(f.right - f.left), number(f.bottom - f.top), frame_name(name));
  for (const DrawnPiece& piece : drawing.pieces)
    out += piece.is_text ? svg_text(piece.text) : svg_path(piece.path, name);
  return out + "</svg>\n";
}

}  // namespace libchar
