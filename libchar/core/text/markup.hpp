#pragma once
// Text inside HTML, XML and Markdown.

#include <string>
#include <string_view>

namespace libchar {

/// & < > " and ' as the entities that stand for them in the text and the attributes of HTML, SVG and XML.
std::string markup_entities(std::string_view text);

/// For Markdown: no mark of it becomes a tag, link, column or line; what does not print, an escape.
std::string markdown_text(std::string_view text);

}  // namespace libchar
