// The smallest log format, for the test that it costs a file and a line: CSV under another name.

#include "libchar/log/detail/format.hpp"

namespace libchar {

Format csv_format();

Format readings_format() {
  Format row = csv_format();
  row.about.name = "readings";
  row.about.title = "readings of a test";
  row.about.suffixes = {".readings"};
  row.about.written_suffixes = {};
  row.sniff = [](const std::string&, std::string_view) { return false; };
  row.write = nullptr;
  return row;
}

}  // namespace libchar
