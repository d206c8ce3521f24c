// Standard error belongs to the program: whatever is fitted, the libraries below write nothing.
#include <fcntl.h>
#include <unistd.h>

#include <catch2/catch.hpp>
#include <cmath>
#include <cstdio>
#include <functional>

#include "libchar/core/error.hpp"
#include "libchar/fit/noise_fit.hpp"
#include "tests/support/noise.hpp"
#include "tests/support/shared.hpp"

using namespace libchar;

namespace {

/// What is written to standard error while `work` runs.
std::string written_to_stderr(const std::function<void()>& work) {
  const test::TemporaryFolder folder;
  const std::string path = (folder / "err").string();
  std::fflush(stderr);
  const int before = ::dup(2);
  const int file = ::open(path.c_str(), O_RDWR | O_CREAT | O_TRUNC, 0600);
  REQUIRE(file >= 0);
  ::dup2(file, 2);
  try {
    work();
  } catch (const Error&) {
    // a record that cannot be fitted says so to the caller
  }
  std::fflush(stderr);
  ::dup2(before, 2);
  ::close(before);
  std::string text(4096, '\0');
  const ssize_t n = ::pread(file, text.data(), text.size(), 0);
  ::close(file);
  text.resize(n > 0 ? static_cast<std::size_t>(n) : 0);
  return text;
}

using Signal = std::function<double(double t)>;

}  // namespace

TEST_CASE("plain signals are fitted without a word on standard error") {
  const std::vector<std::pair<const char*, Signal>> signals = {
      {"index", [](double t) { return t; }},
      {"stamps in ns", [](double t) { return 1.7e18 + 5e6 * t; }},
      {"modulo counter", [](double t) { return std::fmod(t, 256); }},
      {"sine", [](double t) { return std::sin(0.01 * t); }},
      {"fast sine", [](double t) { return std::sin(2.5 * t); }},
      {"whole periods", [](double t) { return std::sin(2 * M_PI * t / 50); }},
      {"step", [](double t) { return t < 4000 ? 0.0 : 1.0; }},
      {"square wave", [](double t) { return std::fmod(t, 100) < 50 ? -1.0 : 1.0; }},
      {"alternating", [](double t) { return std::fmod(t, 2) < 1 ? -1.0 : 1.0; }},
      {"impulses", [](double t) { return std::fmod(t, 1000) == 0 ? 1.0 : 0.0; }},
      {"one impulse", [](double t) { return t == 3000 ? 1e9 : 0.0; }},
      {"constant", [](double) { return 9.81; }},
      {"parabola", [](double t) { return t * t; }},
      {"exponential", [](double t) { return std::exp(-t / 300); }},
      {"growing", [](double t) { return std::exp(t / 20); }},
      {"tiny", [](double t) { return 1e-300 * std::sin(t * t); }},
      {"huge", [](double t) { return 1e150 * std::sin(t * t); }}};
  for (const auto& [name, signal] : signals) {
    std::vector<double> y(10000);
    for (std::size_t t = 0; t < y.size(); ++t) y[t] = signal(static_cast<double>(t));
    INFO(name);
    CHECK(written_to_stderr([&] { fit_record(y, 100, nullptr); }).empty());
  }
}
