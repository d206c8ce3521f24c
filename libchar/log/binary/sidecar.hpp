#pragma once
// The sidecar FILE.json or FILE.yaml that says what a raw binary file holds (docs/formats.md lists the keys).

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "libchar/core/document/fields.hpp"
#include "libchar/log/binary/number_type.hpp"

namespace libchar {

struct SidecarChannel {
  std::string name;  ///< "c0", "c1"… when the sidecar gives only a number of channels
  std::string unit;
  double scale = 1, offset = 0;  ///< value = raw * scale + offset
};

struct Sidecar {
  NumberFormat number;
  std::vector<SidecarChannel> channels;
  bool named = false;
  double rate_hz = 0;        ///< 0 when not given
  std::uint64_t offset = 0;  ///< bytes to skip before the first value
  std::optional<std::uint64_t> rows;
  std::optional<std::int64_t> t0_ns;
  bool planar = false;
};

/// The rows that reader, writer and docs/formats.md share.
const Fields<Sidecar>& sidecar_fields();

/// Path of the sidecar that stands beside `log`, "" when there is none. Throws Error(input) when there are two.
std::string find_sidecar(const std::string& log);

/// Reads one sidecar (JSON by the suffix .json, else YAML). Throws Error(input) with line, column
/// and the nearest known key.
Sidecar read_sidecar(const std::string& path);
Sidecar parse_sidecar(std::string_view text, const std::string& file, bool json);

/// The document that read_sidecar reads back to the same sidecar.
std::string sidecar_json(const Sidecar& sidecar);

/// A minimal sidecar, for messages.
std::string minimal_sidecar();

}  // namespace libchar
