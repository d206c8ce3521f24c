
#include <catch2/catch.hpp>
#include <cmath>
#include <random>

#include "libchar/characterize/characterization_view.hpp"
#include "libchar/characterize/compare/verification.hpp"
#include "libchar/characterize/judgement.hpp"
#include "libchar/report/text/characterization_text.hpp"
#include "tests/report/synthetic.hpp"

using namespace libchar;
using Catch::Contains;
using Catch::EndsWith;
using Catch::StartsWith;

namespace {

ChannelResult clean(const std::string& unit = "deg/s") { return test::synthetic_channel("x", unit, {}, 1); }

Event step_of(double size, double at_s) {
  Event event;
  event.size = size;
  event.at_s = at_s;
  return event;
}

std::string sentence_of(const ChannelResult& c, const std::string& unit = "deg/s") {
  return detail::summary_sentence(c, judge(c), unit);
}

Characterization white_noise(std::size_t n, unsigned seed, auto&& spoil) {
  std::mt19937_64 generator(seed);
  std::normal_distribution<double> normal;
  Recording recording;
  recording.info.time.rate_hz = 100;
  recording.info.channels = {{"x", "deg/s", false}};
  recording.samples.resize(1);
  for (std::size_t i = 0; i < n; ++i) recording.samples[0].push_back(normal(generator));
  spoil(recording.samples[0], generator);
  return characterize(recording);
}

}  // namespace

TEST_CASE("judge: headline, badge and sentence agree on a log with spikes") {
  const Characterization result = white_noise(40000, 5, [](std::vector<double>& y, std::mt19937_64& generator) {
    for (int k = 0; k < 100; ++k) y[generator() % y.size()] += k % 2 == 0 ? 20 : -20;
  });
  const CharacterizationView view = characterization_view(result);
  CHECK(view.rating == Rating::caution);
  CHECK(view.channels[0].judgement.has("spikes_left_out"));
  CHECK_THAT(view.verdict, EndsWith(" Use it with caution: spikes were left out."));
  CHECK_THAT(view.channels[0].summary, Contains(" But: spikes were left out"));
}

TEST_CASE("judge: headline, badge and sentence agree on a log with 12 % of its rows missing") {
  const Characterization result = white_noise(40000, 6, [](std::vector<double>& y, std::mt19937_64& generator) {
    for (double& value : y)
      if (generator() % 100 < 12) value = std::nan("");
  });
  const CharacterizationView view = characterization_view(result);
  CHECK(view.rating == Rating::caution);
  CHECK(view.channels[0].judgement.has("missing_samples"));
  CHECK_THAT(view.verdict, Contains(" Use it with caution: ") && Contains("samples are missing."));
  CHECK_THAT(characterization_text(view), Contains("  caution: "));
}

TEST_CASE("judge: a headline of nothing but good channels warns of none") {
  const Characterization result = white_noise(40000, 7, [](auto&, auto&) {});
  const CharacterizationView view = characterization_view(result);
  CHECK(view.rating == Rating::good);
  CHECK_THAT(view.verdict, EndsWith("agrees.") && !Contains("caution"));
}

TEST_CASE("summary: a channel that nothing speaks against is good, its terms in the field's units") {
  const ChannelResult c = clean();
  CHECK(judge(c).rating == Rating::good);
  CHECK(judge(c).findings.empty());
  CHECK_THAT(sentence_of(c), StartsWith("Angle random walk N 0.3") && Contains(" deg/√h [") &&
                                 Contains(", bias instability B ") && Contains(" deg/h [") &&
                                 Contains(", rate random walk K ") && Contains(" deg/h/√h ["));
  CHECK_THAT(sentence_of(clean("m/s^2"), "m/s²"),
             StartsWith("Velocity random walk N ") && Contains("acceleration random walk K"));
  CHECK_THAT(sentence_of(clean(""), ""), StartsWith("White noise N ") && Contains(" U·√s ["));
}

TEST_CASE("summary: slow noise that is a Gauss-Markov process is not called unseen") {
  ChannelResult c = clean();
  c.fit->term[1] = c.fit->term[2] = {};
  c.fit->term[1].status = c.fit->term[2].status = Status::not_detected;
  c.fit->term[1].upper95 = c.fit->term[2].upper95 = 1e-5;
  CHECK_THAT(sentence_of(c), !Contains("Gauss"));
  c.fit->gauss_markov.emplace();
  c.fit->gauss_markov->in_model = true;
  c.fit->gauss_markov->sigma.status = c.fit->gauss_markov->tau_s.status = Status::detected;
  c.fit->gauss_markov->sigma.value = 0.02;
  c.fit->gauss_markov->tau_s.value = 60;
  CHECK_THAT(sentence_of(c),
             Contains("a Gauss–Markov process of 0.02") && Contains(" deg/s with a correlation time of"));
}

TEST_CASE("summary: what may be next to nothing, cut off or nearly right is not simply good or bad") {
  ChannelResult c = clean();
  c.fit->term[2].ci95.low = 0;
  CHECK(judge(c).has("reaches_zero"));

  c = clean();
  c.quality.findings = {finding("saturated", "5 samples stand at the end of the range")};
  CHECK(judge(c).rating == Rating::caution);
  c.quality.findings = {finding("much_saturated", "480 samples (48 %) stand at the end of the range")};
  CHECK(judge(c).rating == Rating::bad);
  CHECK_THAT(sentence_of(c), Contains("480 samples (48 %) stand at the end of the range"));

  c = clean();
  auto verification = std::make_shared<ChannelVerification>();
  verification->sentences = {"it differs"};
  c.verification = verification;
  CHECK(judge(c).rating == Rating::bad);
  verification->nearly = true;
  CHECK(judge(c).rating == Rating::caution);
  CHECK_THAT(sentence_of(c), Contains("differs by a few per cent"));
}

TEST_CASE("summary: a ratio has no unit to print") {
  const std::string sentence = sentence_of(clean("1"), "1");
  CHECK_THAT(sentence, Contains(" √s [") && Contains(" 1/√s [") && !Contains("1·√s"));
}

TEST_CASE("summary: what was taken out, and what is doubtful, is never called good") {
  ChannelResult c = clean();
  c.fit->events = {step_of(0.1, 12)};
  CHECK(judge(c).rating == Rating::caution);
  CHECK_THAT(sentence_of(c), Contains("But: a step was taken out."));
  c.fit->events.push_back(step_of(-0.1, 20));
  c.fit->events.push_back(step_of(-0.1, 30));
  c.fit->events.back().kind = EventKind::warm_up;
  CHECK_THAT(sentence_of(c), Contains("2 steps and a warm-up were taken out."));
  c = clean();
  c.fit->term[1].status = c.fit->term[2].status = Status::undetermined;
  CHECK(judge(c).rating == Rating::good);  // N holds, and the sentence says of B and K that they are undetermined
  CHECK_THAT(sentence_of(c), Contains("], undetermined, rate random walk K"));
  c.fit->term[0].status = Status::undetermined;
  CHECK(judge(c).rating == Rating::caution);
  CHECK_THAT(sentence_of(c), Contains("But: N, B and K undetermined"));
}

TEST_CASE("summary: a misfit, a bad goodness, no fit are not to be used") {
  ChannelResult c = clean();
  for (Coefficient& term : c.fit->term)
    if (term.value) term.status = Status::misfit;
  CHECK(judge(c).rating == Rating::bad);
  CHECK_THAT(sentence_of(c), Contains("Do not rely on them: the noise terms do not describe"));
  c = clean();
  c.fit->goodness.p = 1e-5;
  CHECK(judge(c).rating == Rating::bad);
  c = clean();
  c.fit.reset();
  c.findings = {finding("motion", "The sensor moves."),
                finding("no_fit", "no noise fit: the recording holds a signal throughout")};
  CHECK(judge(c).rating == Rating::bad);
  CHECK_THAT(sentence_of(c), Contains("No noise fit: the recording holds a signal throughout; the sensor moves."));
}

TEST_CASE("summary: findings are phrases, the worst first, and their sentences stand with the channel") {
  ChannelResult c = clean();
  c.findings = {finding("strength_change", "The noise changes.", "the noise is 1.75 times as strong from 100 s on"),
                finding("motion", "The sensor was moved or shaken in 2 stretches.", "moved or shaken in 2 stretches")};
  CHECK(judge(c).rating == Rating::caution);
  CHECK_THAT(sentence_of(c),
             Contains("But: the noise is 1.75 times as strong from 100 s on; moved or shaken in 2 stretches") &&
                 !Contains("The sensor was"));
  c.findings[1].severity = Severity::bad;
  CHECK(judge(c).rating == Rating::bad);
  CHECK(judge(c).findings[0].code == "motion");
}

TEST_CASE("summary: where the band is cut the sentence says up to where the terms hold") {
  ChannelResult c = clean();
  c.fit->band.whole = false;
  c.fit->band.top_hz = 12.5;
  CHECK_THAT(sentence_of(c), Contains(" Valid below 12.5 Hz."));
  CHECK_THAT(sentence_of(clean()), !Contains("hold below"));
}

TEST_CASE("summary: the terminal says the sentence of the view") {
  const Characterization result = test::synthetic_imu();
  const CharacterizationView view = characterization_view(result);
  const std::string text = characterization_text(view);
  for (const ChannelView& channel : view.channels) CHECK_THAT(text, Contains(channel.summary));
  CHECK(view.rating == Rating::bad);  // acc_z
  REQUIRE(view.groups.size() == 2);
  CHECK(view.groups[0].title == "Angular rate");
  CHECK(view.groups[1].channels == std::vector<std::size_t>{3, 4, 5});
}

TEST_CASE("verdict: what moved is not explained, and that it is not described needs no finding beside the motion") {
  ChannelResult c = clean();
  c.findings = {finding("motion", "It was moved.", "moved in a stretch"), finding("misfit", "Not described.")};
  c.findings[0].severity = Severity::bad;
  for (Coefficient& term : c.fit->term)
    if (term.value) term.status = Status::misfit;
  CHECK_FALSE(judge(c).has("misfit"));
  Characterization result;
  result.channels = {c, clean()};
  CHECK_THAT(verdict_of(result), Catch::StartsWith("The noise model explains 1 of 2 channels"));
  result.channels.pop_back();
  CHECK_THAT(verdict_of(result), Catch::StartsWith("The noise model does not explain the channel. Do not use it"));
}

TEST_CASE("verdict: several channels with one reason say it, with unlike ones see each") {
  Characterization result = test::synthetic_imu();
  std::vector<Judgement> judged(result.channels.size());
  for (std::size_t c : {std::size_t{0}, std::size_t{1}})
    judged[c] = {Rating::bad, {finding("not_gravity", "The mean is 1.", "the mean is 1")}};
  CHECK_THAT(verdict_of(result, judged), Contains(": the mean is 1."));
  judged[1].findings[0].phrase = "the mean is 2";
  CHECK_THAT(verdict_of(result, judged), Contains("see the notes on them"));
}
