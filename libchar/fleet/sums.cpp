#include "libchar/fleet/sums.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "libchar/core/file/file_text.hpp"
#include "libchar/core/refusal.hpp"
#include "libchar/core/text/text.hpp"
#include "libchar/fleet/detail/manifest_path.hpp"

namespace libchar {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kDigitsOfSum = 64;
constexpr std::size_t kMostSums = std::size_t{1} << 30U;

struct SumLine {
  std::string sha256, path;
};

/// A name with a backslash or an end of line in it stands escaped behind a line that begins with a backslash.
std::string without_escapes(std::string_view name) {
  std::string out;
  for (std::size_t i = 0; i < name.size(); ++i) {
    const bool escape = name[i] == '\\' && i + 1 < name.size();
    if (escape) ++i;
    out += escape && name[i] == 'n' ? '\n' : escape && name[i] == 'r' ? '\r' : name[i];
  }
  return out;
}

std::optional<SumLine> digest_first(std::string_view line) {
  if (line.size() < kDigitsOfSum + 3 || line[kDigitsOfSum] != ' ') return std::nullopt;
  const char mode = line[kDigitsOfSum + 1];
  const auto digest = sha256_digits(line.substr(0, kDigitsOfSum));
  if (!digest || (mode != ' ' && mode != '*')) return std::nullopt;
  return SumLine{*digest, std::string(line.substr(kDigitsOfSum + 2))};
}

std::optional<SumLine> path_first(std::string_view line) {
  constexpr std::string_view kBegin = "SHA256 (", kMiddle = ") = ";
  if (!line.starts_with(kBegin) || line.size() < kBegin.size() + kMiddle.size() + kDigitsOfSum + 1)
    return std::nullopt;
  const auto digest = sha256_digits(line.substr(line.size() - kDigitsOfSum));
  line.remove_suffix(kDigitsOfSum);
  line.remove_prefix(kBegin.size());
  if (!digest || !line.ends_with(kMiddle)) return std::nullopt;
  return SumLine{*digest, std::string(line.substr(0, line.size() - kMiddle.size()))};
}

std::optional<SumLine> sum_line(std::string_view line) {
  const bool escaped = line.starts_with('\\');
  if (escaped) line.remove_prefix(1);
  std::optional<SumLine> out = digest_first(line);
  if (!out) out = path_first(line);
  if (out && escaped) out->path = without_escapes(out->path);
  return out;
}

void refuse_another(const StatedDigest& one, const StatedDigest& other, const std::string& log) {
  if (one.sha256 == other.sha256) return;
  throw input_error("E0794", one.where)
      .says("another digest is stated for this log at " + other.where)
      .got(log)
      .hint("leave the wrong one out");
}

void state(const std::string& log, const StatedDigest& one, StatedDigests& out) {
  const auto [at, fresh] = out.emplace(log, one);
  if (!fresh) refuse_another(one, at->second, log);
}

}  // namespace

std::optional<std::string> sha256_digits(std::string_view text) {
  std::string digits = ascii_lower(text);
  if (digits.size() != kDigitsOfSum ||
      digits.find_first_not_of("0123456789abcdef") != std::string::npos)
    return std::nullopt;
  return digits;
}

StatedDigests parse_sums(std::string_view text, const std::string& path) {
  if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);
  const fs::path folder = folder_of_file(path);
  StatedDigests out;
  for (int number = 1; !text.empty(); ++number) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    std::string_view line = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    if (line.ends_with('\r')) line.remove_suffix(1);
    if (line.empty() || line[0] == '#') continue;
    const std::string where = fmt::format("{}:{}:1", path, number);
    const auto found = sum_line(line);
    if (!found)
      throw input_error("E0792", where)
          .says("expected a digest of 64 hexadecimal digits, two blanks and the path of a log")
          .got(std::string(line))
          .hint("write the file with: sha256sum LOG… > FILE");
    state(absolute_path(found->path, folder), {found->sha256, where}, out);
  }
  return out;
}

StatedDigests read_sums(const std::vector<std::string>& paths) {
  StatedDigests out;
  for (const std::string& path : paths)
    for (const auto& [log, one] : parse_sums(file_text(path, kMostSums), path))
      state(log, one, out);
  return out;
}

std::size_t state_digests(const StatedDigests& digests, Manifest& manifest) {
  std::size_t without = 0;
  for (FleetDevice& device : manifest.devices) {
    const auto at = digests.find(device.log);
    if (at == digests.end()) {
      without += device.sha256.empty() ? 1 : 0;
      continue;
    }
    if (!device.sha256.empty())
      refuse_another({device.sha256, device.where}, at->second, device.log);
    device.sha256 = at->second.sha256;
  }
  return without;
}

}  // namespace libchar
