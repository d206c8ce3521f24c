#pragma once
// A drawing: lines, areas and texts at their places on a page, in points (1/72 inch) from its upper left corner. The
// writers of SVG, PDF and PNG all go through this one list, so that their pictures are the same.

#include <string>
#include <string_view>
#include <vector>

#include "libchar/core/finding.hpp"

namespace libchar {

struct Colour {
  double red = 0, green = 0, blue = 0;
  bool operator==(const Colour&) const = default;
};

struct Place {
  double x = 0, y = 0;
};

struct Box {
  double left = 0, top = 0, right = 0, bottom = 0;
  bool meets(const Box& other) const {
    return left < other.right && other.left < right && top < other.bottom && other.top < bottom;
  }
  bool holds(const Place& p) const { return p.x >= left && p.x <= right && p.y >= top && p.y <= bottom; }
};

/// A piece of a text: raised ones are smaller and above the line.
struct TextRun {
  std::string text;
  bool raised = false;
};

enum class Anchor { start, middle, end };

struct DrawnText {
  Place at;  ///< of the base line
  Anchor anchor = Anchor::start;
  double size = 7.5;
  bool bold = false;
  bool upright = false;  ///< turned by a quarter, to be read from below
  bool halo = false;     ///< white around it, so that lines behind do not hide it
  Colour colour;
  std::vector<TextRun> runs;
};

struct DrawnPath {
  std::vector<std::vector<Place>> lines;  ///< each closed where it is filled
  std::vector<Place> circles;             ///< centres
  double radius = 0;                      ///< of the circles
  bool filled = false, stroked = true;
  Colour fill, stroke;
  double opacity = 1;  ///< of the fill
  double width = 0.5;
  std::vector<double> dash;
  bool clipped = false;  ///< to the frame
  std::string tip;       ///< where the pointer rests, on a page
};

struct DrawnPiece {
  bool is_text = false;
  DrawnPath path;
  DrawnText text;
};

struct Drawing {
  double width = 0, height = 0;
  Box frame;          ///< of the plot: what clipped pieces stay in
  std::string about;  ///< for readers who cannot see it
  std::vector<DrawnPiece> pieces;
  void add(DrawnPath path);
  void add(DrawnText text);
};

/// Text in pieces: the digits of a power of ten ("10⁻³") are raised, all else stays as it is. What
/// does not print is written as an escape.
std::vector<TextRun> text_runs(std::string_view text);

/// Advance of a text in Liberation Sans (and so in Arial and Helvetica), in points.
double text_width(const std::vector<TextRun>& runs, double size, bool bold = false);

/// What a raised piece has of the size, and how far above the line it stands.
inline constexpr double kRaisedSize = 0.72, kRaisedBy = 0.36;

inline constexpr const char* kFigureFont = "Liberation Sans";

/// A file; with a name, part of a page on which no other drawing has it.
std::string svg_of(const Drawing& drawing, const std::string& name = "");

// PDF and PNG, by Cairo: the only user of it.

bool has_cairo();

/// One page. A PDF has no date of its own (SOURCE_DATE_EPOCH gives it one), so that the same
/// drawing gives the same bytes.
std::string pdf_of(const Drawing& drawing, Findings& warnings);
std::string png_of(const Drawing& drawing, double dpi, Findings& warnings);

}  // namespace libchar
