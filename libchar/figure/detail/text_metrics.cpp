// Widths of Liberation Sans, which are those of Arial and Helvetica: a layout that is right with
// one is right with the others, and needs no font where it is computed.

#include <cstdint>
#include <optional>

#include "libchar/core/text/text.hpp"
#include "libchar/figure/detail/drawing.hpp"

namespace libchar {
namespace {

// In thousandths of the size.
// clang-format off
constexpr std::uint16_t kAscii[] = {  // U+0020 to U+007E
    278, 278, 355, 556, 556, 889, 667, 191, 333, 333, 389, 584, 278, 333, 278, 278, 556, 556,
    556, 556, 556, 556, 556, 556, 556, 556, 278, 278, 584, 584, 584, 556, 1015, 667, 667, 722,
    722, 667, 611, 778, 722, 278, 500, 667, 556, 833, 722, 778, 667, 778, 722, 667, 611, 722,
    667, 944, 667, 667, 611, 278, 278, 278, 469, 556, 333, 556, 556, 500, 556, 556, 278, 556,
    556, 222, 222, 500, 222, 833, 556, 556, 556, 556, 333, 500, 278, 556, 500, 722, 500, 500,
    500, 334, 260, 334, 584};
constexpr std::uint16_t kLatin[] = {  // U+00A0 to U+00FF
    278, 333, 556, 556, 556, 556, 260, 556, 333, 737, 370, 556, 584, 333, 737, 552, 400, 549,
    333, 333, 333, 576, 537, 333, 333, 333, 365, 556, 834, 834, 834, 611, 667, 667, 667, 667,
    667, 667, 1000, 722, 667, 667, 667, 667, 278, 278, 278, 278, 722, 722, 778, 778, 778, 778,
    778, 584, 778, 722, 722, 722, 722, 667, 667, 611, 556, 556, 556, 556, 556, 556, 889, 500,
    556, 556, 556, 556, 278, 278, 278, 278, 556, 556, 556, 556, 556, 556, 556, 549, 611, 556,
    556, 556, 556, 500, 556, 500};
constexpr std::uint16_t kGreek[] = {  // U+0391 to U+03C9
    667, 667, 551, 668, 667, 611, 722, 778, 278, 667, 668, 833, 722, 650, 778, 722, 667, 556,
    618, 611, 667, 798, 667, 835, 748, 278, 667, 578, 446, 556, 222, 547, 578, 575, 500, 557,
    446, 441, 556, 556, 222, 500, 500, 576, 500, 448, 556, 690, 569, 482, 617, 395, 547, 648,
    525, 713, 781};
// clang-format on

struct Advance {
  char32_t character;
  std::uint16_t width;
};
constexpr Advance kOthers[] = {{U'–', 556}, {U'—', 1000}, {U'‘', 222}, {U'’', 222}, {U'“', 333},  {U'”', 333},
                               {U'•', 350}, {U'…', 1000}, {U'≤', 549}, {U'≥', 549}, {U'≈', 549},  {U'√', 549},
                               {U'∞', 713}, {U'−', 584},  {U'↑', 500}, {U'↓', 500}, {U'→', 1000}, {U'←', 1000}};

// Bold letters are wider; a figure has few of them.
constexpr double kBold = 1.08;

/// The character at `at`, which moves behind it. The text is valid UTF-8.
char32_t next_character(std::string_view text, std::size_t& at) {
  const auto byte = [&](std::size_t i) { return i < text.size() ? static_cast<unsigned char>(text[i]) : 0U; };
  const unsigned first = byte(at);
  const std::size_t length = first < 0x80U ? 1 : first < 0xE0U ? 2 : first < 0xF0U ? 3 : 4;
  char32_t out = length == 1 ? first : first & (0xFFU >> (length + 1));
  for (std::size_t i = 1; i < length; ++i) out = (out << 6U) | (byte(at + i) & 0x3FU);
  at += length;
  return out;
}

double advance_of(char32_t c) {
  if (c >= 0x20 && c <= 0x7E) return kAscii[c - 0x20];
  if (c >= 0xA0 && c <= 0xFF) return kLatin[c - 0xA0];
  if (c >= 0x391 && c <= 0x3C9) return kGreek[c - 0x391];
  for (const Advance& other : kOthers)
    if (other.character == c) return other.width;
  // Chinese, Japanese, Korean and beyond are as wide as high; what else a name may hold is like a letter.
  return c >= 0x2E80 ? 1000 : 600;
}

/// The digit or minus that a raised character stands for.
std::optional<std::string_view> lowered(char32_t c) {
  constexpr std::pair<char32_t, std::string_view> kRaised[] = {{U'⁰', "0"}, {U'¹', "1"}, {U'²', "2"}, {U'³', "3"},
                                                               {U'⁴', "4"}, {U'⁵', "5"}, {U'⁶', "6"}, {U'⁷', "7"},
                                                               {U'⁸', "8"}, {U'⁹', "9"}, {U'⁻', "−"}};
  for (const auto& [raised, plain] : kRaised)
    if (raised == c) return plain;
  return std::nullopt;
}

}  // namespace

std::vector<TextRun> text_runs(std::string_view text) {
  const std::string safe = printable(text);
  std::vector<TextRun> out = {{"", false}};
  for (std::size_t at = 0; at < safe.size();) {
    const std::size_t from = at;
    const auto plain = lowered(next_character(safe, at));
    // Behind "10" a raised digit is an exponent; in "m/s²" it stays the character that it is.
    const bool raised = plain && (out.back().raised || out.back().text.ends_with("10"));
    if (raised != out.back().raised) out.push_back({"", raised});
    out.back().text += raised ? *plain : std::string_view(safe).substr(from, at - from);
  }
  if (out[0].text.empty() && out.size() > 1) out.erase(out.begin());
  return out;
}

double text_width(const std::vector<TextRun>& runs, double size, bool bold) {
  double out = 0;
  for (const TextRun& run : runs)
    for (std::size_t at = 0; at < run.text.size();)
      out += advance_of(next_character(run.text, at)) * (run.raised ? kRaisedSize : 1);
  return out * size * (bold ? kBold : 1) / 1000;
}

void Drawing::add(DrawnPath path) { pieces.push_back({false, std::move(path), {}}); }

void Drawing::add(DrawnText text) { pieces.push_back({true, {}, std::move(text)}); }

}  // namespace libchar
