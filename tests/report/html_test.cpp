#include <catch2/catch.hpp>
#include <cstdlib>
#include <regex>
#include <sstream>
#include <string>

#include "libchar/core/file/whole_file.hpp"
#include "libchar/report/detail/assets.hpp"
#include "libchar/report/html/html_report.hpp"
#include "tests/report/page_text.hpp"
#include "tests/report/synthetic.hpp"
#include "tests/support/shared.hpp"

using namespace libchar;

namespace {

// The page without the parts that are ours byte for byte.
std::string without_assets(std::string page) {
  for (const std::string_view asset : {chart_js(), page_common_js(), page_js(), page_css()}) {
    const std::size_t at = page.find(asset);
    REQUIRE(at != std::string::npos);
    page.erase(at, asset.size());
  }
  return page;
}

}  // namespace

TEST_CASE("html: asks for nothing from anywhere") {
  const std::string page = without_assets(html_report(test::synthetic_imu()));
  for (const char* word :
       {"src=", "href=\"http", "@import", "url(", "<link", "<iframe", "<img", " style=\"", " onclick"}) {
    INFO(word);
    CHECK(test::count(page, word) == 0);
  }
  CHECK(test::count(page, "default-src 'none'; script-src 'sha256-") == 1);
  CHECK(test::count(page, "unsafe-") == 0);
}

TEST_CASE("html: the plotting library comes with its whole licence and both notices") {
  const std::string page = html_report(test::synthetic_imu());
  CHECK(test::count(page, "Chart.js Contributors") >= 1);
  CHECK(test::count(page, "Permission is hereby granted, free of charge") == 1);
  CHECK(test::count(page, "kurkle/color") >= 1);
  CHECK(test::count(without_assets(page), "Jukka Kurkela") == 1);
  CHECK(chart_js().find("Chart.js v3.") != std::string_view::npos);
}

TEST_CASE("html: names from a file never become elements or attributes") {
  const std::string plain = html_report(test::synthetic_imu());
  const std::string page = html_report(test::hostile());
  CHECK(test::count(page, "<script") == test::count(plain, "<script"));
  CHECK(test::count(page, "</script") == test::count(plain, "</script"));
  CHECK(test::count(without_assets(page), "<!--") == 1);
  for (const char* word : {"<img", "<svg", " onerror=\"", " onmouseover=\"", "<b>;"}) {
    INFO(word);
    CHECK(test::count(without_assets(page), word) == 0);
  }
  CHECK(test::count(page, "\xE2\x80\xAE") == 0);  // right-to-left override
  CHECK(page.find('\0') == std::string::npos);
  CHECK(test::count(page, "&lt;img src=x onerror=alert(1)&gt;") > 0);
}

TEST_CASE("html: every row of every table has the cells of its head") {
  Characterization result = test::synthetic_imu();
  REQUIRE(result.channels[0].fit);
  GaussMarkovFit process;
  process.sigma = process.tau_s = (*result.channels[0].fit)[Term::white];
  result.channels[0].fit->gauss_markov = process;
  const std::string page = without_assets(html_report(result));
  CHECK(test::count(page, "correlation time") > 0);
  CHECK(test::rows_that_do_not_fit(page) == std::vector<std::string>());
}

TEST_CASE("html: the plot says what its points hold and its lines do not") {
  Characterization result = test::synthetic_imu();
  for (ChannelResult& c : result.channels)
    if (c.fit) {
      c.fit->remedies.clear();
      c.fit->events.clear();
    }
  const char* const taken = "contained in the points but not in the models: ";
  CHECK(test::count(html_report(result), taken) == 0);
  result.channels[0].fit->remedies = {{"temperature", "", "", 1}, {"spikes", "", "", 4}};
  CHECK(test::count(html_report(result), std::string(taken) + "spikes; temperature.") == 1);
}

TEST_CASE("html: every number of a channel stands in a table too") {
  const auto result = test::synthetic_imu();
  const std::string page = without_assets(html_report(result));
  CHECK(test::count(page, "<noscript>") == 1);
  CHECK(test::count(page, "<details class=\"channel\"") == result.channels.size());
  CHECK(test::count(page, "Overlapping Allan deviation</h3>") == result.channels.size() + 2);
  CHECK(test::count(page, "One-sided power spectral density</h3>") == result.channels.size());
  CHECK(test::count(page, result.log.sha256) >= 1);
  CHECK(test::count(page, "&#39;out dir&#39;") == 1);  // the command, quoted as a shell wants it
  for (const char* word :
       {"deg/√h", "deg/h", "µg/√Hz", "gyroscope_noise_density", "IEEE 952", "not detected", "undetermined"}) {
    INFO(word);
    CHECK(test::count(page, word) > 0);
  }
}

TEST_CASE("html: what could not be computed leaves a sentence, not a hole") {
  const std::string page = html_report(test::barely_anything());
  CHECK(test::count(page, "5 samples are too few for a fit") >= 2);
  CHECK(test::count(page, "unit not stated") == 1);
  CHECK(!std::regex_search(without_assets(page), std::regex("\\b(nan|inf)\\b")));
}

TEST_CASE("html: a parser that knows nothing of us finds it well-formed") {
  if (std::system("command -v xmllint >/dev/null 2>&1") != 0) {
    WARN("SKIPPED: xmllint is absent");
    return;
  }
  const test::TemporaryFolder folder;
  for (const auto& [name, result] :
       {std::pair{"plain.html", test::synthetic_imu()}, std::pair{"hostile.html", test::hostile()}}) {
    // HTML 4's parser does not know section, figure, header, main, footer; those complaints are its own.
    const std::string path = (folder / name).string(), log = path + ".log";
    write_whole_file(path, without_assets(html_report(result)));
    const int code = std::system(("xmllint --html --noout '" + path + "' 2>'" + log + "'").c_str());
    INFO(test::slurp(log));
    std::string complaints;
    std::istringstream lines(test::slurp(log));
    for (std::string line; std::getline(lines, line);) {
      if (line.find("error :") != std::string::npos &&
          !std::regex_search(
              line, std::regex("Tag (section|figure|figcaption|header|main|footer|details|summary|canvas) invalid")))
        complaints += line + "\n";
    }
    CHECK(complaints.empty());
    CHECK(code >= 0);
  }
}

TEST_CASE("html: of a thousand channels those are drawn that ask for a look, and all are listed") {
  const Characterization many = test::many_channels(1000);
  const CharacterizationView view = characterization_view(many);
  const std::string page = html_report(many);
  CHECK(page.size() < 10'000'000);
  std::size_t shown = 0, worst_left_out = 0;
  Rating least_shown = Rating::bad;
  for (std::size_t i = 0; i < view.channels.size(); ++i) {
    const ChannelView& c = view.channels[i];
    const bool here = test::count(page, "id=\"channel-" + std::to_string(i) + "\"") == 1;
    shown += here ? 1 : 0;
    if (here) least_shown = std::min(least_shown, c.judgement.rating);
    CHECK(here == c.in_detail);
  }
  for (const ChannelView& c : view.channels) worst_left_out += !c.in_detail && c.judgement.rating > least_shown ? 1 : 0;
  CHECK(shown == kMostInDetail);
  CHECK(worst_left_out == 0);
  CHECK(test::count(page, "<li class=\"good\">") + test::count(page, "<li class=\"caution\">") +
            test::count(page, "<li class=\"bad\">") ==
        1000);
  CHECK(test::count(page, "id=\"download\"") == 0);  // it does not hold all numbers
  const std::string few = html_report(test::synthetic_imu());
  CHECK(test::count(few, "ask for a look most") == 0);
  CHECK(test::count(few, "id=\"download\"") == 1);
}
