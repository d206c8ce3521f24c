#include "libchar/model/noise_limits.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "libchar/core/document/document.hpp"
#include "libchar/core/refusal.hpp"
#include "libchar/core/text/spelling.hpp"
#include "libchar/core/units.hpp"
#include "libchar/model/detail/noise_term.hpp"

namespace libchar {
namespace {

constexpr Word kSides[] = {{"one-sided"}, {"two-sided"}};

void read_blocks(const MapReader& at, std::string_view key, NoiseLimits& limits) {
  const std::vector<Document>& list = at.list(key);
  if (list.empty()) at.refuse(key, "expected at least one limit");
  for (std::size_t i = 0; i < list.size(); ++i) {
    const MapReader block(list[i], limits.file, fmt::format("{}[{}]", key, i), keys_of(limit_block_fields()));
    LimitBlock out;
    out.node = list[i];
    read_fields(limit_block_fields(), block, out);
    limits.blocks.push_back(std::move(out));
  }
}
void write_no_blocks(const Field&, const NoiseLimits&, std::vector<Entry>&) {}

const Fields<Coefficient>& limit_keys() {
  static const Fields<Coefficient> rows = selected(term_fields(), {"value", "unit", "reading"}, Written::never);
  return rows;
}

/// The term's keys; its value waits for the channel's unit.
void check_term(const MapReader& at, std::string_view key, LimitBlock&) {
  const Document* const node = at.get(key);
  if (node == nullptr) return;
  if (node->kind != Document::Kind::map) {
    at.number(key, kPositive);
    return;
  }
  at.map(key, keys_of(limit_keys())).number("value", kPositive);
}
void write_no_term(const Field&, const LimitBlock&, std::vector<Entry>&) {}

template <std::size_t T>
Row<LimitBlock> term_row() {
  Row<LimitBlock> row = custom<LimitBlock, check_term, write_no_term>(
      kTermNames[T].key, "number or map",
      {.meaning = T == 0 ? "N, the most that is allowed; each term has these keys" : kTermNames[T].letter});
  if (T == 0) row.field.below = limit_keys().rows;
  return row;
}

Refusal at_refusal(const NoiseLimits& limits, const Document& value) {
  return input_error("E0550", fmt::format("{}:{}:{}", limits.file, value.line, value.column));
}

std::vector<std::size_t> named_channels(const NoiseLimits& limits, const LimitBlock& block,
                                        const std::vector<NamedChannel>& channels) {
  const Document& list = block.node.find("channels")->value;
  std::vector<std::size_t> out;
  for (std::size_t i = 0; i < block.channels.size(); ++i) {
    const auto at = std::find_if(channels.begin(), channels.end(),
                                 [&](const NamedChannel& c) { return c.name == block.channels[i]; });
    if (at == channels.end()) {
      std::vector<std::string> names;
      names.reserve(channels.size());
      for (const NamedChannel& c : channels) names.push_back(c.name);
      const auto near = nearest(block.channels[i], names);
      throw at_refusal(limits, list.kind == Document::Kind::list ? list.list[i] : list)
          .says("the recording has no such channel")
          .got(block.channels[i])
          .hint(did_you_mean(near, "its channels are " + first_names(names)));
    }
    out.push_back(static_cast<std::size_t>(at - channels.begin()));
  }
  return out;
}

std::vector<std::size_t> channels_of(const NoiseLimits& limits, const LimitBlock& block,
                                     const std::vector<NamedChannel>& channels) {
  if (!block.channels.empty()) return named_channels(limits, block, channels);
  std::vector<std::size_t> out;
  for (std::size_t i = 0; i < channels.size(); ++i) {
    const auto unit = find_unit(channels[i].unit);
    if (block.kind.empty() || (unit && name_of(unit->quantity) == block.kind)) out.push_back(i);
  }
  if (out.empty())
    throw at_refusal(limits, block.node.find("kind") != nullptr ? block.node.find("kind")->value : block.node)
        .says("no channel of the recording is of the kind {}: limits of another sensor?",
              block.kind.empty() ? "asked for" : block.kind)
        .hint("the kind follows from a channel's unit (`units` where the log has none)");
  return out;
}

std::string text_of(const Document& value) {
  if (value.kind != Document::Kind::map) return value.text;
  const DocumentEntry* const unit = value.find("unit");
  const DocumentEntry* const reading = value.find("reading");
  std::string text = shown(value.find("value")->value);
  if (unit != nullptr) text += " " + unit->value.text;
  if (reading != nullptr && reading->value.text == "floor") text += " (floor)";
  return text;
}

void add_limits(const NoiseLimits& limits, const LimitBlock& block, const NamedChannel& channel, std::size_t index,
                std::vector<ChannelLimit>& out) {
  const MapReader at(block.node, limits.file, "limits", keys_of(limit_block_fields()));
  for (std::size_t t = 0; t < kTerms; ++t) {
    const DocumentEntry* const entry = block.node.find(kTermNames[t].key);
    if (entry == nullptr || entry->value.kind == Document::Kind::null) continue;
    const Term term = static_cast<Term>(t);
    for (const ChannelLimit& other : out)
      if (other.channel == index && other.term == term)
        throw at_refusal(limits, entry->value)
            .says("channel {} has a limit of {} already, in line {}", channel.name, entry->key, other.line)
            .hint("leave one of the two out");
    // The rules for units and sides are those of sensor models.
    SensorModel model;
    model.unit = channel.unit;
    read_term(at, entry->key, model);
    out.push_back({index, term, model.noise[t].value.value_or(0), text_of(entry->value), entry->line});
  }
}

}  // namespace

const Fields<NoiseLimits>& limits_fields() {
  static const Fields<NoiseLimits> rows = {
      constant<NoiseLimits>("format", std::string("noise-limits"), {.meaning = "noise-limits"}),
      constant<NoiseLimits>("version", std::uint64_t{1}, {.meaning = "1"}),
      tool_row<NoiseLimits>(),
      field<&NoiseLimits::sensor>("sensor", {.meaning = "device that the limits belong to", .otherwise = "not stated"}),
      custom<NoiseLimits, read_blocks, write_no_blocks>("limits", "list of maps",
                                                        {.meaning = "each with the keys below", .required = true}),
  };
  return rows;
}

const Fields<LimitBlock>& limit_block_fields() {
  static const Fields<LimitBlock> rows = {
      field<&LimitBlock::channels>("channels", {.meaning = "names", .otherwise = "by kind"}),
      field<&LimitBlock::kind>("kind", {.words = words_in_fields<Quantity>(),
                                        .meaning = "what a channel measures, by its unit",
                                        .otherwise = "every channel"}),
      field<&LimitBlock::density>("density",
                                  {.words = kSides, .meaning = "side of every value per √Hz; needed where a value is"}),
      term_row<0>(),
      term_row<1>(),
      term_row<2>(),
      term_row<3>(),
      term_row<4>(),
  };
  return rows;
}

NoiseLimits parse_limits(std::string_view text, const std::string& file) {
  const Document document = parse_document(text, file);
  check_format(document, file, "noise-limits", 1);
  NoiseLimits limits;
  limits.file = file;
  const MapReader at(document, file, "", keys_of(limits_fields()));
  at.require("limits");
  read_fields(limits_fields(), at, limits);
  for (const LimitBlock& block : limits.blocks) {
    if (!block.channels.empty() && !block.kind.empty())
      throw at_refusal(limits, block.node.find("kind")->value).says("channels and kind exclude each other");
    if (std::none_of(kTermNames.begin(), kTermNames.end(), [&](const TermName& name) {
          const DocumentEntry* const entry = block.node.find(name.key);
          return entry != nullptr && entry->value.kind != Document::Kind::null;
        }))
      throw at_refusal(limits, block.node)
          .says("a block of limits limits no noise term")
          .hint("such as white_noise: {value: 0.3, unit: deg/√h}");
  }
  return limits;
}

NoiseLimits read_limits_file(const std::string& path) { return parse_limits(read_document_text(path), path); }

std::vector<ChannelLimit> limits_for(const NoiseLimits& limits, const std::vector<NamedChannel>& channels) {
  std::vector<ChannelLimit> out;
  for (const LimitBlock& block : limits.blocks)
    for (const std::size_t index : channels_of(limits, block, channels))
      add_limits(limits, block, channels[index], index, out);
  std::stable_sort(out.begin(), out.end(), [](const ChannelLimit& a, const ChannelLimit& b) {
    return std::pair(a.channel, a.term) < std::pair(b.channel, b.term);
  });
  return out;
}

}  // namespace libchar
