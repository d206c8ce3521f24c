#include "libchar/log/csv/head/content.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "libchar/core/error.hpp"
#include "libchar/log/csv/line.hpp"

namespace libchar::csv {
namespace {

// Text has next to no control characters; NUL bytes are left to the row parser, which knows logs
// that a power failure cut.
void refuse_binary(std::string_view head, const std::string& file) {
  std::size_t controls = 0, others = 0, first = 0;
  for (std::size_t i = 0; i < std::min<std::size_t>(head.size(), 4096); ++i) {
    const auto byte = static_cast<unsigned char>(head[i]);
    if (byte == 0) continue;
    const bool control =
        byte < 0x20 && std::string_view("\t\n\v\f\r\x1A").find(head[i]) == std::string_view::npos;
    if (control && controls++ == 0) first = i;
    ++others;
  }
  if (controls < 2 || controls * 50 < others) return;
  std::size_t line = 1, column = 1;
  for (std::size_t i = 0; i < first; ++i, ++column)
    if (head[i] == '\n') ++line, column = 0;
  throw Error(
      {ErrorKind::input,
       "E0301",
       at(file, line, column, first),
       fmt::format("content is binary, not text: {} control characters in the first {} bytes",
                   controls,
                   std::min<std::size_t>(head.size(), 4096)),
       "",
       "`format` raw with a sidecar reads raw binary (docs: raw binary)"});
}

}  // namespace

void refuse_other_content(std::string_view head, const std::string& file) {
  const auto begins = [&](std::string_view magic) { return head.substr(0, magic.size()) == magic; };
  const char* what = nullptr;
  const char* hint = "";
  if (head.empty())
    throw Error({ErrorKind::input, "E0322", at(file, 1, 1, 0), "the file is empty", "", ""});
  if (begins("\x93NUMPY"))
    what = "content is a NumPy array (NPY), not CSV", hint = "read it with `format` npy";
  else if (begins("\x1F\x8B"))
    what = "content is compressed (gzip), not CSV", hint = "unpack it first: gunzip";
  else if (begins("PK\x03\x04"))
    what = "content is a ZIP archive (XLSX or NPZ?), not CSV",
    hint = "unpack it, or export it as CSV";
  else if (begins("\x28\xB5\x2F\xFD"))
    what = "content is compressed (zstd), not CSV", hint = "unpack it first: unzstd";
  else if (begins("BZh"))
    what = "content is compressed (bzip2), not CSV", hint = "unpack it first: bunzip2";
  else if (begins("\xFF\xFE") || begins("\xFE\xFF"))
    what = "content is UTF-16, not UTF-8", hint = "convert it: iconv -f utf-16 -t utf-8";
  else if (begins("\x89PNG") || begins("\xFF\xD8\xFF"))
    what = "content is a picture, not CSV";
  else if (begins("%PDF"))
    what = "content is PDF, not CSV", hint = "export the table as CSV";
  else if (begins("\x89HDF"))
    what = "content is HDF5, not CSV", hint = "export it as CSV or .npy";
  if (what != nullptr) throw Error({ErrorKind::input, "E0301", at(file, 1, 1, 0), what, "", hint});
  if (head.size() >= 4 && ((head[0] == 0) != (head[1] == 0)) &&
      ((head[2] == 0) != (head[3] == 0)) && head[0] == head[2 * (head[0] == 0)])
    throw Error({ErrorKind::input,
                 "E0301",
                 at(file, 1, 1, 0),
                 "content is UTF-16, not UTF-8",
                 "",
                 "convert it: iconv -f utf-16 -t utf-8"});
  refuse_binary(head, file);
  const std::size_t front = head.find_first_not_of(" \t\r\n");
  if (front == std::string_view::npos || (head[front] != '<' && head[front] != '{')) return;
  const bool markup = head[front] == '<';
  throw Error({ErrorKind::input,
               "E0301",
               at(file, 1, 1, 0),
               markup ? "content is HTML or XML, not CSV" : "content is JSON, not CSV",
               "",
               markup ? "was a web page saved in place of the file?"
                      : "is this the sidecar of a raw log, or a result?"});
}

}  // namespace libchar::csv
