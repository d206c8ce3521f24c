#include "libchar/fleet/detail/log_digest.hpp"

#include "libchar/core/file/file_text.hpp"
#include "libchar/core/file/sha256.hpp"

namespace libchar {

std::string digest_of_log(const std::string& path) {
  constexpr std::size_t kPieceOfLog = std::size_t{1} << 20U;
  Sha256 hash;
  for_pieces_of_file(path, kPieceOfLog, [&](std::string_view piece) { hash.update(piece); });
  return hash.finish();
}

}  // namespace libchar
