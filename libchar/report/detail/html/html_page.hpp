#pragma once
// The frame of every page: one file that carries its data, scripts and styles, and asks for nothing
// from anywhere.
//
// The content security policy names each script and the style by its SHA-256, so that nothing else
// can run even if an escape were forgotten.

#include <string>
#include <vector>

#include "libchar/core/document/json.hpp"
#include "libchar/core/finding.hpp"
#include "libchar/core/table/table.hpp"
#include "libchar/log/recording.hpp"

namespace libchar {

struct PageParts {
  std::string title;    ///< what kind of report
  std::string subject;  ///< of what: a file's or scene's name, untrusted
  std::string script;   ///< goes behind page_common.js
  std::string style;
  bool all_numbers = true;  ///< its data are the whole document: it can be saved from the page
};

/// The whole page: `body` is HTML, `data` the document for its script (json_in_script).
std::string html_page(const PageParts& parts, const std::string& body, const std::string& data);

/// As a shell wants it typed: words quoted where they need it.
std::string command_line(const std::vector<std::string>& command);
/// <details> with a document, "" when there is none.
std::string settings_details(const Json& document);
/// Rows of a table of facts: file, format, size and digest of an input; program and command.
void add_input_file(Table& facts, const LogInfo& log);
void add_program(Table& facts, const std::vector<std::string>& command);
Cell digest_cell(const LogInfo& log);
/// "Repairs and warnings": a table by kind, or "None."
std::string warnings_part(const Findings& warnings);

}  // namespace libchar
