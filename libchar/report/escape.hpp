#pragma once
// Untrusted text (channel names, file names, cells) on its way into a page or a table: one function
// for each context.

#include <string>
#include <string_view>

#include "libchar/core/json.hpp"

namespace libchar {

/// For text between tags: & < > " ' become entities; control, bidirectional and zero-width
/// characters and bytes that are not UTF-8 become visible escapes.
std::string html_text(std::string_view text);

/// For a value inside double quotes of a tag: as html_text, and nothing else may stand there
/// unquoted.
std::string html_attribute(std::string_view text);

/// A document for the inside of <script type="application/json">: '<', '>' and '&' as \u003c…, so
/// that neither "</script>" nor "<!--" can end or change the element, and everything beyond ASCII
/// escaped.
std::string json_in_script(const Json& document);

/// For the inside of an HTML comment: "--" cannot occur, so the comment ends where we end it.
std::string html_comment(std::string_view text);

/// A text cell of a table that may be opened in a spreadsheet: quoted when needed (RFC 4180), and
/// an apostrophe put in front of = + - @ TAB CR, which would start a formula.
std::string csv_cell(std::string_view text);

/// For Markdown: no mark of it becomes a tag, link, column or line.
std::string markdown_text(std::string_view text);

}  // namespace libchar
