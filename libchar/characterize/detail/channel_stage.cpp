#include "libchar/characterize/detail/channel_stage.hpp"

#include <algorithm>
#include <new>
#include <utility>

#include "libchar/core/numeric/whole.hpp"

namespace libchar {

ChannelStage::ChannelStage(const CharacterizeOptions& options, CharacterizeWorkspace& workspace, bool keep)
    : options_(&options),
      workspace_(&workspace),
      keep_(keep),
      in_turn_(!spectrum_of_all(options) && !why_not_in_leaves(options).empty()),
      stage_(std::make_unique<LeafStage>(options, workspace.welch)),
      tree_(*stage_) {
  meters_.traces = options.wanted.quality;
}

// A leaf is taken when a further sample shows that it is not the last one.
void ChannelStage::push(std::span<const double> samples) {
  if (keep_) all_.insert(all_.end(), samples.begin(), samples.end());
  while (!samples.empty()) {
    if (leaf_.size() > kLeafSamples) end_leaf(false);
    const std::size_t more = std::min<std::size_t>(samples.size(), kLeafSamples + 1 - leaf_.size());
    leaf_.insert(leaf_.end(), samples.begin(), samples.begin() + static_cast<std::ptrdiff_t>(more));
    meters_.push(samples.first(std::min<std::size_t>(more, more - (leaf_.size() > kLeafSamples))));
    samples = samples.subspan(more);
  }
}

void ChannelStage::end_leaf(bool last) {
  if (leaves_ == 0 && in_turn_) spectrum_.emplace(streamed_spectrum(options_->spectrum), &workspace_->welch);
  const auto end = leaf_.begin() + static_cast<std::ptrdiff_t>(last ? leaf_.size() : kLeafSamples);
  if (spectrum_) {
    std::vector<double> rate(leaf_.begin(), end);
    stage_->make_rate(rate);
    spectrum_->push(rate);
  }
  const std::size_t rows = last ? leaf_.size() : detail::in_memory(stage_->rows());
  tree_.add({0, leaves_++, stage_->take(std::span(leaf_).first(rows), last, std::exchange(meters_, {}))});
  meters_.traces = options_->wanted.quality;
  leaf_.erase(leaf_.begin(), end);
  meters_.push(leaf_);
}

void ChannelStage::reserve(std::size_t samples) {
  try {
    leaf_.reserve(std::min<std::size_t>(samples, kLeafSamples + 1));
    if (keep_ && samples > kLeafSamples) all_.reserve(samples);
  } catch (const std::bad_alloc&) {
    // Where address space is short the record grows as it comes.
  }
}

void ChannelStage::drop() {
  leaf_ = all_ = std::vector<double>();  // `{}` would keep the memory
  tree_.nodes().clear();
}

ChannelResult ChannelStage::finish(const Channel& channel, const TimeBase& time) {
  ReadChannel read;
  const bool whole = tree_.empty() && leaf_.size() <= kLeafSamples;
  if (!whole && leaf_.size() > kLeafSamples) end_leaf(false);
  if (whole) {
    read.sums.meters = std::move(meters_);
    read.sums.kept = std::move(leaf_);
  } else {
    end_leaf(true);
    read.sums = tree_.whole();
  }
  read.all = std::move(all_);
  read.spectrum = std::move(spectrum_);
  read.temperature = temperature_;
  return finish_channel(std::move(read), *options_, *workspace_, channel, time);
}

}  // namespace libchar
