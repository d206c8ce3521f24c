#include "libchar/log/flight/ulog_format.hpp"

#include <fmt/format.h>

#include <array>
#include <charconv>
#include <optional>
#include <utility>

#include "libchar/core/text/text.hpp"

namespace libchar {
namespace {

constexpr int kDeepest = 32;  // formats within formats
constexpr std::size_t kLongestName = 255;
constexpr std::uint32_t kMostBytes = 65535 - 2;  // of a message of data
constexpr std::uint64_t kMostFields = 200000, kMostSteps = 4000000;

std::optional<NumberType> ulog_number(std::string_view type) {
  static constexpr std::array<std::pair<std::string_view, NumberType>, 12> kTypes = {
      {{"int8_t", NumberType::i8},
       {"uint8_t", NumberType::u8},
       {"int16_t", NumberType::i16},
       {"uint16_t", NumberType::u16},
       {"int32_t", NumberType::i32},
       {"uint32_t", NumberType::u32},
       {"int64_t", NumberType::i64},
       {"uint64_t", NumberType::u64},
       {"float", NumberType::f32},
       {"double", NumberType::f64},
       {"bool", NumberType::u8},
       {"char", NumberType::i8}}};
  for (const auto& [word, number] : kTypes)
    if (word == type) return number;
  return std::nullopt;
}

}  // namespace

void UlogFormats::add(std::string_view text) {
  const std::size_t colon = text.find(':');
  if (colon == std::string_view::npos || colon == 0) return;
  const std::string name(text.substr(0, colon));
  Definition definition;
  definition.text = text;
  std::string_view rest = text.substr(colon + 1);
  while (!rest.empty()) {
    const std::size_t end = rest.find(';');
    const std::string_view one = rest.substr(0, end);
    rest = end == std::string_view::npos ? std::string_view() : rest.substr(end + 1);
    Member member;
    if (one.empty()) continue;
    if (!parse_member(one, member)) {
      definition.why_not =
          fmt::format("its format has a field that is none: {}", printable(one, 40));
      break;
    }
    definition.members.push_back(std::move(member));
  }
  const auto [place, fresh] = definitions_.try_emplace(name, std::move(definition));
  if (fresh || place->second.text == text) return;
  place->second.why_not = "the log defines its format twice, and not alike";
  contradicted_ = true;
}

// "type name" or "type[n] name".
bool UlogFormats::parse_member(std::string_view text, Member& member) {
  const std::size_t blank = text.find(' ');
  if (blank == std::string_view::npos || blank == 0 || blank + 1 == text.size()) return false;
  std::string_view type = text.substr(0, blank);
  member.name = text.substr(blank + 1);
  const std::size_t bracket = type.find('[');
  if (bracket != std::string_view::npos) {
    const std::string_view number = type.substr(bracket + 1);
    const auto [end, error] =
        std::from_chars(number.data(), number.data() + number.size(), member.count);
    if (error != std::errc() || end + 1 != number.data() + number.size() || *end != ']')
      return false;
    member.array = true;
    type = type.substr(0, bracket);
  }
  member.type = type;
  return !type.empty();
}

UlogLayout UlogFormats::layout(const std::string& name) {
  UlogLayout out;
  out.why_not = flatten(name, "", 0, out);
  out.least_bytes = out.bytes;
  if (!out.why_not.empty()) {
    out.fields.clear();
    return out;
  }
  // Padding at the end of the outermost format is not written.
  const std::vector<Member>& members = definitions_.find(name)->second.members;
  for (auto last = members.rbegin(); last != members.rend(); ++last) {
    const auto number = ulog_number(last->type);
    if (!last->name.starts_with("_padding") || !number) break;
    out.least_bytes -= last->count * static_cast<std::uint32_t>(size_of(*number));
  }
  return out;
}

std::string UlogFormats::flatten(const std::string& format,
                                 const std::string& prefix,
                                 int depth,
                                 UlogLayout& out) {
  const auto found = definitions_.find(format);
  if (found == definitions_.end())
    return fmt::format("the log does not define its format {}", printable(format, 40));
  if (!found->second.why_not.empty()) return found->second.why_not;
  if (depth > kDeepest) return "its format holds itself";
  for (const Member& member : found->second.members) {
    std::string why_not = flatten_member(member, prefix, depth, out);
    if (!why_not.empty()) return why_not;
  }
  return "";
}

std::string UlogFormats::flatten_member(const Member& member,
                                        const std::string& prefix,
                                        int depth,
                                        UlogLayout& out) {
  if (prefix.size() + member.name.size() > kLongestName)
    return fmt::format("its fields have names of more than {} characters", kLongestName);
  const auto number = ulog_number(member.type);
  const std::uint64_t size = number ? size_of(*number) : 0;
  if (out.bytes + size * member.count > kMostBytes)
    return "its format is longer than a message can be";
  if (number && (member.name.starts_with("_padding") || member.type == "char")) {
    out.bytes += static_cast<std::uint32_t>(size * member.count);
    return "";
  }
  for (std::uint32_t k = 0; k < member.count; ++k) {
    if (++steps_ > kMostSteps || fields_ == kMostFields)
      return "the formats of the log have too many fields in all";
    const std::string name =
        member.array ? fmt::format("{}{}[{}]", prefix, member.name, k) : prefix + member.name;
    if (!number) {
      std::string why_not = flatten(member.type, name + ".", depth + 1, out);
      if (!why_not.empty()) return why_not;
      continue;
    }
    out.fields.push_back({name, *number, out.bytes});
    out.bytes += static_cast<std::uint32_t>(size);
    ++fields_;
  }
  return "";
}

}  // namespace libchar
