// The door between the HDF5 library's process and this one: any bytes as its listing are none, or one that is the same
// when written again; and (one input in sixteen, a process is started for it) any bytes as a file.

#include "libchar/log/arrays/hdf5_worker.hpp"
#include "tests/fuzz/fuzz_support.hpp"
#include "tests/fuzz/topics_fuzz.hpp"
#include "tests/support/memory_log.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const std::string_view bytes(reinterpret_cast<const char*>(data) + 1, size - 1);
  if (data[0] % 16 == 0) {
    const test::MemoryLog log(bytes);
    test::read_any_topics("hdf5", log.path(), 7);
    return 0;
  }
  libchar::Hdf5Listing listing, again;
  if (!libchar::decode(bytes, listing)) return 0;
  const std::string written = libchar::encode(listing);
  fuzz::expect(libchar::decode(written, again), "a listing is not read back");
  fuzz::expect_same("a listing is read back as another", written, libchar::encode(again));
  return 0;
}
