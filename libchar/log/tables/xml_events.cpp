#include "libchar/log/tables/xml_events.hpp"

#include <charconv>
#include <utility>

#include "libchar/core/refusal.hpp"
#include "libchar/core/text/text.hpp"

namespace libchar {
namespace {

constexpr std::size_t kMostTag = std::size_t{1} << 16U, kMostText = std::size_t{1} << 20U;
constexpr std::string_view kBlanks = " \t\r\n";

}  // namespace

XmlEvents::XmlEvents(std::function<std::size_t(char*, std::size_t)> bytes, std::string where)
    : from_{std::move(bytes)}, where_(std::move(where)) {}

void XmlEvents::refuse(std::string_view what) const {
  throw input_error("E0339", where_).says("broken XML: {}", what).hint("save the workbook again");
}

/// What is before `mark`, which is passed.
std::string XmlEvents::until(std::string_view mark, std::size_t most) {
  for (std::size_t searched = 0;;) {
    const std::size_t found = from_.raw.find(mark, from_.at + searched);
    if (found != std::string::npos) {
      std::string before = from_.raw.substr(from_.at, found - from_.at);
      from_.at = found + mark.size();
      return before;
    }
    const std::size_t have = from_.raw.size() - from_.at;
    if (have > most) refuse("a tag or a text without an end");
    searched = have < mark.size() ? 0 : have - mark.size() + 1;
    if (!from_.more()) refuse("it ends inside a tag");
  }
}

XmlEvents::Kind XmlEvents::next() {
  if (std::exchange(closes_, false)) return Kind::close;
  for (;;) {
    if (from_.at == from_.raw.size() && !from_.more()) return Kind::end;
    if (from_.raw[from_.at] != '<') {
      std::size_t end = from_.raw.find('<', from_.at);
      while (end == std::string::npos && from_.raw.size() - from_.at <= kMostText && from_.more())
        end = from_.raw.find('<', from_.at);
      if (end == std::string::npos) end = from_.raw.size();
      if (end - from_.at > kMostText + kMostTag) refuse("a text of more than a MiB");
      text_.clear();
      resolve(std::string_view(from_.raw).substr(from_.at, end - from_.at), text_);
      from_.at = end;
      return Kind::text;
    }
    while (from_.raw.size() - from_.at < 9 && from_.more()) {
    }
    const std::string_view here = std::string_view(from_.raw).substr(from_.at);
    if (here.starts_with("<?")) {
      until("?>", kMostTag);
    } else if (here.starts_with("<!--")) {
      until("-->", kMostText);
    } else if (here.starts_with("<![CDATA[")) {
      from_.at += 9;
      text_ = until("]]>", kMostText);
      return Kind::text;
    } else if (here.starts_with("<!")) {
      refuse("a document type");
    } else {
      ++from_.at;
      const std::string tag = until(">", kMostTag);
      read_tag(tag);
      return tag.starts_with('/') ? Kind::close : Kind::open;
    }
  }
}

bool XmlEvents::next_open() {
  for (;;) {
    const Kind kind = next();
    if (kind == Kind::open) return true;
    if (kind == Kind::end) return false;
  }
}

void XmlEvents::read_tag(std::string_view tag) {
  const bool close = tag.starts_with('/');
  if (close) tag.remove_prefix(1);
  closes_ = !close && tag.ends_with('/');
  if (closes_) tag.remove_suffix(1);
  std::size_t at = std::min(tag.find_first_of(kBlanks), tag.size());
  const std::string_view full = tag.substr(0, at);
  const std::size_t colon = full.find(':');
  name_ = full.substr(colon == std::string_view::npos ? 0 : colon + 1);
  if (name_.empty()) refuse("a tag without a name");
  if (close) return;
  attributes_.clear();
  while ((at = tag.find_first_not_of(kBlanks, at)) != std::string_view::npos) {
    const std::size_t sign = tag.find('=', at);
    const std::size_t first = sign == std::string_view::npos ? sign : tag.find_first_not_of(kBlanks, sign + 1);
    if (first == std::string_view::npos || (tag[first] != '"' && tag[first] != '\''))
      refuse("an attribute without a value");
    const std::size_t last = tag.find(tag[first], first + 1);
    if (last == std::string_view::npos) refuse("an attribute without an end");
    std::string_view key = tag.substr(at, sign - at);
    key = key.substr(0, key.find_first_of(kBlanks));
    std::string& value = attributes_[std::string(key)];
    value.clear();
    resolve(tag.substr(first + 1, last - first - 1), value);
    at = last + 1;
  }
}

std::string XmlEvents::attribute(std::string_view key) const {
  const auto found = attributes_.find(key);
  return found == attributes_.end() ? "" : found->second;
}

void XmlEvents::resolve(std::string_view raw, std::string& to) const {
  static constexpr std::pair<std::string_view, char> kNamed[] = {
      {"lt", '<'}, {"gt", '>'}, {"amp", '&'}, {"quot", '"'}, {"apos", '\''}};
  for (std::size_t at = 0; at < raw.size(); ++at) {
    const std::size_t end = raw[at] == '&' ? raw.find(';', at) : std::string_view::npos;
    if (end == std::string_view::npos) {
      to += raw[at];
      continue;
    }
    std::string_view word = raw.substr(at + 1, end - at - 1);
    at = end;
    if (word.starts_with('#')) {
      const bool hex = word.starts_with("#x");
      word.remove_prefix(hex ? 2 : 1);
      std::uint32_t code = 0;
      std::from_chars(word.data(), word.data() + word.size(), code, hex ? 16 : 10);
      append_utf8(to, code > 0 && code < 0xD800 ? code : '?');
      continue;
    }
    for (const auto& [name, c] : kNamed)
      if (word == name) to += c;
  }
}

}  // namespace libchar
