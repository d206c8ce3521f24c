#include "libchar/core/error.hpp"
#include "libchar/log/raw_rows.hpp"

namespace libchar {
std::unique_ptr<RowSource> open_npy(const std::string& path, const ReadOptions&) {
  throw Error({ErrorKind::input, "E0000", path, "npy is not read yet", "", ""});
}
bool sniff_npy(const std::string&, std::string_view) { return false; }
}  // namespace libchar
