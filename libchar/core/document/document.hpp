#pragma once
// A YAML or JSON document as a tree that remembers the place of every key and value, so that a
// refusal can name line and column.

#include <string>
#include <string_view>
#include <vector>

#include "libchar/core/document/json.hpp"

namespace libchar {

struct DocumentEntry;

/// One value of a document: scalar, list or map.
struct Document {
  enum class Kind { null, boolean, number, text, list, map };
  Kind kind = Kind::null;
  bool boolean = false;
  double number = 0;   ///< of a number
  bool whole = false;  ///< the number is written without point and exponent
  std::string text;    ///< of a text; of another scalar, as it is written
  std::vector<Document> list;
  std::vector<DocumentEntry> map;  ///< in the order of the file
  int line = 0, column = 0;        ///< from 1; 0 when unknown

  const DocumentEntry* find(std::string_view key) const;
};

struct DocumentEntry {
  std::string key;
  int line = 0, column = 0;
  Document value;
};

/// Limits of one document, YAML and JSON alike.
inline constexpr std::size_t kMaxDocumentBytes = std::size_t{16} << 20U;
inline constexpr std::size_t kMaxDocumentDepth = 64;
namespace detail {
inline constexpr std::size_t kMaxDocumentValues = 500000;  // each takes up to .3 kB
}

/// One YAML document of plain keys, texts and numbers: no aliases, anchors, tags, merge keys, duplicate keys or second
/// document; depth <= 64, size <= 16 MiB, keys <= 1024 characters. A plain scalar that reads as a decimal number
/// becomes one ("010", "0x10", ".inf" and "no" are texts). Throws Error(input) with FILE:LINE:COL.
Document parse_yaml_document(std::string_view text, const std::string& file);

/// JSON when `file` ends in .json, else YAML.
Document parse_document(std::string_view text, const std::string& file);

/// The document without its places.
Json as_json(const Document& document);

// Documents are small: their files are read whole.

/// Reads a whole small text file: a regular one of at most 16 MiB. Throws Error(input).
std::string read_document_text(const std::string& path);

// JSON with the places of its values.

/// The tree of a JSON document, by parse_json's rules. Throws Error(input) with FILE:LINE:COL (byte N).
Document parse_json_document(std::string_view text, const std::string& file);

}  // namespace libchar
