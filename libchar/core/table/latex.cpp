#include <span>
#include <string_view>
#include <utility>

#include "libchar/core/table/detail/formats.hpp"

namespace libchar {
namespace {

struct LatexWord {
  std::string_view text, latex;
};

// In text mode.
constexpr LatexWord kLatexText[] = {{"\\", "\\textbackslash{}"},
                                    {"&", "\\&"},
                                    {"%", "\\%"},
                                    {"$", "\\$"},
                                    {"#", "\\#"},
                                    {"_", "\\_"},
                                    {"{", "\\{"},
                                    {"}", "\\}"},
                                    {"~", "\\textasciitilde{}"},
                                    {"^", "\\textasciicircum{}"},
                                    {"…", "\\ldots{}"},
                                    {"–", "--"},
                                    {"≤", "$\\le$"},
                                    {"·", "$\\cdot$"},
                                    {"√", "$\\surd$"},
                                    {"²", "$^{2}$"},
                                    {"³", "$^{3}$"},
                                    {"°", "$^{\\circ}$"},
                                    {"µ", "$\\mu$"},
                                    {"±", "$\\pm$"},
                                    {"−", "$-$"},
                                    {"\u202F", "\\,"}};

// In mathematics.
constexpr LatexWord kLatexUnit[] = {
    {"·", "\\cdot "}, {"²", "^{2}"}, {"³", "^{3}"}, {"µ", "\\mu "},   {"°", "^{\\circ}"},     {"%", "\\%"},
    {"(", "("},       {")", ")"},    {"/", "/"},    {"^", "\\hat{}"}, {"\\", "\\backslash "}, {"_", "\\_"},
    {"$", "\\$"},     {"&", "\\&"},  {"#", "\\#"},  {"{", "\\{"},     {"}", "\\}"},           {"~", "\\sim "}};

const LatexWord* latex_word(std::span<const LatexWord> words, std::string_view text) {
  for (const LatexWord& word : words)
    if (text.starts_with(word.text)) return &word;
  return nullptr;
}

/// "×10⁻⁵" at the beginning of the text: its length and what LaTeX writes.
std::pair<std::size_t, std::string> latex_power(std::string_view text) {
  constexpr std::string_view kTimes = "×10";
  if (!text.starts_with(kTimes)) return {0, ""};
  constexpr LatexWord kRaised[] = {{"⁻", "-"}, {"⁰", "0"}, {"¹", "1"}, {"²", "2"}, {"³", "3"}, {"⁴", "4"},
                                   {"⁵", "5"}, {"⁶", "6"}, {"⁷", "7"}, {"⁸", "8"}, {"⁹", "9"}};
  std::size_t at = kTimes.size();
  std::string exponent;
  while (const LatexWord* digit = latex_word(kRaised, text.substr(at))) {
    exponent += digit->latex;
    at += digit->text.size();
  }
  return {at, "$\\times 10^{" + exponent + "}$"};
}

bool latex_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); }

}  // namespace

std::string latex_text(const std::string& text) {
  std::string out;
  for (std::size_t at = 0; at < text.size();) {
    const std::string_view rest = std::string_view(text).substr(at);
    if (const auto [length, power] = latex_power(rest); length > 0) {
      out += power;
      at += length;
    } else if (rest.starts_with("√") && rest.size() > 3 && latex_letter(rest[3])) {
      // "deg/√h": the root of the unit that follows
      std::size_t end = at + std::string_view("√").size();
      const std::size_t from = end;
      while (end < text.size() && latex_letter(text[end])) ++end;
      out += "$\\sqrt{\\mathrm{" + text.substr(from, end - from) + "}}$";
      at = end;
    } else if (const LatexWord* word = latex_word(kLatexText, rest)) {
      out += word->latex;
      at += word->text.size();
    } else {
      out += text[at++];
    }
  }
  return out;
}

std::string latex_unit(const std::string& unit) {
  if (unit.empty()) return "";
  constexpr std::string_view kRoot = "√";
  std::string out;
  bool rooted = false;
  for (std::size_t at = 0; at < unit.size();) {
    const std::string_view rest = std::string_view(unit).substr(at);
    if (rest.starts_with(kRoot)) {
      rooted = true;
      at += kRoot.size();
    } else if (latex_letter(unit[at])) {
      std::size_t end = at;
      while (end < unit.size() && latex_letter(unit[end])) ++end;
      const std::string word = "\\mathrm{" + unit.substr(at, end - at) + "}";
      out += rooted ? "\\sqrt{" + word + "}" : word;
      rooted = false;
      at = end;
    } else if (const LatexWord* word = latex_word(kLatexUnit, rest)) {
      out += word->latex;
      at += word->text.size();
    } else {
      out += unit[at++];
    }
  }
  return "$" + out + "$";
}

}  // namespace libchar
