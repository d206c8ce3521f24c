// Preloaded into a program under test: a file system that is not a local disk.
//   LIBCHAR_STORAGE=WORD,WORD…
//   nameless   there are no files without a name (O_TMPFILE), as on NFS and SMB
//   readlocks  a descriptor that is open for reading only cannot be locked exclusively (EBADF), as on NFS
//   locks      nothing can be locked (ENOLCK)
//   links      there are no hard links (EOPNOTSUPP), as on FAT and some of SMB
//   slow       fsync, close, rename and link of files take up to 20 ms, each another time (LIBCHAR_STORAGE_SEED)

#include <dlfcn.h>
#include <fcntl.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>

namespace {

bool lacks(const char* word) {
  const char* storage = ::getenv("LIBCHAR_STORAGE");
  return storage != nullptr && ::strstr(storage, word) != nullptr;
}

std::atomic<unsigned long> state{0};

void takes_time() {
  if (!lacks("slow")) return;
  if (state == 0) {
    const char* seed = ::getenv("LIBCHAR_STORAGE_SEED");
    state = 2 * (seed == nullptr ? 1 : ::strtoul(seed, nullptr, 10)) + 1;
  }
  state = state * 6364136223846793005UL + 1442695040888963407UL;
  ::usleep(static_cast<useconds_t>((state >> 33U) % 20000));
}

int opened(int folder, const char* path, int flags, mode_t mode) {
  if ((flags & O_TMPFILE) == O_TMPFILE && lacks("nameless")) {
    errno = EOPNOTSUPP;
    return -1;
  }
  return static_cast<int>(::syscall(SYS_openat, folder, path, flags, mode));
}

mode_t mode_of(int flags, va_list more) {
  return (flags & (O_CREAT | __O_TMPFILE)) != 0 ? static_cast<mode_t>(va_arg(more, int)) : 0;
}

bool may_write(int file) { return (::syscall(SYS_fcntl, file, F_GETFL, 0) & O_ACCMODE) != O_RDONLY; }

/// Whether a lock is refused, with errno.
bool refused(int file, bool exclusive) {
  if (lacks("readlocks") && exclusive && !may_write(file))
    errno = EBADF;
  else if (lacks("locks") && !lacks("readlocks"))
    errno = ENOLCK;
  else
    return false;
  return true;
}

}  // namespace

extern "C" {

#define OPENING(FOLDER)                     \
  va_list more;                             \
  va_start(more, flags);                    \
  const mode_t mode = mode_of(flags, more); \
  va_end(more);                             \
  return opened(FOLDER, path, flags, mode)
int open(const char* path, int flags, ...) { OPENING(AT_FDCWD); }
int open64(const char* path, int flags, ...) { OPENING(AT_FDCWD); }
int openat(int folder, const char* path, int flags, ...) { OPENING(folder); }
int openat64(int folder, const char* path, int flags, ...) { OPENING(folder); }

int flock(int file, int operation) {
  if ((operation & LOCK_UN) == 0 && refused(file, (operation & LOCK_EX) != 0)) return -1;
  return static_cast<int>(::syscall(SYS_flock, file, operation));
}

static int controlled(int file, int command, void* argument) {
  const bool locks = command == F_SETLK || command == F_SETLKW || command == F_OFD_SETLK || command == F_OFD_SETLKW;
  if (locks) {
    const auto type = static_cast<struct flock*>(argument)->l_type;
    if (type != F_UNLCK && refused(file, type == F_WRLCK)) return -1;
  }
  return static_cast<int>(::syscall(SYS_fcntl, file, command, argument));
}
int fcntl(int file, int command, ...) {
  va_list more;
  va_start(more, command);
  void* const argument = va_arg(more, void*);
  va_end(more);
  return controlled(file, command, argument);
}
int fcntl64(int file, int command, ...) {
  va_list more;
  va_start(more, command);
  void* const argument = va_arg(more, void*);
  va_end(more);
  return controlled(file, command, argument);
}

int fsync(int file) {
  takes_time();
  return static_cast<int>(::syscall(SYS_fsync, file));
}
int close(int file) {
  if (may_write(file)) takes_time();
  return static_cast<int>(::syscall(SYS_close, file));
}
int rename(const char* from, const char* to) {
  takes_time();
  return static_cast<int>(::syscall(SYS_rename, from, to));
}
int link(const char* from, const char* to) {
  takes_time();
  if (lacks("links")) {
    errno = EOPNOTSUPP;
    return -1;
  }
  return static_cast<int>(::syscall(SYS_link, from, to));
}
int linkat(int a, const char* from, int b, const char* to, int flags) {
  takes_time();
  if (lacks("links")) {
    errno = EOPNOTSUPP;
    return -1;
  }
  return static_cast<int>(::syscall(SYS_linkat, a, from, b, to, flags));
}

}  // extern "C"
