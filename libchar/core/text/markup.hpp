#pragma once
// Text inside HTML and XML.

#include <string>
#include <string_view>

namespace libchar {

/// & < > " and ' as the entities that stand for them in the text and the attributes of HTML, SVG and XML.
std::string markup_entities(std::string_view text);

}  // namespace libchar
