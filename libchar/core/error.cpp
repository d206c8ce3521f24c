#include "libchar/core/error.hpp"

#include <utility>

#include "libchar/core/text.hpp"

namespace libchar {

std::string one_line(const Fault& fault) {
  std::string line;
  if (!fault.where.empty()) line += printable(fault.where) + ": ";
  line += "error";
  if (!fault.code.empty()) line += " " + fault.code;
  line += ": " + printable(fault.what);
  if (!fault.got.empty()) line += "; got \"" + printable(fault.got, 40) + "\"";
  if (!fault.hint.empty()) line += "; hint: " + printable(fault.hint);
  return line;
}

Error::Error(Fault fault) : fault_(std::move(fault)), message_(one_line(fault_)) {}

}  // namespace libchar
