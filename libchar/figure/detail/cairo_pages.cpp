#include "libchar/figure/detail/drawing.hpp"

#ifdef LIBCHAR_CAIRO
#include <cairo-ft.h>
#include <cairo-pdf.h>
#include <cairo.h>
#include <fmt/format.h>
#include <fontconfig/fontconfig.h>

#include <algorithm>
#include <boost/crc.hpp>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <ctime>
#include <functional>
#include <memory>
#include <numbers>

#include "libchar/core/numeric/whole.hpp"
#include "libchar/core/process/late_library.hpp"
#include "libchar/core/process/version.hpp"
#include "libchar/core/refusal.hpp"
#include "libchar/core/text/decimal.hpp"

namespace libchar {
namespace {

#ifdef LIBCHAR_LATE_CAIRO
detail::LateLibrary cairo(LIBCHAR_LATE_CAIRO), fontconfig(LIBCHAR_LATE_FONTCONFIG);
#define L(name) LIBCHAR_LATE(cairo, name);
// clang-format off
L(cairo_arc) L(cairo_clip) L(cairo_close_path) L(cairo_create) L(cairo_destroy) L(cairo_fill)
L(cairo_font_face_destroy) L(cairo_font_options_create) L(cairo_font_options_destroy)
L(cairo_font_options_set_antialias) L(cairo_font_options_set_hint_metrics) L(cairo_font_options_set_hint_style)
L(cairo_ft_font_face_create_for_pattern) L(cairo_image_surface_create) L(cairo_line_to) L(cairo_move_to)
L(cairo_new_path) L(cairo_new_sub_path) L(cairo_paint) L(cairo_pdf_surface_create_for_stream)
L(cairo_pdf_surface_set_metadata) L(cairo_rectangle) L(cairo_restore) L(cairo_rotate) L(cairo_save) L(cairo_scale)
L(cairo_set_dash) L(cairo_set_font_face) L(cairo_set_font_options) L(cairo_set_font_size) L(cairo_set_line_join)
L(cairo_set_line_width) L(cairo_set_source_rgba) L(cairo_show_page) L(cairo_show_text) L(cairo_status)
L(cairo_status_to_string) L(cairo_stroke) L(cairo_surface_destroy) L(cairo_surface_finish) L(cairo_surface_status)
L(cairo_surface_write_to_png_stream) L(cairo_text_extents) L(cairo_text_path) L(cairo_translate)
// clang-format on
#undef L
#define L(name) LIBCHAR_LATE(fontconfig, name);
    // clang-format off
L(FcConfigSubstitute) L(FcDefaultSubstitute) L(FcFontMatch) L(FcPatternAddBool) L(FcPatternAddInteger)
L(FcPatternAddString) L(FcPatternCreate) L(FcPatternDestroy) L(FcPatternGetString)
// clang-format on
#undef L
            bool is_here() {
  return cairo.is_here() && fontconfig.is_here();
}
#else
bool is_here() { return true; }
#endif

struct SurfaceCloser {
  void operator()(cairo_surface_t* surface) const { cairo_surface_destroy(surface); }
};
struct PenCloser {
  void operator()(cairo_t* pen) const { cairo_destroy(pen); }
};
struct FaceCloser {
  void operator()(cairo_font_face_t* face) const { cairo_font_face_destroy(face); }
};
struct PatternCloser {
  void operator()(FcPattern* pattern) const { FcPatternDestroy(pattern); }
};
struct OptionsCloser {
  void operator()(cairo_font_options_t* options) const { cairo_font_options_destroy(options); }
};
using Surface = std::unique_ptr<cairo_surface_t, SurfaceCloser>;
using Pen = std::unique_ptr<cairo_t, PenCloser>;
using Face = std::unique_ptr<cairo_font_face_t, FaceCloser>;
using Pattern = std::unique_ptr<FcPattern, PatternCloser>;

struct Faces {
  Face plain, bold;
};

Face face_of(bool bold, std::string& family) {
  const Pattern wanted(FcPatternCreate());
  FcPatternAddString(wanted.get(), FC_FAMILY, reinterpret_cast<const FcChar8*>(kFigureFont));
  FcPatternAddInteger(wanted.get(), FC_WEIGHT, bold ? FC_WEIGHT_BOLD : FC_WEIGHT_REGULAR);
  FcPatternAddInteger(wanted.get(), FC_SLANT, FC_SLANT_ROMAN);
  FcPatternAddBool(wanted.get(), FC_SCALABLE, FcTrue);
  FcConfigSubstitute(nullptr, wanted.get(), FcMatchPattern);
  FcDefaultSubstitute(wanted.get());
  FcResult result = FcResultNoMatch;
  const Pattern found(FcFontMatch(nullptr, wanted.get(), &result));
  FcChar8* name = nullptr;
  if (!found || FcPatternGetString(found.get(), FC_FAMILY, 0, &name) != FcResultMatch)
    throw output_error("E0986")
        .says("no font is installed that a PDF or PNG could have its text in")
        .hint("install Debian's package fonts-liberation2; an SVG needs none");
  family = reinterpret_cast<const char*>(name);
  return Face(cairo_ft_font_face_create_for_pattern(found.get()));
}

Faces faces_of(Findings& warnings) {
  Faces out;
  std::string plain, bold;
  out.plain = face_of(false, plain);
  out.bold = face_of(true, bold);
  if (plain != kFigureFont)
    warnings.add("figure_font",
                 fmt::format("the font {} is not installed (Debian's package fonts-liberation2): text is set in {}, "
                             "whose letters are not as wide as the layout takes them to be",
                             kFigureFont, plain));
  return out;
}

void set_colour(cairo_t* pen, const Colour& c, double opacity = 1) {
  cairo_set_source_rgba(pen, c.red, c.green, c.blue, opacity);
}

/// Points or shapes that are painted at a time. Cairo's time grows with the crossings among the lines of one path:
/// in parts it is linear in the number of points.
constexpr std::size_t kPart = 256;

void trace(cairo_t* pen, const std::vector<Place>& line) {
  for (std::size_t i = 0; i < line.size(); ++i)
    i == 0 ? cairo_move_to(pen, line[i].x, line[i].y) : cairo_line_to(pen, line[i].x, line[i].y);
}

/// Filled shapes, so many at a time; `paint_part` paints the path and leaves none.
void trace_shapes(cairo_t* pen, const DrawnPath& p, const std::function<void()>& paint_part) {
  std::size_t count = 0;
  const auto one_more = [&] {
    cairo_close_path(pen);
    if (p.opacity == 1 && ++count % kPart == 0) paint_part();
  };
  for (const std::vector<Place>& line : p.lines) {
    trace(pen, line);
    one_more();
  }
  for (const Place& c : p.circles) {
    cairo_new_sub_path(pen);
    cairo_arc(pen, c.x, c.y, p.radius, 0, 2 * std::numbers::pi);
    one_more();
  }
  paint_part();
}

void stroke_part(cairo_t* pen, const DrawnPath& p, double dash_begins) {
  cairo_set_dash(pen, p.dash.data(), static_cast<int>(p.dash.size()), dash_begins);
  cairo_stroke(pen);
}

/// An open line in parts that share one stretch, so that its corners are joined and its dashes go on.
void stroke_line(cairo_t* pen, const DrawnPath& p, const std::vector<Place>& line) {
  double length = 0;  // before the part
  for (std::size_t begin = 0; begin == 0 || begin + 2 < line.size(); begin += kPart) {
    const std::size_t end = std::min(begin + kPart + 2, line.size());
    double beyond = length;
    for (std::size_t i = begin; i < end; ++i) {
      i == begin ? cairo_move_to(pen, line[i].x, line[i].y) : cairo_line_to(pen, line[i].x, line[i].y);
      if (i > begin && i <= begin + kPart) beyond += std::hypot(line[i].x - line[i - 1].x, line[i].y - line[i - 1].y);
    }
    stroke_part(pen, p, length);
    length = beyond;
  }
}

void stroke_lines(cairo_t* pen, const DrawnPath& p) {
  std::size_t points = 0;
  for (const std::vector<Place>& line : p.lines) {
    if (points + line.size() > kPart) {
      stroke_part(pen, p, 0);
      points = 0;
    }
    if (line.size() > kPart) {
      stroke_line(pen, p, line);
    } else {
      trace(pen, line);
      points += line.size();
    }
  }
  stroke_part(pen, p, 0);
}

void paint(cairo_t* pen, const DrawnPath& p, const Box& frame) {
  cairo_save(pen);
  // A path stays after it was filled, and restoring does not take it away.
  cairo_new_path(pen);
  if (p.clipped) {
    cairo_rectangle(pen, frame.left, frame.top, frame.right - frame.left, frame.bottom - frame.top);
    cairo_clip(pen);
  }
  if (p.filled) {
    set_colour(pen, p.fill, p.opacity);
    trace_shapes(pen, p, [&] { cairo_fill(pen); });
  }
  if (p.stroked) {
    set_colour(pen, p.stroke);
    cairo_set_line_width(pen, p.width);
    cairo_set_line_join(pen, CAIRO_LINE_JOIN_ROUND);
    if (p.filled || !p.circles.empty())
      trace_shapes(pen, p, [&] { stroke_part(pen, p, 0); });
    else
      stroke_lines(pen, p);
  }
  cairo_restore(pen);
}

/// Advance of the text as this font has it; draws it when asked.
double run_through(cairo_t* pen, const DrawnText& t, bool halo, bool draw) {
  double x = 0;
  for (const TextRun& run : t.runs) {
    const double size = t.size * (run.raised ? kRaisedSize : 1);
    cairo_set_font_size(pen, size);
    cairo_text_extents_t extents;
    cairo_text_extents(pen, run.text.c_str(), &extents);
    if (draw) {
      cairo_move_to(pen, x, run.raised ? -kRaisedBy * t.size : 0);
      if (halo) {
        cairo_text_path(pen, run.text.c_str());
        set_colour(pen, {1, 1, 1});
        cairo_set_line_width(pen, 1.8);
        cairo_set_line_join(pen, CAIRO_LINE_JOIN_ROUND);
        cairo_stroke(pen);
      } else {
        set_colour(pen, t.colour);
        cairo_show_text(pen, run.text.c_str());
      }
    }
    x += extents.x_advance;
  }
  return x;
}

void write(cairo_t* pen, const DrawnText& t, const Faces& faces) {
  cairo_save(pen);
  cairo_set_font_face(pen, (t.bold ? faces.bold : faces.plain).get());
  cairo_translate(pen, t.at.x, t.at.y);
  if (t.upright) cairo_rotate(pen, -std::numbers::pi / 2);
  const double width = run_through(pen, t, false, false);
  if (t.anchor != Anchor::start) cairo_translate(pen, t.anchor == Anchor::middle ? -width / 2 : -width, 0);
  if (t.halo) run_through(pen, t, true, true);
  run_through(pen, t, false, true);
  cairo_restore(pen);
}

void draw(cairo_t* pen, const Drawing& drawing, const Faces& faces) {
  // What a desktop prefers is no business of a file.
  const std::unique_ptr<cairo_font_options_t, OptionsCloser> options(cairo_font_options_create());
  cairo_font_options_set_antialias(options.get(), CAIRO_ANTIALIAS_GRAY);
  cairo_font_options_set_hint_style(options.get(), CAIRO_HINT_STYLE_NONE);
  cairo_font_options_set_hint_metrics(options.get(), CAIRO_HINT_METRICS_OFF);
  cairo_set_font_options(pen, options.get());
  for (const DrawnPiece& piece : drawing.pieces)
    piece.is_text ? write(pen, piece.text, faces) : paint(pen, piece.path, drawing.frame);
}

cairo_status_t append(void* out, const unsigned char* bytes, unsigned length) {
  static_cast<std::string*>(out)->append(reinterpret_cast<const char*>(bytes), length);
  return CAIRO_STATUS_SUCCESS;
}

void refuse_failed(cairo_status_t status) {
  if (status == CAIRO_STATUS_SUCCESS) return;
  throw output_error("E0986")
      .says(std::string("Cairo could not draw the figure: ") + cairo_status_to_string(status))
      .hint("an SVG is drawn without it");
}

/// Of the environment, as builds that can be repeated set it; empty: no date at all.
std::string date_of_pdf() {
  const char* given = std::getenv("SOURCE_DATE_EPOCH");
  const auto seconds = parse_double(given != nullptr ? given : "");
  if (!seconds || *seconds < 0 || *seconds > 4e9) return "";
  const std::time_t time = static_cast<std::time_t>(*seconds);
  std::tm utc{};
  if (::gmtime_r(&time, &utc) == nullptr) return "";
  return fmt::format("{:04}-{:02}-{:02}T{:02}:{:02}:{:02}Z", utc.tm_year + 1900, utc.tm_mon + 1, utc.tm_mday,
                     utc.tm_hour, utc.tm_min, utc.tm_sec);
}

void put_big_endian(std::string& out, std::uint32_t value) {
  for (const unsigned shift : {24U, 16U, 8U, 0U}) out += static_cast<char>(value >> shift & 0xFFU);
}

/// The resolution, so that the picture is as large on paper as it was asked for (PNG 1.2,
/// 11.3.5.3): a chunk behind the first one, which ends at byte 33.
void add_resolution(std::string& png, double dpi) {
  constexpr std::size_t kBehindHeader = 33;
  const auto a_metre = clamped_whole<std::uint32_t>(std::round(dpi / 0.0254));
  std::string body = "pHYs";
  put_big_endian(body, a_metre);
  put_big_endian(body, a_metre);
  body += '\1';
  boost::crc_32_type crc;
  crc.process_bytes(body.data(), body.size());
  std::string chunk;
  put_big_endian(chunk, 9);
  chunk += body;
  put_big_endian(chunk, crc.checksum());
  png.insert(kBehindHeader, chunk);
}

}  // namespace

bool has_cairo() { return is_here(); }

std::string pdf_of(const Drawing& drawing, Findings& warnings) {
  const Faces faces = faces_of(warnings);
  std::string out;
  const Surface surface(cairo_pdf_surface_create_for_stream(append, &out, drawing.width, drawing.height));
  std::string about;
  for (const TextRun& run : text_runs(drawing.about)) about += run.text;
  cairo_pdf_surface_set_metadata(surface.get(), CAIRO_PDF_METADATA_TITLE, about.c_str());
  cairo_pdf_surface_set_metadata(surface.get(), CAIRO_PDF_METADATA_CREATOR,
                                 fmt::format("sensorchar {}", version()).c_str());
  cairo_pdf_surface_set_metadata(surface.get(), CAIRO_PDF_METADATA_CREATE_DATE, date_of_pdf().c_str());
  const Pen pen(cairo_create(surface.get()));
  draw(pen.get(), drawing, faces);
  cairo_show_page(pen.get());
  refuse_failed(cairo_status(pen.get()));
  cairo_surface_finish(surface.get());
  refuse_failed(cairo_surface_status(surface.get()));
  return out;
}

std::string png_of(const Drawing& drawing, double dpi, Findings& warnings) {
  constexpr double kMostPixels = 2e8;
  const double scale = dpi / 72;
  const double width = std::ceil(drawing.width * scale), height = std::ceil(drawing.height * scale);
  if (!(width >= 1 && height >= 1 && width * height <= kMostPixels && width < 32000 && height < 32000))
    throw usage_error("E0981")
        .says("a picture of {:.0f} × {:.0f} pixels cannot be drawn", width, height)
        .hint("a lower resolution (dpi) gives fewer; an SVG or PDF has none");
  const Faces faces = faces_of(warnings);
  const Surface surface(
      cairo_image_surface_create(CAIRO_FORMAT_RGB24, static_cast<int>(width), static_cast<int>(height)));
  refuse_failed(cairo_surface_status(surface.get()));
  const Pen pen(cairo_create(surface.get()));
  set_colour(pen.get(), {1, 1, 1});
  cairo_paint(pen.get());
  cairo_scale(pen.get(), scale, scale);
  draw(pen.get(), drawing, faces);
  refuse_failed(cairo_status(pen.get()));
  std::string out;
  refuse_failed(cairo_surface_write_to_png_stream(surface.get(), append, &out));
  add_resolution(out, dpi);
  return out;
}

}  // namespace libchar

#else

namespace libchar {

bool has_cairo() { return false; }

std::string pdf_of(const Drawing& /*drawing*/, Findings& /*warnings*/) { return ""; }

std::string png_of(const Drawing& /*drawing*/, double /*dpi*/, Findings& /*warnings*/) { return ""; }

}  // namespace libchar

#endif
