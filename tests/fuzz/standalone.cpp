// A plain driver for the targets where there is no libFuzzer (GCC): inputs of the given folders,
// broken at random, for so many seconds. No feedback, so it finds less; but any compiler's code can
// be tried. Options as libFuzzer has them; others are ignored.
//   TARGET_fuzz [-max_total_time=60] [-max_len=4096] [-seed=1] [-artifact_prefix=PREFIX] FOLDER|FILE…

#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <random>
#include <string>
#include <vector>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace {

using Bytes = std::vector<std::uint8_t>;

Bytes current;
std::string artifact = "./";

// The input that was being tried, whatever ended it.
void keep_input(int number) {
  const std::string path = artifact + "crash-" + std::to_string(::getpid());
  std::ofstream(path, std::ios::binary)
      .write(reinterpret_cast<const char*>(current.data()), static_cast<std::streamsize>(current.size()));
  std::fprintf(stderr, "signal %d, the input is in %s\n", number, path.c_str());
  std::signal(number, SIG_DFL);
  std::raise(number);
}

struct Options {
  double seconds = 60;
  std::size_t most = 4096;
  std::uint64_t seed = 1;
  std::vector<Bytes> seeds;
};

void add_seed(const std::filesystem::path& path, Options& options) {
  std::ifstream in(path, std::ios::binary);
  Bytes bytes((std::istreambuf_iterator<char>(in)), {});
  if (bytes.size() > options.most) bytes.resize(options.most);
  options.seeds.push_back(std::move(bytes));
}

Options options_of(int count, char** words) {
  Options options;
  for (int i = 1; i < count; ++i) {
    const std::string word = words[i];
    const std::string value = word.substr(word.find('=') + 1);
    if (word.rfind("-max_total_time=", 0) == 0) options.seconds = std::stod(value);
    if (word.rfind("-max_len=", 0) == 0) options.most = std::stoul(value);
    if (word.rfind("-seed=", 0) == 0) options.seed = std::stoul(value);
    if (word.rfind("-artifact_prefix=", 0) == 0) artifact = value;
    if (word[0] == '-') continue;
    if (!std::filesystem::is_directory(word)) {
      add_seed(word, options);
      options.seconds = 0;  // files are tried as they are
    } else {
      for (const auto& entry : std::filesystem::directory_iterator(word)) add_seed(entry.path(), options);
    }
  }
  if (options.seeds.empty()) options.seeds.push_back({0});
  return options;
}

Bytes broken(const Options& options, std::mt19937_64& random) {
  static const std::vector<std::string> kWords = {"nan",
                                                  "inf",
                                                  "1e400",
                                                  "1e-400",
                                                  ",",
                                                  ";",
                                                  "\t",
                                                  "\r\n",
                                                  "\n",
                                                  "\"",
                                                  "#",
                                                  "-",
                                                  "0",
                                                  "9",
                                                  ".",
                                                  "9223372036854775807",
                                                  "-9223372036854775808",
                                                  "9007199254740993",
                                                  "e-308",
                                                  ": ",
                                                  std::string(1, '\0'),
                                                  "\xff",
                                                  "\x80",
                                                  "&a",
                                                  "null",
                                                  "1e-15",
                                                  "[",
                                                  "]",
                                                  "{",
                                                  "}"};
  const auto any = [&](std::size_t n) { return static_cast<std::size_t>(random() % n); };
  Bytes bytes = options.seeds[any(options.seeds.size())];
  for (std::size_t changes = any(6); changes > 0; --changes) {
    const std::size_t at = any(bytes.size() + 1);
    const auto place = bytes.begin() + static_cast<std::ptrdiff_t>(at);
    const std::size_t length = std::min(bytes.size() - at, 1 + any(16));
    const auto stop = place + static_cast<std::ptrdiff_t>(length);
    const std::string& word = kWords[any(kWords.size())];
    const Bytes piece(place, stop);
    const Bytes& other = options.seeds[any(options.seeds.size())];
    switch (any(7)) {
      case 0:
        if (at < bytes.size()) bytes[at] ^= static_cast<std::uint8_t>(1U << any(8));
        break;
      case 1:
        if (at < bytes.size()) bytes[at] = static_cast<std::uint8_t>(random());
        break;
      case 2:
        bytes.erase(place, stop);
        break;
      case 3:
        bytes.insert(place, word.begin(), word.end());
        break;
      case 4:
        bytes.insert(place, piece.begin(), piece.end());
        break;
      case 5:
        bytes.resize(at);
        break;
      default:
        bytes.resize(at);
        bytes.insert(bytes.end(), other.begin() + static_cast<std::ptrdiff_t>(any(other.size() + 1)), other.end());
    }
    if (bytes.size() > options.most) bytes.resize(options.most);
  }
  return bytes;
}

}  // namespace

int main(int count, char** words) {
  const Options options = options_of(count, words);
  for (const int number : {SIGABRT, SIGSEGV, SIGFPE, SIGILL, SIGBUS, SIGALRM}) std::signal(number, keep_input);
  std::mt19937_64 random(options.seed);
  const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(options.seconds);
  std::uint64_t runs = 0;
  for (const Bytes& seed : options.seeds) {
    ::alarm(20);  // a hang
    current = seed;
    LLVMFuzzerTestOneInput(current.data(), current.size());
    ++runs;
  }
  while (std::chrono::steady_clock::now() < end) {
    ::alarm(20);
    current = broken(options, random);
    LLVMFuzzerTestOneInput(current.data(), current.size());
    ++runs;
  }
  std::printf("stat::number_of_executed_units: %llu\n", static_cast<unsigned long long>(runs));
}
