#include "libchar/lot/detail/record_scanner.hpp"

#include <charconv>
#include <limits>

#include "libchar/core/document/document.hpp"
#include "libchar/core/text/double_text.hpp"
#include "libchar/core/text/text.hpp"

namespace libchar {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Where a line has been read to. Each step says whether what it wants is there.
class Scanner {
 public:
  explicit Scanner(std::string_view line) : at_(line.data()), end_(line.data() + line.size()) {}

  bool word(std::string_view expected) {
    if (std::string_view(at_, static_cast<std::size_t>(end_ - at_)).substr(0, expected.size()) != expected)
      return false;
    at_ += expected.size();
    return true;
  }
  bool ended() const { return at_ == end_; }

  /// A text without escapes, its quotes read.
  bool text(std::string_view& out) {
    if (at_ == end_ || *at_ != '"') return false;
    const char* const begin = ++at_;
    for (; at_ != end_ && *at_ != '"'; ++at_)
      if (*at_ == '\\' || static_cast<unsigned char>(*at_) < 0x20) return false;
    if (at_ == end_) return false;
    out = {begin, static_cast<std::size_t>(at_++ - begin)};
    return true;
  }
  bool text(std::string& out) {
    std::string_view found;
    if (!text(found)) return false;
    out = found;
    return true;
  }

  /// A number by JSON's rules that a double holds.
  bool number(double& out) {
    const char* const begin = at_;
    if (at_ != end_ && *at_ == '-') ++at_;
    if (at_ != end_ && *at_ == '0')
      ++at_;
    else if (!digits())
      return false;
    if (at_ != end_ && *at_ == '.' && (++at_, !digits())) return false;
    if (at_ != end_ && (*at_ == 'e' || *at_ == 'E')) {
      ++at_;
      if (at_ != end_ && (*at_ == '+' || *at_ == '-')) ++at_;
      if (!digits()) return false;
    }
    const auto read = detail::read_double(begin, at_, out);
    return read.ec == std::errc() && read.ptr == at_;
  }
  bool number_or_null(double& out, double absent) {
    out = absent;
    return word("null") || number(out);
  }
  bool not_negative(double& out) { return number(out) && out >= 0; }
  bool positive(double& out) { return number(out) && out > 0; }

  bool count(std::uint64_t& out) {
    const char* const begin = at_;
    if (!digits() || (*begin == '0' && at_ - begin > 1)) return false;
    return std::from_chars(begin, at_, out).ec == std::errc();
  }

 private:
  bool digits() {
    const char* const begin = at_;
    while (at_ != end_ && *at_ >= '0' && *at_ <= '9') ++at_;
    return at_ != begin;
  }

  const char* at_;
  const char* end_;
};

bool scan_value(Scanner& in, RecordedValue& out) {
  std::string_view status;
  if (!in.word(":{\"status\":") || !in.text(status)) return false;
  const auto known = find_enum<Status>(status);
  if (!known) return false;
  out.status = *known;
  if (in.word(",\"value\":")) {
    const bool value = in_logarithm(out.quantity) ? in.not_negative(out.value) : in.number(out.value);
    if (!value || !in.word(",\"ci95\":[") || !in.number_or_null(out.ci95.low, kNone) || !in.word(",") ||
        !in.number_or_null(out.ci95.high, kInfinity) || !in.word("],\"sd\":") || !in.number_or_null(out.sd, kNone) ||
        out.sd < 0 || out.ci95.low > out.ci95.high)
      return false;
  }
  if (in.word(",\"square_in_all\":[")) {
    SquareInAll of;
    if (!in.number(of.square) || !in.word(",") || !in.not_negative(of.sd) || !(of.sd > 0) || !in.word(",") ||
        !in.number(of.skewness) || !in.word("]"))
      return false;
    out.in_all = of;
  }
  if (in.word(",\"upper95\":") && !in.not_negative(out.upper95)) return false;
  return in.word("}");
}

bool scan_values(Scanner& in, std::vector<RecordedValue>& out) {
  if (in.word("}")) return true;
  do {
    std::string_view key;
    if (!in.text(key)) return false;
    const auto quantity = find_enum<DeviceQuantity>(key);
    if (!quantity || (!out.empty() && *quantity <= out.back().quantity)) return false;
    RecordedValue value;
    value.quantity = *quantity;
    if (!scan_value(in, value)) return false;
    out.push_back(value);
  } while (in.word(","));
  return in.word("}");
}

bool scan_channel(Scanner& in, RecordedChannel& out) {
  if (!in.word("{\"name\":") || !in.text(out.name) || !in.word(",\"unit\":") || !in.text(out.unit) ||
      !in.word(",\"samples\":") || !in.count(out.samples) || !in.word(",\"missing\":") || !in.count(out.missing))
    return false;
  if (in.word(",\"mean\":") && !in.number(out.mean)) return false;
  out.fitted = in.word(",\"rate_hz\":");
  if (out.fitted) {
    out.values.reserve(4);
    if (!in.positive(out.rate_hz) || !in.word(",\"duration_s\":") || !in.positive(out.duration_s) ||
        !in.word(",\"p\":") || !in.number_or_null(out.p, kNone) || !in.word(",\"values\":{") ||
        !scan_values(in, out.values))
      return false;
  }
  return in.word("}");
}

bool has_name(const std::vector<RecordedChannel>& channels, const std::string& name) {
  for (const RecordedChannel& c : channels)
    if (c.name == name) return true;
  return false;
}

bool scan_channels(Scanner& in, std::vector<RecordedChannel>& out) {
  if (!in.word(",\"channels\":[")) return false;
  if (in.word("]")) return true;
  out.reserve(6);
  do {
    RecordedChannel channel;
    if (!scan_channel(in, channel) || has_name(out, channel.name)) return false;
    out.push_back(std::move(channel));
  } while (in.word(","));
  return in.word("]");
}

bool scan_head(Scanner& in, DeviceRecord& out) {
  if (!in.word("{\"format\":\"device-record\",\"version\":1")) return false;
  for (const auto& [key, text] :
       {std::pair(",\"device\":", &out.device), std::pair(",\"type\":", &out.type),
        std::pair(",\"batch\":", &out.batch), std::pair(",\"log\":", &out.log), std::pair(",\"sha256\":", &out.sha256),
        std::pair(",\"settings\":", &out.settings), std::pair(",\"program\":", &out.program)})
    if (!in.word(key) || !in.text(*text)) return false;
  if (in.word(",\"temperature_c\":") && !in.number(out.temperature_c.emplace())) return false;
  for (const auto& [key, text] : {std::pair(",\"report\":", &out.report), std::pair(",\"limits\":", &out.limits),
                                  std::pair(",\"problem\":", &out.problem)})
    if (in.word(key) && !in.text(*text)) return false;
  return true;
}

}  // namespace

std::optional<DeviceRecord> scan_device_record(std::string_view line) {
  if (line.ends_with('\n')) line.remove_suffix(1);
  if (line.size() > kMaxDocumentBytes || first_invalid_utf8(line) != std::string_view::npos) return std::nullopt;
  Scanner in(line);
  std::optional<DeviceRecord> out(std::in_place);
  if (!scan_head(in, *out) || !scan_channels(in, out->channels) || !in.word("}") || !in.ended()) return std::nullopt;
  return out;
}

}  // namespace libchar
