#include "libchar/log/ros/sqlite_file.hpp"

#include "libchar_have.hpp"
#if LIBCHAR_HAVE_SQLITE
#include <sqlite3.h>

#include <algorithm>
#include <cstring>
#include <memory>
#include <mutex>

#include "libchar/core/refusal.hpp"
#include "libchar/log/binary/file.hpp"

namespace libchar {
namespace {

// What SQLite allocates for an open file: its part first.
struct OpenFile {
  sqlite3_file base;
  BinaryFile* file;
  std::uint64_t size;  // of whole pages
};

OpenFile& opened(sqlite3_file* file) { return *reinterpret_cast<OpenFile*>(file); }

// Big-endian at byte 16 of the file: 1 stands for 65536.
std::uint64_t whole_pages(const BinaryFile& file) {
  const std::string head = file.head(18);
  if (head.size() < 18) return 0;
  const std::uint64_t said = static_cast<unsigned char>(head[16]) * 256U + static_cast<unsigned char>(head[17]);
  const std::uint64_t page = said == 1 ? 65536 : said;
  return page == 0 ? 0 : file.size() / page * page;
}

int close_file(sqlite3_file* file) {
  delete opened(file).file;
  return SQLITE_OK;
}

// What is behind the end reads as zeros, by contract.
int read_file(sqlite3_file* file, void* to, int count, sqlite3_int64 at) {
  const OpenFile& open = opened(file);
  const auto wanted = static_cast<std::size_t>(count);
  const auto begin = static_cast<std::uint64_t>(at);
  const auto there =
      static_cast<std::size_t>(begin < open.size ? std::min<std::uint64_t>(wanted, open.size - begin) : 0);
  auto* bytes = static_cast<std::byte*>(to);
  std::memset(bytes + there, 0, wanted - there);
  try {
    open.file->read(begin, {bytes, there});
  } catch (const Error&) {
    return SQLITE_IOERR_READ;
  }
  return there == wanted ? SQLITE_OK : SQLITE_IOERR_SHORT_READ;
}

int size_of_file(sqlite3_file* file, sqlite3_int64* size) {
  *size = static_cast<sqlite3_int64>(opened(file).size);
  return SQLITE_OK;
}

const sqlite3_io_methods& methods() {
  static const sqlite3_io_methods table = [] {
    sqlite3_io_methods all{};
    all.iVersion = 1;
    all.xClose = close_file;
    all.xRead = read_file;
    all.xWrite = [](sqlite3_file*, const void*, int, sqlite3_int64) { return SQLITE_READONLY; };
    all.xTruncate = [](sqlite3_file*, sqlite3_int64) { return SQLITE_READONLY; };
    all.xSync = [](sqlite3_file*, int) { return SQLITE_OK; };
    all.xFileSize = size_of_file;
    all.xLock = [](sqlite3_file*, int) { return SQLITE_OK; };
    all.xUnlock = [](sqlite3_file*, int) { return SQLITE_OK; };
    all.xCheckReservedLock = [](sqlite3_file*, int* held) {
      *held = 0;
      return SQLITE_OK;
    };
    all.xFileControl = [](sqlite3_file*, int, void*) { return SQLITE_NOTFOUND; };
    all.xSectorSize = [](sqlite3_file*) { return 4096; };
    all.xDeviceCharacteristics = [](sqlite3_file*) { return SQLITE_IOCAP_IMMUTABLE; };
    return all;
  }();
  return table;
}

int open_file(sqlite3_vfs*, sqlite3_filename path, sqlite3_file* file, int flags, int* out) {
  file->pMethods = nullptr;
  if (path == nullptr || (flags & SQLITE_OPEN_MAIN_DB) == 0) return SQLITE_CANTOPEN;
  try {
    auto read = std::make_unique<BinaryFile>(path);
    OpenFile& open = opened(file);
    open.size = whole_pages(*read);
    open.file = read.release();
  } catch (const std::exception&) {
    return SQLITE_CANTOPEN;
  }
  file->pMethods = &methods();
  if (out != nullptr) *out = SQLITE_OPEN_READONLY | SQLITE_OPEN_MAIN_DB;
  return SQLITE_OK;
}

int whole_path(sqlite3_vfs*, const char* path, int room, char* to) {
  const std::size_t size = std::strlen(path) + 1;
  if (size > static_cast<std::size_t>(room)) return SQLITE_CANTOPEN;
  std::memcpy(to, path, size);
  return SQLITE_OK;
}

constexpr const char* kFileSystem = "libchar-one-file";

// Time and random numbers are the system's; files are not.
void register_once() {
  static std::once_flag once;
  std::call_once(once, [] {
    static sqlite3_vfs system = *sqlite3_vfs_find(nullptr);
    system.pNext = nullptr;
    system.zName = kFileSystem;
    system.szOsFile = static_cast<int>(sizeof(OpenFile));
    system.xOpen = open_file;
    system.xDelete = [](sqlite3_vfs*, const char*, int) { return SQLITE_IOERR_DELETE; };
    system.xAccess = [](sqlite3_vfs*, const char*, int, int* there) {
      *there = 0;
      return SQLITE_OK;
    };
    system.xFullPathname = whole_path;
    sqlite3_vfs_register(&system, 0);
  });
}

}  // namespace

sqlite3* open_sqlite(const std::string& path) {
  const BinaryFile readable(path);  // what is no file is told as in every format
  register_once();
  sqlite3* handle = nullptr;
  const int code = sqlite3_open_v2(path.c_str(), &handle, SQLITE_OPEN_READONLY, kFileSystem);
  if (code == SQLITE_OK) return handle;
  const std::string why = sqlite3_errstr(code);
  sqlite3_close(handle);
  throw input_error("E0101", path).says("cannot be opened: " + why);
}

}  // namespace libchar
#endif
