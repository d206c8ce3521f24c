// Logs of which the truth is known: causes by which stamps are no even row of instants, in every unit, with jitter and
// with gaps. Each is read with the right rate and no gap that is none, or is refused with options that read it.

#include <fmt/format.h>

#include <catch2/catch.hpp>
#include <cmath>
#include <functional>
#include <random>
#include <regex>

#include "tests/log/log_text.hpp"

using namespace libchar;
using test::count;
using test::read_text;

namespace {

struct StatedClock {
  std::string name;
  double unit_ns;
};
const std::vector<StatedClock> kClocks = {{"t[s]", 1e9}, {"t[ms]", 1e6}, {"t[us]", 1e3}, {"t[ns]", 1}};

/// What a log says of its time, and what is true of it.
struct TimedRows {
  std::vector<double> instants;  // s, as written
  double rate_hz = 0;
  double missing = 0;   // samples
  double unsure = 0.5;  // of these
};

struct Rules {
  double rate_hz = 100, jitter = 0;  // of an interval
  int gap = 0;                       // samples that are missing in the middle
  std::size_t rows = 4000;
};

std::string text_of(const TimedRows& rows, const StatedClock& clock) {
  std::string text = clock.name + ",x\n";
  for (std::size_t i = 0; i < rows.instants.size(); ++i) {
    const double value = rows.instants[i] * 1e9 / clock.unit_ns;
    text += clock.unit_ns > 1e8   ? fmt::format("{:.6f},{}\n", value, (i * 7919) % 1000)
            : clock.unit_ns > 1e5 ? fmt::format("{:.3f},{}\n", value, (i * 7919) % 1000)
                                  : fmt::format("{:.0f},{}\n", value, (i * 7919) % 1000);
  }
  return text;
}

/// Instants of an even clock, with what the rules add.
TimedRows even_rows(const Rules& rules) {
  std::mt19937_64 random(7);
  std::normal_distribution<double> noise(0, 1);
  TimedRows out{{}, rules.rate_hz, static_cast<double>(rules.gap)};
  if (rules.gap > 100) out.unsure = 0.002 * rules.gap;
  for (std::size_t i = 0; i < rules.rows; ++i) {
    const double lost = 2 * i >= rules.rows ? rules.gap : 0;
    out.instants.push_back(1000 + (static_cast<double>(i) + lost + rules.jitter * noise(random)) / rules.rate_hz);
  }
  return out;
}

/// Each row arrives with the last one of its packet, `inner` of an interval after the one in front.
TimedRows in_packets(const Rules& rules, std::size_t size, double inner) {
  TimedRows out = even_rows(rules);
  std::vector<double> arrived = out.instants;
  for (std::size_t i = 0; i < arrived.size(); ++i) {
    const std::size_t last = std::min(arrived.size() - 1, i - i % size + size - 1);
    const double back = static_cast<double>(last - i) * inner / rules.rate_hz;
    arrived[i] = out.instants[last] - back;
  }
  out.instants = arrived;
  out.unsure += out.missing > 0 ? 2 : 0;
  return out;
}

/// Steps of unlike length in turns, in intervals that are one in the mean.
TimedRows in_turns(const Rules& rules, const std::vector<double>& steps) {
  TimedRows out = even_rows(rules);
  double off = 0;
  for (std::size_t i = 0; i < out.instants.size(); ++i) {
    out.instants[i] += off / rules.rate_hz;
    off += steps[i % steps.size()] - 1;
  }
  return out;
}

TimedRows lossy(const Rules& rules, double share) {
  std::mt19937_64 random(11);
  std::bernoulli_distribution lost(share);
  TimedRows all = even_rows(rules), out = all;
  out.instants.clear();
  std::size_t last = 0;
  for (std::size_t i = 0; i < all.instants.size(); ++i)
    if (i == 0 || !lost(random)) {
      out.instants.push_back(all.instants[i]);
      last = i;
    }
  out.missing += static_cast<double>(last + 1 - out.instants.size());
  out.unsure = 0.5 + 0.02 * out.missing;
  return out;
}

TimedRows with_duty(const Rules& rules, std::size_t on, double off_s) {
  TimedRows out = even_rows(rules);
  for (std::size_t i = 0; i < out.instants.size(); ++i) out.instants[i] += static_cast<double>(i / on) * off_s;
  out.missing += static_cast<double>((out.instants.size() - 1) / on) * off_s * rules.rate_hz;
  out.unsure = 0.5 + 0.002 * out.missing + static_cast<double>(out.instants.size() / on);
  return out;
}

/// A host that hangs 1.5 s in every 7, and then writes at once what it missed.
TimedRows hung(const Rules& rules) {
  TimedRows out = even_rows(rules);
  const double first = out.instants.front();
  std::size_t rows = 0;
  double before = 0;
  for (double& t : out.instants) {
    const double phase = std::fmod(t - first + 4, 7);
    rows = phase < 1.5 ? rows + 1 : 0;
    if (rows > 0) t += 1.5 - phase + 2e-4 * static_cast<double>(rows);
    before = t = std::max(t, before + 1e-5);
  }
  out.unsure += out.missing > 0 ? 2 : 0;
  return out;
}

struct Cause {
  std::string name;
  std::function<TimedRows(const Rules&)> make;
  const char* warning;
};

const std::vector<Cause> kCauses = {
    {"even", even_rows, ""},
    {"loss of 4 %", [](const Rules& r) { return lossy(r, 0.04); }, "gap"},
    {"loss of 30 %", [](const Rules& r) { return lossy(r, 0.3); }, "gap"},
    {"pause of 3000 s in turns",
     [](const Rules& r) {
       TimedRows out = in_turns(r, {0.9182, 0.9182, 0.9182, 1.1454, 1.1});
       for (std::size_t i = 1000; i < out.instants.size(); ++i) out.instants[i] += 3000;
       out.missing += 3000 * r.rate_hz;
       out.unsure = 0.002 * out.missing;
       return out;
     },
     "gap"},
    {"duty cycle", [](const Rules& r) { return with_duty(r, 400, 20); }, "gap"},
    {"packets of 11", [](const Rules& r) { return in_packets(r, 11, 0.7345); }, "packets"},
    {"packets of 5", [](const Rules& r) { return in_packets(r, 5, 0.02); }, "packets"},
    {"a host that hangs", hung, "late_stamp"},
    {"packets of equal stamps", [](const Rules& r) { return in_packets(r, 4, 0); }, "coarse_stamps"},
    {"a clock of one interval",
     [](const Rules& r) {
       TimedRows out = even_rows(r);
       std::mt19937_64 random(5);
       std::normal_distribution<double> late(0, 0.4);
       double last = 0;
       for (double& t : out.instants) t = last = std::max(last, std::round(t * r.rate_hz + late(random)) / r.rate_hz);
       return out;
     },
     "coarse_stamps"},
    {"messages in turns",
     [](const Rules& r) {
       return in_turns(r, {0.56, 1.44});
     },
     ""},
    {"wild first rows",
     [](const Rules& r) {
       TimedRows out = even_rows(r);
       for (std::size_t i = 0; i < 3; ++i) out.instants[i] += 80000;
       return out;
     },
     "wild_stamp"},
    {"a wild row",
     [](const Rules& r) {
       TimedRows out = even_rows(r);
       out.instants[2500] = 4294967.295;
       out.missing += 1;
       return out;
     },
     "wild_stamp"},
    {"a wild last row",
     [](const Rules& r) {
       TimedRows out = even_rows(r);
       out.instants.back() = 4294967.295;
       return out;
     },
     "wild_stamp"},
    {"24 bits of ms",
     [](const Rules& r) {
       TimedRows out = even_rows(r);
       for (double& t : out.instants) t = std::fmod(t + 16777.216 - 1010, 16777.216);
       return out;
     },
     "clock_rollover"},
    {"32 bits of us",
     [](const Rules& r) {
       TimedRows out = even_rows(r);
       for (double& t : out.instants) t = std::fmod(t + 4294.967296 - 1010, 4294.967296);
       return out;
     },
     "clock_rollover"},
    {"32 bits of us, signed",
     [](const Rules& r) {
       TimedRows out = even_rows(r);
       for (double& t : out.instants)
         if ((t += 2147.483648 - 1010) >= 2147.483648) t -= 4294.967296;
       return out;
     },
     "clock_rollover"},
    {"seconds of the day",
     [](const Rules& r) {
       TimedRows out = even_rows(r);
       for (double& t : out.instants) t = std::fmod(t + 86400 - 1010, 86400);
       return out;
     },
     "clock_rollover"},
    {"seconds of the week",
     [](const Rules& r) {
       TimedRows out = even_rows(r);
       for (double& t : out.instants) t = std::fmod(t + 604800 - 1010, 604800);
       return out;
     },
     "clock_rollover"},
};

}  // namespace

TEST_CASE("stamps of every cause, unit, jitter and gap: the right rate and no gap that is none") {
  std::size_t inputs = 0;
  for (const Cause& cause : kCauses)
    for (const StatedClock& clock : kClocks)
      for (const double jitter : {0.0, 0.02, 0.1})
        for (const int gap : {0, 7, 5000}) {
          Rules rules;
          rules.jitter = cause.name == "packets of equal stamps" ? 0 : jitter;
          rules.gap = gap;
          const TimedRows truth = cause.make(rules);
          INFO(cause.name << ", " << clock.name << ", jitter " << jitter << ", gap of " << gap);
          ++inputs;
          Recording r;
          try {
            r = read_text(text_of(truth, clock));
          } catch (const Error& error) {
            FAIL_CHECK(error.what());
            continue;
          }
          std::string said;
          for (const Finding& warning : r.info.warnings.list())
            said += fmt::format("{} x {}; ", warning.count, warning.code);
          INFO(said);
          CHECK(r.info.time.rate_hz == Approx(truth.rate_hz).epsilon(1e-3));
          CHECK(static_cast<double>(r.info.time.missing_samples) == Approx(truth.missing).margin(truth.unsure));
          if (*cause.warning != '\0') CHECK(count(r, cause.warning) > 0);
        }
  CHECK(inputs >= 150);
}

TEST_CASE("a pause over the end of a log, whose rows came at once, holds no missing ones") {
  for (const double pause : {0.3, 1.0, 4.0})
    for (const double rows_written : {0.8, 1.0}) {
      TimedRows rows = even_rows({});
      const double from = rows.instants.back() - rows_written * pause + 0.005;
      std::size_t late = 0;
      for (double& t : rows.instants)
        if (t >= from) t = from + pause + 2e-4 * static_cast<double>(late++);
      INFO(pause << " s, of which rows were written for " << rows_written);
      const Recording r = read_text(text_of(rows, kClocks[2]));
      CHECK(r.info.time.missing_samples == 0);
      CHECK(r.info.time.rate_hz == Approx(100).epsilon(1e-3));
    }
}

TEST_CASE("packets of more rows than tell a usual step from a pause, of which some are lost") {
  for (const std::size_t size : {45, 60, 100})
    for (const double jitter : {0.0, 0.1})
      for (const bool lost : {false, true}) {
        Rules rules;
        rules.jitter = jitter;
        rules.rows = 24000;
        TimedRows rows = in_packets(rules, size, 0.01);
        const std::size_t first = 70 * size;
        if (lost)
          rows.instants.erase(rows.instants.begin() + static_cast<std::ptrdiff_t>(first),
                              rows.instants.begin() + static_cast<std::ptrdiff_t>(first + 2 * size));
        INFO(size << " rows, jitter " << jitter << ", lost " << lost);
        const Recording r = read_text(text_of(rows, kClocks[2]));
        CHECK(r.info.time.rate_hz == Approx(100).epsilon(1e-3));
        CHECK(r.info.time.missing_samples == (lost ? 2 * size : 0));
        CHECK(count(r, "packets") == 1);
        ReadOptions inside;
        inside.rate_hz = 10000;
        CHECK(read_text(text_of(rows, kClocks[2]), inside).info.time.rate_hz == Approx(10000).epsilon(1e-3));
      }
}

namespace {

/// Rows of [from, to) come at once at its end.
TimedRows hung(TimedRows rows, double from, double to) {
  std::size_t late = 0;
  for (double& t : rows.instants)
    if (t >= from && t < to) t = to + 2e-4 * static_cast<double>(late++);
  for (std::size_t i = 1; i < rows.instants.size(); ++i)
    rows.instants[i] = std::max(rows.instants[i], rows.instants[i - 1] + 1e-6);
  return rows;
}

}  // namespace

TEST_CASE("rows that come at once when a log begins are left out") {
  for (const double rate_hz : {50.0, 200.0})
    for (const double held_s : {0.5, 1.0, 4.0}) {
      Rules rules;
      rules.rate_hz = rate_hz;
      const TimedRows rows = hung(even_rows(rules), 0, 1000 + held_s);
      INFO(rate_hz << " Hz, " << held_s << " s");
      const Recording r = read_text(text_of(rows, kClocks[2]));
      CHECK(r.info.time.rate_hz == Approx(rate_hz).epsilon(1e-3));
      CHECK(r.info.time.missing_samples <= 1);
      CHECK(count(r, "rate_change") == 1);
    }
  // Of more than the first rows that are looked at nobody knows the rate: both stretches are offered.
  Rules rules;
  rules.rows = 8000;
  try {
    read_text(text_of(hung(even_rows(rules), 0, 1020), kClocks[2]));
    FAIL_CHECK("was read");
  } catch (const Error& error) {
    CHECK_THAT(error.what(), Catch::Contains("E0334") && Catch::Contains("`from_s`"));
  }
}

TEST_CASE("a logger hangs for thousands of rows, which come at once behind the pause") {
  for (const double jitter : {0.0, 0.1})
    for (const double held_s : {8.0, 15.0, 30.0}) {
      Rules rules;
      rules.rows = 12000;
      rules.jitter = jitter;
      INFO(held_s << " s, jitter " << jitter);
      const Recording r = read_text(text_of(hung(even_rows(rules), 1050, 1050 + held_s), kClocks[2]));
      CHECK(r.info.time.rate_hz == Approx(100).epsilon(1e-3));
      CHECK(r.info.time.missing_samples == 0);
      CHECK(count(r, "late_stamp") == 1);
    }
}

TEST_CASE("packets that are late by a good part of one keep the rate of the rows, and none of them is lost") {
  for (const double late : {0.1, 0.27, 0.4})  // of a packet, in the mean
    for (const unsigned seed : {3U, 5U, 8U, 13U}) {
      std::mt19937_64 random(seed);
      std::exponential_distribution<double> delay(1 / late);
      constexpr std::size_t kPacket = 20;
      TimedRows rows = even_rows({});
      double of_packet = 0, arrived = 0;
      for (std::size_t i = 0; i < rows.instants.size(); ++i) {
        if (i % kPacket == 0) of_packet = delay(random);
        const double end = 1000 + (static_cast<double>(i / kPacket + 1) + of_packet) * kPacket / rows.rate_hz;
        arrived = std::max(arrived, end + 1e-4 * static_cast<double>(i % kPacket));
        rows.instants[i] = arrived;
      }
      INFO(late << ", seed " << seed);
      const Recording r = read_text(text_of(rows, kClocks[2]));
      CHECK(r.info.time.rate_hz == Approx(100).epsilon(1e-3));
      CHECK(r.info.time.missing_samples == 0);
    }
}

TEST_CASE("a host's time on each packet, whose rows stand an interval apart: early packets are no step back") {
  for (const std::size_t packet : {8U, 50U, 190U})
    for (const double late : {0.2, 3.0})  // rows, in the mean
      for (const unsigned seed : {3U, 5U, 8U}) {
        if (late > static_cast<double>(packet) / 8) continue;
        std::mt19937_64 random(seed);
        std::gamma_distribution<double> delay(2, late / 2);
        for (const bool lost : {false, true}) {
          TimedRows rows = even_rows({});
          std::size_t missing = 0;
          double of_packet = 0;
          for (std::size_t i = 0; i < rows.instants.size(); ++i) {
            if (i % packet == 0) {
              of_packet = delay(random) / rows.rate_hz;
              if (lost && i / packet % 7 == 3) missing += 4 * packet;
            }
            rows.instants[i] = 1000 + static_cast<double>(i + missing) / rows.rate_hz + of_packet;
          }
          INFO(packet << " rows, late by " << late << (lost ? ", some lost" : "") << ", seed " << seed);
          const Recording r = read_text(text_of(rows, kClocks[2]));
          CHECK(r.info.time.rate_hz == Approx(100).epsilon(1e-3));
          CHECK(static_cast<double>(r.info.time.missing_samples) == Approx(missing).epsilon(0.01));
          CHECK(r.info.rows_dropped == 0);
        }
      }
}

// 100 Hz over a link that sends what is ready at each of its events, of which some fail (the rows wait for the next)
// and some are lost with their rows.
TimedRows sent(unsigned seed, double rows_an_event, double fails, double loses) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> chance(0, 1);
  TimedRows out{{}, 100, 0};
  std::size_t row = 0;
  for (double event = 1; out.instants.size() < 6000; event += 1) {
    const auto ready = static_cast<std::size_t>(std::ceil(event * rows_an_event));
    if (chance(random) < fails) continue;
    const bool lost = chance(random) < loses && out.instants.size() > 20;
    const double at = event * rows_an_event / 100 + 1e-4 * chance(random);
    for (std::size_t k = 0; row < ready; ++row, ++k)
      if (lost)
        ++out.missing;
      else
        out.instants.push_back(1000 + at + 1e-4 * static_cast<double>(k));
  }
  return out;
}

TEST_CASE("rows of a link come late together, and packets of any size that it loses are missing") {
  for (const double rows_an_event : {4.3, 7.5, 11.8})
    for (const double loses : {0.0, 0.02})
      for (const unsigned seed : {3U, 5U, 8U}) {
        const TimedRows rows = sent(seed, rows_an_event, loses > 0 ? 0 : 0.05, loses);
        INFO(rows_an_event << " rows an event, " << rows.missing << " lost, seed " << seed);
        const Recording r = read_text(text_of(rows, kClocks[2]));
        CHECK(r.info.time.rate_hz == Approx(100).epsilon(2e-3));
        CHECK(static_cast<double>(r.info.time.missing_samples) == Approx(rows.missing).epsilon(0.1).margin(0.5));
      }
}

TEST_CASE("packets of many rows that are written less than ten times as fast as they come") {
  for (const double inside : {0.15, 0.3, 0.5})
    for (const std::size_t packet : {45U, 60U}) {
      std::mt19937_64 random(3);
      std::normal_distribution<double> noise(0, 0.02);
      TimedRows rows = even_rows({});
      for (std::size_t i = 0; i < rows.instants.size(); ++i)
        rows.instants[i] = 1000 + (static_cast<double>((i / packet + 1) * packet) +
                                   inside * static_cast<double>(i % packet) + noise(random)) /
                                      rows.rate_hz;
      INFO(packet << " rows, a step inside of " << inside);
      CHECK(read_text(text_of(rows, kClocks[2])).info.time.rate_hz == Approx(100).epsilon(1e-3));
    }
}

TEST_CASE("a sensor that pauses again and again, its rows even: two rates, or gaps where the pauses are unlike") {
  TimedRows rows = even_rows({});
  for (std::size_t i = 0; i < rows.instants.size(); ++i)
    rows.instants[i] = 1000 + (static_cast<double>(i) + 60 * static_cast<double>(i / 25)) / rows.rate_hz;
  CHECK_THROWS_WITH(read_text(text_of(rows, kClocks[2])), Catch::Contains("E0324"));
  ReadOptions told;
  told.rate_hz = 100;
  CHECK(read_text(text_of(rows, kClocks[2]), told).info.time.rate_hz == Approx(100).epsilon(1e-4));
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> pause(10, 120);
  double paused = 0;
  for (std::size_t i = 0; i < rows.instants.size(); ++i) {
    if (i % 25 == 0) paused += pause(random);
    rows.instants[i] = 1000 + (static_cast<double>(i) + paused) / rows.rate_hz;
  }
  CHECK(read_text(text_of(rows, kClocks[2])).info.time.rate_hz == Approx(100).epsilon(1e-3));
}

TEST_CASE("a rate that is told and kept by all rows leaves no room for gaps where rows come late together") {
  int without_gap = 0;
  constexpr unsigned kSeeds = 5;
  for (unsigned seed = 1; seed <= kSeeds; ++seed) {
    std::mt19937 random(seed);
    std::normal_distribution<double> noise(0, 0.6);
    double wander = 0;
    std::string text = "ms,x\n";
    long long last = 0;
    for (int k = 0, rows = 0; k < 3000;) {  // 250 Hz over radio: one to three rows at once, of which some are held back
      rows = static_cast<int>(random() % 3) + 1;
      k += rows;
      wander += noise(random) - 0.02 * wander;
      last = std::max(last, std::llround(4 * k + 8 + wander + (700 < k && k < 740 ? 20 : 0)));
      for (int i = 0; i < rows; ++i) text += fmt::format("{},{}\n", 1557936053329 + last, random() % 1000);
    }
    INFO(seed);
    ReadOptions told;
    told.rate_hz = 250;
    const Recording log = read_text(text, told);
    without_gap += log.info.time.missing_samples == 0 ? 1 : 0;
    CHECK(log.info.time.rate_hz == Approx(250).epsilon(2e-3));
    const std::string& paused = text;  // a pause of a second is a gap
    const std::size_t half = paused.find('\n', paused.size() / 2) + 1;
    std::string later;
    for (std::size_t at = half; at < paused.size();) {
      const std::size_t end = paused.find('\n', at), comma = paused.find(',', at);
      later +=
          fmt::format("{}{}\n", std::stoll(paused.substr(at, comma - at)) + 1000, paused.substr(comma, end - comma));
      at = end + 1;
    }
    CHECK(read_text(paused.substr(0, half) + later, told).info.time.missing_samples == Approx(250).margin(12));
  }
  CHECK(without_gap >= 4);  // packets that are held back may still look like a gap
}

TEST_CASE("two messages by turns whose steps are whole multiples of the shorter: no row is missing") {
  for (const double share : {1 / 3.0, 0.25, 0.4}) {
    std::string text = "t[s],x\n";
    for (int i = 0; i < 1500; ++i)
      text += fmt::format("{:.6f},{}\n", (i / 2 * 2 + (i % 2) * 2 * share + 0.004 * ((i * 7919) % 5)) / 20, i % 17);
    INFO(share);
    const Recording r = read_text(text);
    CHECK(r.info.time.rate_hz == Approx(20).epsilon(1e-3));
    CHECK(r.info.time.missing_samples == 0);
  }
}

TEST_CASE("most rows at half the first rate: the rate has changed") {
  std::string text = "t[s],x\n";
  for (int i = 0; i < 3000; ++i) text += fmt::format("{:.4f},{}\n", (i < 1100 ? i : 2 * i - 1100) / 100.0, i % 17);
  CHECK(test::failure(text).find("E0334") != std::string::npos);
  ReadOptions later;
  later.from_s = 11;
  CHECK(read_text(text, later).info.time.rate_hz == Approx(50));
}

TEST_CASE("parts of a second without leading zeros, behind clock times and dates") {
  for (const std::string form : {"{}:{}:{}.{}", "{:02}:{:02}:{:02}:{}", "2024-5-7 {}:{}:{}.{}"}) {
    std::string text = "time,x\n";
    for (int i = 0; i < 2000; ++i) {
      const int ms = 50000321 + 37 * i;
      text += fmt::format(fmt::runtime(form), ms / 3600000, ms / 60000 % 60, ms / 1000 % 60, ms % 1000) + ",1\n";
    }
    INFO(form);
    const Recording r = read_text(text);
    CHECK(r.info.time.rate_hz == Approx(1000 / 37.0).epsilon(1e-3));
    CHECK(r.info.time.missing_samples == 0);
  }
}

TEST_CASE("clocks of a day and a week, totals beside the time of a step, minutes in days, units at the end of a word") {
  const auto rate_of = [](const std::string& names, const auto& row) {
    std::string text = names + ",x\n";
    for (int i = 0; i < 700; ++i) text += row(i) + fmt::format(",{}\n", (i * 7919) % 100);
    return read_text(text).info.time.rate_hz;
  };
  CHECK(rate_of("sec_of_day", [](int i) { return fmt::format("{:.2f}", std::fmod(86396 + 0.02 * i, 86400)); }) ==
        Approx(50));
  CHECK(rate_of("SOW", [](int i) { return fmt::format("{:.2f}", std::fmod(604796 + 0.02 * i, 604800)); }) ==
        Approx(50));
  CHECK(rate_of("Time,Total Time", [](int i) {
          return fmt::format("{}:{:02},0:{:02}:{:02}", i % 400 / 60, i % 60, i / 60, i % 60);
        }) == Approx(1));
  CHECK(rate_of("time", [](int i) { return fmt::format("{:.6f}", 45000.25 + i / 1440.0); }) ==
        Approx(1 / 60.0).epsilon(1e-3));
  CHECK(rate_of("Test_Time,DateTime", [](int i) {
          return fmt::format("{:.4f},{:.4f}", 10.0024 * (i + 1), 1494645233.4691 + 10.0024 * (i + 1));
        }) == Approx(1 / 10.0024));
  CHECK(rate_of("time(UTC)", [](int i) { return fmt::format("201801{:02}:{:02}00", 1 + i / 24, i % 24); }) ==
        Approx(1 / 3600.0));
  CHECK(rate_of("Observation period", [](int i) {
          return fmt::format("2020-06-01T{0:02}:{1:02}:00.0/2020-06-01T{0:02}:{1:02}:30.0", i / 60, i % 60);
        }) == Approx(1 / 60.0));
  CHECK(rate_of("epochMs", [](int i) { return fmt::format("{:.3f}", 12.5 + 10.0 * i); }) == Approx(100));
}

TEST_CASE("bursts each few seconds or more seldom are a slow link or a sensor that pauses: both rates are offered") {
  for (const double period : {3.0, 10.0, 30.0})
    for (const std::size_t size : {120U, 600U}) {
      TimedRows rows;
      for (std::size_t i = 0; i < 12 * size; ++i)
        rows.instants.push_back(1000 + period * static_cast<double>(i / size + 1) +
                                0.02 * period * static_cast<double>(i % size) / static_cast<double>(size));
      INFO(period << " s, " << size);
      const std::string text = text_of(rows, kClocks[2]);
      try {
        const Recording r = read_text(text);
        CHECK(r.info.time.rate_hz == Approx(static_cast<double>(size) / period).epsilon(3e-3));
      } catch (const Error& error) {
        CHECK_THAT(error.what(), Catch::Contains("E0324") && Catch::Contains("`time_column` none"));
      }
    }
}

TEST_CASE("a sensor that is awake for seconds is no burst") {
  for (const double rate_hz : {5.0, 50.0}) {
    TimedRows rows;
    const auto awake = static_cast<std::size_t>(5 * rate_hz);
    for (std::size_t i = 0; i < 12 * awake; ++i)
      rows.instants.push_back(1000 + 600 * static_cast<double>(i / awake) + static_cast<double>(i % awake) / rate_hz);
    CHECK(read_text(text_of(rows, kClocks[1])).info.time.rate_hz == Approx(rate_hz).epsilon(1e-3));
  }
}

TEST_CASE("packets of one stamp are packets also where the first that is missing comes late") {
  for (const std::size_t size : {4U, 8U, 10U}) {
    TimedRows rows;
    for (std::size_t i = 0; i < 4000; ++i)
      if (i / size != 290 && i / size != 333 && i / size != 351)
        rows.instants.push_back(1000 + static_cast<double>(i / size * size) / 80);
    INFO(size);
    const Recording r = read_text(text_of(rows, kClocks[2]));
    CHECK(r.info.time.rate_hz == Approx(80).epsilon(5e-4));
    CHECK(r.info.time.missing_samples == 3 * size);
  }
}

TEST_CASE("three rates one after another are no grid, also where one of them is a part of another") {
  for (const std::vector<double>& rates :
       {std::vector<double>{80, 10, 100}, {20, 100, 10}, {100, 200, 25}, {80, 10, 25}}) {
    TimedRows rows;
    double at = 1000;
    for (const double rate_hz : rates)
      for (int i = 0; i < 1200; ++i) rows.instants.push_back(at += 1 / rate_hz);
    INFO(rates[0] << ", " << rates[1] << ", " << rates[2]);
    CHECK_THROWS_WITH(read_text(text_of(rows, kClocks[2])), Catch::Contains("E0334"));
  }
}
