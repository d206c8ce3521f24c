// The digest of a recording by itself: the page has a second worker take it while the first one reads
// (script/worker.js).
#include <emscripten.h>

#include <string>

#include "libchar/log/binary/file.hpp"

extern "C" EMSCRIPTEN_KEEPALIVE const char* page_digest(const char* path) {
  static std::string digest;
  const libchar::BinaryFile file(path);
  digest = libchar::FileHash(file, true).finish();
  return digest.c_str();
}
