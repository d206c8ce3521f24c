#include "libchar/log/binary/yaml_guard.hpp"

#include "libchar/core/document.hpp"

namespace libchar {

Json parse_guarded_yaml(std::string_view text, const std::string& file) {
  return as_json(parse_yaml_document(text, file));
}

}  // namespace libchar
