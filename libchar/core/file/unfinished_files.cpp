#include "libchar/core/file/unfinished_files.hpp"

#include <fcntl.h>
#include <sched.h>
#include <signal.h>
#include <unistd.h>

#include <atomic>
#include <set>

namespace libchar {
namespace {

std::atomic_flag list_taken = ATOMIC_FLAG_INIT;
int sets_getting_names = 0;
bool some_have_names = false;

std::set<std::string>* unfinished = nullptr;  // never destroyed: a signal may come while the program ends

/// The list for one thread, which no signal interrupts meanwhile: its handler would wait for the thread it runs on.
class TheList {
 public:
  TheList() {
    sigset_t all;
    ::sigfillset(&all);
    ::pthread_sigmask(SIG_BLOCK, &all, &before_);
    while (list_taken.test_and_set(std::memory_order_acquire)) ::sched_yield();
  }
  ~TheList() {
    list_taken.clear(std::memory_order_release);
    ::pthread_sigmask(SIG_SETMASK, &before_, nullptr);
  }
  TheList(const TheList&) = delete;
  TheList& operator=(const TheList&) = delete;

 private:
  sigset_t before_{};
};

}  // namespace

void remember_unfinished(const std::string& path) {
  std::set<std::string> one = {path};
  const TheList list;
  if (unfinished == nullptr) unfinished = new std::set<std::string>;
  unfinished->merge(one);
}

void forget_unfinished(const std::string& path) noexcept {
  const TheList list;
  if (unfinished != nullptr) unfinished->erase(path);
}

GivingNames::GivingNames() {
  const TheList list;
  ++sets_getting_names;
}

GivingNames::~GivingNames() {
  const TheList list;
  --sets_getting_names;
  some_have_names = true;
}

Discarded discard_unfinished() noexcept {
  while (list_taken.test_and_set(std::memory_order_acquire)) ::sched_yield();
  if (sets_getting_names > 0) {
    list_taken.clear(std::memory_order_release);
    return Discarded::not_now;
  }
  if (unfinished != nullptr)
    for (const std::string& path : *unfinished) ::unlink(path.c_str());
  return some_have_names ? Discarded::some_written : Discarded::nothing_written;
}

int open_nameless(const std::filesystem::path& folder) {
  const std::filesystem::path place = folder.empty() ? "." : folder;
  const int nameless = ::open(place.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, 0600);
  if (nameless >= 0) return nameless;
  std::string name = place / ".libchar-XXXXXX";  // a file system without nameless files
  const int named = ::mkostemp(name.data(), O_CLOEXEC);
  if (named >= 0) ::unlink(name.c_str());
  return named;
}

}  // namespace libchar
