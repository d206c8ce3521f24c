#include "libchar/figure/draw_figure.hpp"

#include <fmt/format.h>

#include <span>

#include "libchar/core/file/crc32.hpp"
#include "libchar/core/refusal.hpp"
#include "libchar/figure/detail/drawing.hpp"
#include "libchar/figure/detail/scale.hpp"

namespace libchar {

bool draws_with_cairo() { return has_cairo(); }

std::string draw_figure(const Chart& figure, FigureFormat format, const DrawingOptions& options, Findings& warnings) {
  if (format != FigureFormat::svg && !has_cairo())
    throw usage_error("E0980")
        .says("{} is drawn by Cairo, which this program was built without", name_of(format))
        .hint("ask for .svg, or build with Debian's package libcairo2-dev");
  const Drawing drawing = lay_out(figure, options);
  if (format == FigureFormat::svg) return svg_of(drawing);
  if (format == FigureFormat::pdf) return pdf_of(drawing, warnings);
  return png_of(drawing, options.dpi, warnings);
}

std::string draw_figure(const Chart& figure, const DrawingOptions& options) {
  const auto bytes = std::as_bytes(std::span(figure.about));
  return svg_of(lay_out(figure, options), fmt::format("{:08x}", crc32_of(bytes)));
}

}  // namespace libchar
