#pragma once
// Untrusted text (channel names, file names, cells) on its way into a page or a table: one function
// for each context.

#include <string>
#include <string_view>

#include "libchar/core/document/json.hpp"
#include "libchar/core/text/markup.hpp"

namespace libchar {

/// For text between tags: & < > " ' become entities; control, bidirectional and zero-width
/// characters and bytes that are not UTF-8 become visible escapes.
std::string html_text(std::string_view text);

/// For a value inside double quotes of a tag: as html_text, and nothing else may stand there
/// unquoted.
std::string html_attribute(std::string_view text);

/// A folder or file relative to the page, for an address inside double quotes of a tag: what is no letter, digit or one of -._~ becomes %HH, so
/// that no part of a name is a scheme, a host, a query or a fragment.
std::string html_address(std::string_view path);

/// A document for the inside of <script type="application/json">: '<', '>' and '&' as \u003c…, so
/// that neither "</script>" nor "<!--" can end or change the element, and everything beyond ASCII
/// escaped.
std::string json_in_script(const Json& document);

/// For the inside of an HTML comment: "--" cannot occur, so the comment ends where we end it.
std::string html_comment(std::string_view text);

}  // namespace libchar
