// Partial states of a log with anything in them, under lengths and digests that fit: refused, or joined and
// characterized as far as the numbers allow. The first byte chooses what was characterized; behind it are, by the
// second byte, the whole content or changes of a true one, which may be longer than an input.

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "libchar/characterize/stretches.hpp"
#include "libchar/core/file/sha256.hpp"
#include "libchar/log/channel_names.hpp"
#include "libchar/lot/device_record.hpp"
#include "tests/fuzz/fleet_support.hpp"
#include "tests/fuzz/fuzz_support.hpp"

using namespace libchar;

namespace {

constexpr std::size_t kLengthAt = 12, kHead = 20, kDigest = 64;

struct State {
  std::string front, content;      ///< as far as identity and settings, and what is behind them
  std::vector<std::size_t> small;  ///< where small numbers stand: counts, mostly
};

struct Case {
  CharacterizeOptions options;
  std::vector<State> states;
};

/// A raw log with noise, some spikes and, where `holes`, missing samples.
std::string write_log(const fuzz::Folder& folder, std::size_t rows, std::size_t channels) {
  std::mt19937_64 random(rows);
  std::normal_distribution<double> gauss;
  std::vector<double> samples(rows * channels);
  for (double& x : samples) x = gauss(random);
  for (std::size_t i = 97; i < samples.size(); i += 1009) samples[i] = 40;
  for (std::size_t i = rows / 2; i < rows / 2 + rows / 50; ++i)
    samples[i * channels] = std::numeric_limits<double>::quiet_NaN();
  folder.write("log.f64.json", R"({"dtype": "f64", "endian": "little", "rate_hz": 100, "channels": )" +
                                   std::string(channels == 1 ? R"([{"name": "a"}]})"
                                                             : R"([{"name": "a"}, {"name": "b", "unit": "K"}]})"));
  return folder.write("log.f64", {reinterpret_cast<const char*>(samples.data()), samples.size() * sizeof(double)});
}

State cut(const std::string& bytes, const CharacterizeOptions& options) {
  const std::string settings = settings_digest(options);
  const std::size_t at = bytes.find(settings) + settings.size();
  State state{bytes.substr(0, at), bytes.substr(at, bytes.size() - kDigest - at), {}};
  for (std::size_t i = 0; i + 8 <= state.content.size(); ++i) {
    std::uint64_t number = 0;
    std::memcpy(&number, &state.content[i], sizeof number);
    if (number != 0 && number >> 32U == 0) state.small.push_back(i);
  }
  return state;
}

std::string whole(const State& state, const std::string& content) {
  std::string bytes = state.front + content;
  const std::uint64_t length = bytes.size() - kHead;
  std::memcpy(&bytes[kLengthAt], &length, sizeof length);
  Sha256 digest;
  digest.update(bytes);
  return bytes + digest.finish();
}

Case made(std::size_t rows, std::size_t channels, std::uint64_t segment, bool all = true) {
  const fuzz::Folder folder;
  const std::string path = write_log(folder, rows, channels);
  Case out;
  out.options.spectrum.segment = segment;
  out.options.wanted.spectrum = all;
  for (std::uint64_t leaf = 0; leaf < leaves_of(rows); ++leaf)
    characterize_stretch(path, out.options, {leaf, leaf + 1}, "log",
                         [&](const std::string& bytes) { out.states.push_back(cut(bytes, out.options)); });
  return out;
}

const std::vector<Case>& cases() {
  static const std::vector<Case> all = {made(16, 1, 8),      made(60, 1, 8, false),
                                        made(700, 2, 64),    made(6000, 1, 0),
                                        made(70000, 1, 256), made((std::size_t{1} << 20U) + 3000, 1, 1024)};
  return all;
}

std::uint64_t odd_number(std::uint8_t choice, std::uint64_t there) {
  const double reals[] = {std::nan(""), HUGE_VAL, -HUGE_VAL, 1e300, -1e300, 5e-324, -1, 0.5, 1e19, -0.0};
  const std::uint64_t ones[] = {0,
                                1,
                                2,
                                there + 1,
                                there - 1,
                                2 * there,
                                there / 2,
                                std::uint64_t{1} << 20U,
                                std::uint64_t{1} << 32U,
                                std::uint64_t{1} << 60U,
                                std::uint64_t{1} << 61U,
                                std::uint64_t{1} << 63U,
                                ~std::uint64_t{0}};
  const std::size_t k = choice % (std::size(reals) + std::size(ones));
  return k < std::size(ones) ? ones[k] : std::bit_cast<std::uint64_t>(reals[k - std::size(ones)]);
}

/// One change, of a few bytes of input.
void change(fuzz::Input& input, const State& state, std::string& content) {
  const std::uint8_t how = input.byte();
  const std::size_t place = input.take<std::uint32_t>();
  std::size_t at =
      how % 2 == 1 && !state.small.empty() ? state.small[place % state.small.size()] : place % (content.size() + 1);
  at = std::min(at, content.size());
  const std::size_t left = content.size() - at, eight = std::min<std::size_t>(left, 8);
  std::uint64_t number = 0;
  std::memcpy(&number, content.data() + at, eight);
  switch (how / 2 % 8) {
    default:
      number = odd_number(input.byte(), number);
      content.replace(at, eight, reinterpret_cast<const char*>(&number), eight);
      break;
    case 4:
      number = input.take<std::uint64_t>();
      content.replace(at, eight, reinterpret_cast<const char*>(&number), eight);
      break;
    case 5:
      content.erase(at, input.byte());
      break;
    case 6:
      content.insert(at, content.substr(at, input.byte()));
      break;
    case 7:
      if (left > 0) content[at] = static_cast<char>(input.byte());
  }
}

std::string content_of(fuzz::Input& input, const State& state) {
  if (input.byte() % 4 == 0) return std::string(input.rest());
  std::string content = state.content;
  while (!input.empty()) change(input, state, content);
  return content;
}

/// As a unit that joins stretches does.
void characterize_all(const std::vector<NamedState>& states, const CharacterizeOptions& options) {
  try {
    for (const NamedState& state : states) {
      const StretchHead head = stretch_head(state);
      fuzz::expect(head.range.first_leaf < head.range.end_leaf, "a state of no leaves");
    }
    const Characterization result = characterize_from_stretches(states, options);
    parse_device_record(device_record_text(record_of(result)), "r");
  } catch (const Error& error) {
    fuzz::said(error);
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  fuzz::Input input(data, size);
  const std::uint8_t choice = input.byte();
  // The small ones more often: they take microseconds, that of two leaves seconds.
  const std::size_t chosen[] = {0, 0, 0, 0, 1, 1, 1, 2, 2, 2, 0, 1, 3, 3, 4};
  const Case& one = cases()[choice >= 252 ? 5 : chosen[choice % std::size(chosen)]];
  const std::size_t changed = choice % one.states.size();
  std::vector<NamedState> states;
  for (std::size_t s = 0; s < one.states.size(); ++s)
    states.push_back(
        state_in_memory("state " + std::to_string(s),
                        whole(one.states[s], s == changed ? content_of(input, one.states[s]) : one.states[s].content)));
  characterize_all(states, one.options);
  return 0;
}
