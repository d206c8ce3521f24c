#pragma once
// What calls itself CSV and is something else: recognised by its first bytes, with the way to a table.

#include <string>
#include <string_view>

namespace libchar::csv {

/// Throws Error(input) with what it is and how to read it: another format by its first bytes, UTF-16, nothing at all,
/// or binary data. NUL bytes alone are left to the row parser, which knows logs that a power failure cut.
void refuse_other_content(std::string_view head, const std::string& file);
/// The same of formats that are told by their first bytes alone, whatever the file is called.
void refuse_other_format(std::string_view head, const std::string& file);
/// The same of scenes, models, reports and other documents of this program, by the word behind `format`.
void refuse_document(std::string_view front, const std::string& file);

}  // namespace libchar::csv
