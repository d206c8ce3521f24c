// Preloaded into a program under test: the n-th call of a kind fails, once or from then on, or the
// process is killed before it.
//   LIBCHAR_FAULT=KIND:N    the N-th call (from 1) of KIND after the beginning of main fails
//   LIBCHAR_FAULT=KIND:N+   that one and all after it
//   LIBCHAR_FAULT_LOG=FILE  how often each kind was called, as KIND COUNT lines, and whether a fault came about
//   LIBCHAR_FAULT_FILE=FILE the file that shrinks or grows
// Kinds: write open read fsync rename link close stat mmap unlink mkdir malloc thread, and kill: SIGKILL before the
// N-th call that changes a file system (write, open, fsync, rename, link, unlink, mkdir, truncate); shrink, grow:
// before the N-th read FILE loses its second half, or gets it once more. What glibc does inside itself is not seen.

#include <dlfcn.h>
#include <fcntl.h>
#include <pthread.h>
#include <signal.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/uio.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>

extern "C" {
void* __libc_malloc(size_t);
void* __libc_calloc(size_t, size_t);
void* __libc_realloc(void*, size_t);
void* __libc_memalign(size_t, size_t);
void __libc_free(void*);
}

namespace {

enum Kind {
  kWrite,
  kOpen,
  kRead,
  kFsync,
  kRename,
  kLink,
  kClose,
  kStat,
  kMmap,
  kUnlink,
  kMkdir,
  kMalloc,
  kThread,
  kKill,
  kShrink,
  kGrow,
  kKinds
};
constexpr const char* kNames[kKinds] = {"write", "open",   "read",  "fsync",  "rename", "link", "close",  "stat",
                                        "mmap",  "unlink", "mkdir", "malloc", "thread", "kill", "shrink", "grow"};
// What these fail with in life: a full disk, too many files, a broken disk, no memory.
constexpr int kErrors[kKinds] = {ENOSPC, EMFILE, EIO,    EIO,    EACCES, EACCES, EIO, EACCES,
                                 ENOMEM, EACCES, EACCES, ENOMEM, EAGAIN, 0,      0,   0};

std::atomic<long> counts[kKinds];
std::atomic<bool> armed{false}, came_about{false};
int kind = -1;
long at = 0;
bool for_ever = false;

bool fails(Kind k) {
  if (!armed.load(std::memory_order_relaxed)) return false;
  const long n = ++counts[k];
  if (k != kind || (for_ever ? n < at : n != at)) return false;
  came_about = true;
  errno = kErrors[k];
  return true;
}

void changes() {
  if (!armed.load(std::memory_order_relaxed)) return;
  const long n = ++counts[kKill];
  if (kind == kKill && n == at) ::kill(::getpid(), SIGKILL);
}

// Somebody else writes to the file that is being read.
void moves() {
  if (!armed.load(std::memory_order_relaxed)) return;
  const long n = ++counts[kShrink];
  counts[kGrow] = n;
  const char* path = ::getenv("LIBCHAR_FAULT_FILE");
  if (n != at || (kind != kShrink && kind != kGrow) || path == nullptr) return;
  const int file = static_cast<int>(::syscall(SYS_openat, AT_FDCWD, path, O_RDWR | O_CLOEXEC, 0));
  const long size = ::syscall(SYS_lseek, file, 0, SEEK_END), half = size / 2;
  came_about = size > 0;
  if (kind == kShrink) {
    ::syscall(SYS_ftruncate, file, half);
  } else {
    static char second[1 << 16];
    const long got = ::syscall(SYS_pread64, file, second, sizeof second, half);
    ::syscall(SYS_pwrite64, file, second, got > 0 ? got : 0, size);
  }
  ::syscall(SYS_close, file);
}

template <typename F>
F* real_one(F*, const char* name) {
  return reinterpret_cast<F*>(::dlsym(RTLD_NEXT, name));
}

void read_order() {
  const char* order = ::getenv("LIBCHAR_FAULT");
  if (!order) return;
  const char* colon = ::strchr(order, ':');
  if (!colon) return;
  for (int k = 0; k < kKinds; ++k)
    if (::strncmp(order, kNames[k], static_cast<size_t>(colon - order)) == 0 &&
        ::strlen(kNames[k]) == static_cast<size_t>(colon - order))
      kind = k;
  char* end = nullptr;
  at = ::strtol(colon + 1, &end, 10);
  for_ever = *end == '+';
}

void write_counts() {
  armed = false;
  const char* path = ::getenv("LIBCHAR_FAULT_LOG");
  if (!path) return;
  char text[1024];
  int length = ::snprintf(text, sizeof text, "came_about %d\n", came_about ? 1 : 0);
  for (int k = 0; k < kKinds; ++k)
    length +=
        ::snprintf(text + length, sizeof text - static_cast<size_t>(length), "%s %ld\n", kNames[k], counts[k].load());
  const long file = ::syscall(SYS_openat, AT_FDCWD, path, O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  if (file < 0) return;
  ::syscall(SYS_write, file, text, length);
  ::syscall(SYS_close, file);
}

int (*program)(int, char**, char**) = nullptr;

int counted_main(int argc, char** argv, char** environment) {
  read_order();
  __libc_free(__libc_calloc(1, 1));
  __libc_free(__libc_memalign(64, 64));
  __libc_free(__libc_realloc(__libc_malloc(1), 2));
  ::atexit(write_counts);
  armed = true;
  const int code = program(argc, argv, environment);
  armed = false;
  return code;
}

}  // namespace

extern "C" {

int __libc_start_main(int (*entry)(int, char**, char**), int argc, char** argv, void (*init)(), void (*fini)(),
                      void (*rtld_fini)(), void* stack_end) {
  using Start = int (*)(int (*)(int, char**, char**), int, char**, void (*)(), void (*)(), void (*)(), void*);
  program = entry;
  const auto start = reinterpret_cast<Start>(::dlsym(RTLD_NEXT, "__libc_start_main"));
  return start(counted_main, argc, argv, init, fini, rtld_fini, stack_end);
}

// The program counts its heap in a malloc of its own in front of these. They are found before main:
// dlsym inside dlerror inside realloc would free what dlerror holds.
#define HEAP(NAME, PARAMETERS, ARGUMENTS)                              \
  void* NAME PARAMETERS {                                              \
    using F = void* PARAMETERS;                                        \
    static F* real = nullptr;                                          \
    if (!real) real = reinterpret_cast<F*>(::dlsym(RTLD_NEXT, #NAME)); \
    return fails(kMalloc) ? nullptr : real ARGUMENTS;                  \
  }
HEAP(__libc_malloc, (size_t size), (size))
HEAP(__libc_calloc, (size_t count, size_t size), (count, size))
HEAP(__libc_realloc, (void* old, size_t size), (old, size))
HEAP(__libc_memalign, (size_t alignment, size_t size), (alignment, size))

ssize_t write(int file, const void* data, size_t size) {
  changes();
  if (fails(kWrite)) return -1;
  return ::syscall(SYS_write, file, data, size);
}
ssize_t pwrite64(int file, const void* data, size_t size, off64_t offset) {
  changes();
  if (fails(kWrite)) return -1;
  return ::syscall(SYS_pwrite64, file, data, size, offset);
}
ssize_t pwrite(int file, const void* data, size_t size, off_t offset) { return pwrite64(file, data, size, offset); }
ssize_t writev(int file, const iovec* parts, int count) {
  changes();
  if (fails(kWrite)) return -1;
  return ::syscall(SYS_writev, file, parts, count);
}
size_t fwrite(const void* data, size_t size, size_t count, FILE* stream) {
  const auto real = real_one(&::fwrite, "fwrite");
  changes();
  return fails(kWrite) ? 0 : real(data, size, count, stream);
}

ssize_t read(int file, void* data, size_t size) {
  moves();
  if (fails(kRead)) return -1;
  return ::syscall(SYS_read, file, data, size);
}
ssize_t pread64(int file, void* data, size_t size, off64_t offset) {
  moves();
  if (fails(kRead)) return -1;
  return ::syscall(SYS_pread64, file, data, size, offset);
}
ssize_t pread(int file, void* data, size_t size, off_t offset) { return pread64(file, data, size, offset); }
ssize_t readv(int file, const iovec* parts, int count) {
  if (fails(kRead)) return -1;
  return ::syscall(SYS_readv, file, parts, count);
}

static int opened(int folder, const char* path, int flags, mode_t mode) {
  if ((flags & (O_CREAT | O_TMPFILE | O_TRUNC)) != 0 && (flags & O_ACCMODE) != O_RDONLY) changes();
  if (fails(kOpen)) return -1;
  return static_cast<int>(::syscall(SYS_openat, folder, path, flags, mode));
}
static mode_t mode_of(int flags, va_list more) {
  return (flags & (O_CREAT | __O_TMPFILE)) != 0 ? static_cast<mode_t>(va_arg(more, int)) : 0;
}
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
FILE* fopen64(const char* path, const char* mode) {
  const auto real = real_one(&::fopen64, "fopen64");
  if (mode[0] != 'r') changes();
  return fails(kOpen) ? nullptr : real(path, mode);
}
FILE* fopen(const char* path, const char* mode) { return fopen64(path, mode); }

int fsync(int file) {
  changes();
  return fails(kFsync) ? -1 : static_cast<int>(::syscall(SYS_fsync, file));
}
int fdatasync(int file) {
  changes();
  return fails(kFsync) ? -1 : static_cast<int>(::syscall(SYS_fdatasync, file));
}
int ftruncate(int file, off_t size) {
  changes();
  return fails(kWrite) ? -1 : static_cast<int>(::syscall(SYS_ftruncate, file, size));
}
int ftruncate64(int file, off64_t size) { return ftruncate(file, size); }

int rename(const char* from, const char* to) {
  changes();
  return fails(kRename) ? -1 : static_cast<int>(::syscall(SYS_rename, from, to));
}
int renameat(int a, const char* from, int b, const char* to) {
  changes();
  return fails(kRename) ? -1 : static_cast<int>(::syscall(SYS_renameat, a, from, b, to));
}
int link(const char* from, const char* to) {
  changes();
  return fails(kLink) ? -1 : static_cast<int>(::syscall(SYS_link, from, to));
}
int linkat(int a, const char* from, int b, const char* to, int flags) {
  changes();
  return fails(kLink) ? -1 : static_cast<int>(::syscall(SYS_linkat, a, from, b, to, flags));
}
int unlink(const char* path) {
  changes();
  return fails(kUnlink) ? -1 : static_cast<int>(::syscall(SYS_unlink, path));
}
int unlinkat(int folder, const char* path, int flags) {
  changes();
  return fails(kUnlink) ? -1 : static_cast<int>(::syscall(SYS_unlinkat, folder, path, flags));
}
int remove(const char* path) {
  const auto real = real_one(&::remove, "remove");
  changes();
  return fails(kUnlink) ? -1 : real(path);
}
int mkdir(const char* path, mode_t mode) {
  changes();
  return fails(kMkdir) ? -1 : static_cast<int>(::syscall(SYS_mkdir, path, mode));
}
int close(int file) {
  // A close that fails has closed, as Linux does it.
  const bool failed = fails(kClose);
  const int error = errno;
  const int result = static_cast<int>(::syscall(SYS_close, file));
  if (!failed) return result;
  errno = error;
  return -1;
}

#define STAT(NAME, PARAMETERS, ARGUMENTS)                              \
  int NAME PARAMETERS {                                                \
    using F = int PARAMETERS;                                          \
    const auto real = reinterpret_cast<F*>(::dlsym(RTLD_NEXT, #NAME)); \
    return fails(kStat) ? -1 : real ARGUMENTS;                         \
  }
STAT(stat, (const char* path, struct stat* out), (path, out))
STAT(stat64, (const char* path, struct stat64* out), (path, out))
STAT(lstat, (const char* path, struct stat* out), (path, out))
STAT(lstat64, (const char* path, struct stat64* out), (path, out))
STAT(fstat, (int file, struct stat* out), (file, out))
STAT(fstat64, (int file, struct stat64* out), (file, out))
STAT(fstatat, (int folder, const char* path, struct stat* out, int flags), (folder, path, out, flags))
STAT(fstatat64, (int folder, const char* path, struct stat64* out, int flags), (folder, path, out, flags))

void* mmap(void* address, size_t size, int protection, int flags, int file, off_t offset) {
  if (fails(kMmap)) return MAP_FAILED;
  return reinterpret_cast<void*>(::syscall(SYS_mmap, address, size, protection, flags, file, offset));
}
void* mmap64(void* address, size_t size, int protection, int flags, int file, off64_t offset) {
  return mmap(address, size, protection, flags, file, offset);
}

int pthread_create(pthread_t* thread, const pthread_attr_t* attributes, void* (*work)(void*), void* argument) {
  const auto real = real_one(&::pthread_create, "pthread_create");
  return fails(kThread) ? EAGAIN : real(thread, attributes, work, argument);
}

}  // extern "C"
