#include "libchar/core/coefficient.hpp"

namespace libchar {

std::string_view name_of(Status status) {
  switch (status) {
    case Status::detected:
      return "detected";
    case Status::not_detected:
      return "not_detected";
    case Status::undetermined:
      return "undetermined";
    case Status::given:
      return "given";
    case Status::not_fitted:
      return "not_fitted";
  }
  return "";
}

}  // namespace libchar
