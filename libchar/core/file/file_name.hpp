#pragma once
// File names from names that a log brought along.

#include <set>
#include <string>
#include <string_view>

namespace libchar {

/// A file name for a channel: letters of any script, digits, '.', '_' and '-' are kept; blanks, other ASCII, controls and what is
/// no UTF-8 become '_'; never empty, never starting with '.', at most 100 bytes of whole characters.
std::string file_name_for(std::string_view channel);

/// The same, with _2, _3… behind it when an earlier name differs by nothing or by capitals only (some file systems do not tell
/// those apart). `taken` remembers the names given, in small letters.
std::string unused_file_name_for(std::string_view channel, std::set<std::string>& taken);

}  // namespace libchar
