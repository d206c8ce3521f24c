#include "libchar/scene/text/signal_text.hpp"

#include "libchar/core/document/document.hpp"
#include "libchar/core/error.hpp"
#include "libchar/core/text/decimal.hpp"
#include "libchar/scene/detail/scene_signal.hpp"

namespace libchar {

SignalSpec parse_signal(const std::string& text, const std::string& place) {
  if (const auto value = parse_double(text)) {
    SignalSpec constant;
    constant.kind = "constant";
    constant.value = *value;
    return constant;
  }
  // The map that a scene file would hold.
  std::string map = "{kind: " + text.substr(0, text.find(','));
  for (std::size_t at = text.find(','); at != std::string::npos;) {
    const std::size_t end = text.find(',', at + 1);
    const std::string pair = text.substr(at + 1, end == std::string::npos ? end : end - at - 1);
    const std::size_t equals = pair.find('=');
    if (equals == std::string::npos)
      throw Error({ErrorKind::usage,
                   "E0721",
                   place,
                   "expected KIND,key=value,…",
                   text,
                   "such as sine,amplitude=2,frequency_hz=0.1"});
    map += ", " + pair.substr(0, equals) + ": " + pair.substr(equals + 1);
    at = end;
  }
  return read_signal(parse_yaml_document(map + "}", place), place, "");
}

}  // namespace libchar
