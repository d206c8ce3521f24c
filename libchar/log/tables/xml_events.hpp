#pragma once
// XML 1.0 as far as the parts of a workbook need it: tags, attributes and text, one after the other,
// in constant memory. Document types, and with them entities, are refused.

#include <functional>
#include <map>
#include <string>
#include <string_view>

#include "libchar/log/csv/made_text.hpp"

namespace libchar {

class XmlEvents {
 public:
  enum class Kind { open, close, text, end };
  /// `bytes` gives the next bytes, 0 at the end; `where` begins errors. Throws Error(input) E0339.
  XmlEvents(std::function<std::size_t(char*, std::size_t)> bytes, std::string where);

  /// The next event. <a/> opens and closes.
  Kind next();
  /// Of a tag, without the prefix of its namespace.
  const std::string& name() const { return name_; }
  /// Of the tag that opened last; "" when it is not there. With its prefix, "r:id".
  std::string attribute(std::string_view key) const;
  /// With its character references resolved.
  const std::string& text() const { return text_; }
  /// Skips to the next tag that opens; false at the end.
  bool next_open();

 private:
  [[noreturn]] void refuse(std::string_view what) const;
  std::string until(std::string_view mark, std::size_t most);
  void read_tag(std::string_view tag);
  void resolve(std::string_view raw, std::string& to) const;

  csv::Feed from_;
  std::string where_, name_, text_;
  std::map<std::string, std::string, std::less<>> attributes_;
  bool closes_ = false;
};

}  // namespace libchar
