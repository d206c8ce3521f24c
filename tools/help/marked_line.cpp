#include "help/marked_line.hpp"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <regex>

#include "libchar/core/text/text.hpp"
#include "libchar/core/text/text_table.hpp"

namespace sensorchar {
namespace {

constexpr std::size_t kMostShown = 100, kMostRead = std::size_t{1} << 16U;
constexpr std::uintmax_t kMostScanned = std::uintmax_t{1} << 24U;  ///< of a document, whose places have no bytes

struct Spot {
  std::string file;
  std::uint64_t line = 0, column = 0, byte = 0;
  bool has_byte = false;
};

bool read_spot(const std::string& where, Spot& spot) {
  static const std::regex kPlace("(.+):(\\d{1,15}):(\\d{1,9})(?: \\(byte (\\d{1,18})\\))?");
  std::smatch part;
  if (!std::regex_match(where, part, kPlace)) return false;
  spot = {part[1], std::stoull(part[2]), std::stoull(part[3]), 0, part[4].matched};
  if (spot.has_byte) spot.byte = std::stoull(part[4]);
  return spot.line > 0 && spot.column > 0;
}

/// Where the line begins; none: the end of the stream.
void go_to_line(std::ifstream& in, const Spot& spot) {
  if (spot.has_byte) {
    in.seekg(static_cast<std::streamoff>(spot.byte - std::min(spot.byte, spot.column - 1)));
    return;
  }
  std::string skipped;
  for (std::uint64_t line = 1; line < spot.line && std::getline(in, skipped); ++line) continue;
}

bool shows(const std::string& text) {
  return libchar::first_invalid_utf8(text) == std::string::npos && std::none_of(text.begin(), text.end(), [](char c) {
           return (static_cast<unsigned char>(c) < 0x20 && c != '\t') || c == 0x7f;
         });
}

}  // namespace

std::string marked_line(const libchar::Problem& problem) {
  namespace fs = std::filesystem;
  Spot spot;
  std::error_code ignored;
  if (!read_spot(problem.where, spot) || !fs::is_regular_file(spot.file, ignored)) return "";
  if (!spot.has_byte && fs::file_size(spot.file, ignored) > kMostScanned) return "";
  std::ifstream in(spot.file, std::ios::binary);
  go_to_line(in, spot);
  std::string text(kMostRead, '\0');
  in.read(text.data(), static_cast<std::streamsize>(text.size()));
  text.resize(static_cast<std::size_t>(in.gcount()));
  text.resize(std::min(text.find_first_of("\r\n"), text.size()));
  std::replace(text.begin(), text.end(), '\t', ' ');
  const std::size_t at = static_cast<std::size_t>(spot.column) - 1;
  if (text.empty() || at > text.size() || !shows(text)) return "";
  // What is behind is cut first, then what is in front.
  const std::size_t from = at > kMostShown - 20 ? at - (kMostShown - 20) : 0;
  const std::string front = text.substr(from, at - from), shown = text.substr(from, kMostShown);
  if (!shows(front) || !shows(shown)) return "";  // cut within a letter
  return "\n  | " + shown + "\n  | " + std::string(libchar::width_of(front), ' ') + "^";
}

}  // namespace sensorchar
