// Widths of letters against those of the font itself, where it is installed.
#ifdef LIBCHAR_CAIRO
#include <cairo.h>

#include <catch2/catch.hpp>
#include <memory>
#include <string>

#include "libchar/figure/detail/drawing.hpp"

using namespace libchar;

namespace {

std::string utf8(char32_t c) {
  std::string out;
  if (c < 0x80) return {static_cast<char>(c)};
  if (c >= 0x800) out += static_cast<char>(0xE0U | c >> 12U);
  out += static_cast<char>(c < 0x800 ? 0xC0U | c >> 6U : 0x80U | (c >> 6U & 0x3FU));
  return out + static_cast<char>(0x80U | (c & 0x3FU));
}

}  // namespace

TEST_CASE("widths of letters are those of Liberation Sans") {
  const std::unique_ptr<cairo_surface_t, decltype(&cairo_surface_destroy)> surface(
      cairo_image_surface_create(CAIRO_FORMAT_A8, 8, 8), cairo_surface_destroy);
  const std::unique_ptr<cairo_t, decltype(&cairo_destroy)> cairo(cairo_create(surface.get()), cairo_destroy);
  cairo_select_font_face(cairo.get(), kFigureFont, CAIRO_FONT_SLANT_NORMAL, CAIRO_FONT_WEIGHT_NORMAL);
  cairo_set_font_size(cairo.get(), 2048);
  cairo_font_options_t* options = cairo_font_options_create();
  cairo_font_options_set_hint_metrics(options, CAIRO_HINT_METRICS_OFF);
  cairo_set_font_options(cairo.get(), options);
  cairo_font_options_destroy(options);
  for (const auto& [from, to] : {std::pair{0x20, 0x7E}, {0xA1, 0xAC}, {0xAE, 0xFF}, {0x391, 0x3A1}, {0x3A3, 0x3C9}})
    for (int c = from; c <= to; ++c) {
      const std::string letter = utf8(static_cast<char32_t>(c));
      cairo_text_extents_t of;
      cairo_text_extents(cairo.get(), letter.c_str(), &of);
      INFO(letter);
      CHECK(text_width({{letter, false}}, 1000) == Approx(of.x_advance / 2.048).margin(0.6));
    }
}
#endif
