#include "libchar/core/text/text_table.hpp"

#include <algorithm>

#include "libchar/core/table/detail/formats.hpp"

namespace libchar {
namespace {

using Rows = std::vector<std::vector<std::string>>;

constexpr std::size_t kNarrowestWords = 24;  ///< a column of words is not wrapped to less

std::vector<std::size_t> widths_of(const Rows& rows) {
  std::vector<std::size_t> widths;
  for (const auto& row : rows) {
    widths.resize(std::max(widths.size(), row.size()), 0);
    for (std::size_t c = 0; c < row.size(); ++c) widths[c] = std::max(widths[c], width_of(row[c]));
  }
  return widths;
}

/// Of the columns from `first` to before `last`, with the gaps between them.
std::size_t places(const std::vector<std::size_t>& widths, std::size_t first, std::size_t last) {
  std::size_t sum = 0;
  for (std::size_t c = first; c < last; ++c) sum += widths[c] + (c > first ? 2 : 0);
  return sum;
}

struct TableCut {
  std::string_view indent;
  bool words_last = false;
  std::size_t words = 0;  ///< characters that the last column is wrapped to; 0: it is not
};

std::string plain_table(const Rows& rows, const TableCut& cut) {
  const std::vector<std::size_t> widths = widths_of(rows);
  const std::string below(cut.indent.size() + places(widths, 0, widths.size() - 1) + 2, ' ');
  std::string text;
  for (const auto& row : rows) {
    std::string line(cut.indent);
    for (std::size_t c = 0; c < row.size(); ++c) {
      if (c > 0) line += "  ";
      const bool last = c + 1 == widths.size();
      if (last && cut.words_last && cut.words > 0 && width_of(row[c]) > cut.words) {
        line += wrapped(row[c], below.size() + cut.words, below).substr(below.size());
        continue;
      }
      const std::string blanks(widths[c] - width_of(row[c]), ' ');
      line += c == 0 || (cut.words_last && last) ? row[c] + blanks : blanks + row[c];
    }
    line.erase(line.find_last_not_of(' ') + 1);
    text += line + "\n";
  }
  return text;
}

/// The first column and those from `first` to before `last`.
Rows columns(const Rows& rows, std::size_t first, std::size_t last) {
  Rows out;
  for (const auto& row : rows) {
    out.push_back({row.front()});
    for (std::size_t c = first; c < std::min(last, row.size()); ++c) out.back().push_back(row[c]);
  }
  return out;
}

}  // namespace

std::string tinted(std::string_view word, Tint tint, bool colours) {
  constexpr const char* kColours[] = {"\x1b[32m", "\x1b[33m", "\x1b[31m", "\x1b[2m"};
  if (!colours) return std::string(word);
  return kColours[static_cast<std::size_t>(tint)] + std::string(word) + "\x1b[0m";
}

std::size_t width_of(std::string_view text) {
  std::size_t places = 0;
  for (std::size_t at = 0; at < text.size(); ++at) {
    if (text[at] == '\x1b')
      at = std::min(text.find('m', at), text.size());
    else if ((static_cast<unsigned char>(text[at]) & 0xC0U) != 0x80U)
      ++places;
  }
  return places;
}

std::string wrapped(std::string_view text, std::size_t width, std::string_view indent) {
  std::string lines(indent);
  std::size_t place = width_of(indent);
  const std::size_t first = place;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find(' '), text.size());
    const std::string_view word = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    if (word.empty()) continue;
    const std::size_t places = width_of(word);
    if (place > first && place + 1 + places > width) {
      lines += "\n" + std::string(indent);
      place = first;
    } else if (place > first) {
      lines += ' ';
      ++place;
    }
    lines += word;
    place += places;
  }
  return lines;
}

std::string text_table(const Rows& rows, std::string_view indent, bool words_last, std::size_t width) {
  if (rows.empty()) return "";
  const std::vector<std::size_t> widths = widths_of(rows);
  const std::size_t count = widths.size();
  const std::size_t needed = indent.size() + places(widths, 0, count);
  if (width == 0 || needed <= width || count < 2) return plain_table(rows, {indent, words_last});
  const std::size_t numbers = words_last ? count - 1 : count;
  const std::size_t before_words = indent.size() + places(widths, 0, numbers) + 2;
  if (words_last && before_words + std::min(kNarrowestWords, widths.back()) <= width)
    return plain_table(rows, {indent, true, width - before_words});
  std::string text;
  const std::size_t first_column = indent.size() + widths[0] + 2;
  for (std::size_t first = 1; first < numbers;) {
    std::size_t last = first + 1;
    while (last < numbers && first_column + places(widths, first, last + 1) <= width) ++last;
    text += plain_table(columns(rows, first, last), {indent, false});
    first = last;
  }
  if (words_last)
    text += plain_table(columns(rows, count - 1, count),
                        {indent, true, std::max(kNarrowestWords, width - std::min(width, first_column))});
  return text;
}

}  // namespace libchar
