#include "libchar/replay/detail/blind_run.hpp"

#include <algorithm>
#include <cmath>

#include "libchar/core/error.hpp"
#include "libchar/core/not_known.hpp"
#include "libchar/fusion/why_not.hpp"

namespace libchar {
BlindRun::BlindRun(const PlannedAlgorithm& planned, const fusion::Array& array, const std::vector<Eigen::Index>& live)
    : planned_(&planned), array_(&array), h_(array.h()), meters_(static_cast<std::size_t>(array.channels)) {
  others_.resize(static_cast<std::size_t>(array.channels));
  std::vector<Eigen::Index> all = live;
  for (Eigen::Index i = 0; live.empty() && i < array.channels; ++i) all.push_back(i);
  const auto n = static_cast<Eigen::Index>(all.size());
  const Eigen::Index left_out = left_out_of(n);
  for (Eigen::Index k = 0; k < left_out; ++k) {
    const Eigen::Index out = all[static_cast<std::size_t>(k * n / left_out)];
    std::vector<Eigen::Index> channels;
    for (const Eigen::Index i : all)
      if (i != out) channels.push_back(i);
    others_[static_cast<std::size_t>(out)] = part(channels);
  }
  for (const Eigen::Index start : {0, 1}) {
    std::vector<Eigen::Index> channels;
    for (Eigen::Index i = start; i < n; i += 2) channels.push_back(all[static_cast<std::size_t>(i)]);
    halves_.push_back(part(channels));
  }
}

BlindRun::Part BlindRun::part(const std::vector<Eigen::Index>& channels) const {
  Part out;
  out.channels = channels;
  const fusion::Array array = subset(*array_, channels);
  if (channels.empty() || !fusion::why_not(*planned_->entry->description, array).empty()) return out;
  try {
    out.runner = planned_->entry->make(array, planned_->settings);
    if (!looks_ahead()) out.runner->finish_learning();
  } catch (const Error&) {
    out.runner.reset();  // an option that does not fit fewer channels: no score of this part
  }
  return out;
}

/// Which columns of a block are run and which are scored.
void BlindRun::find_columns(std::int64_t first, Eigen::Index count) {
  run_.clear();
  scored_.clear();
  if (planned_->blind.whole) {
    run_ = scored_ = {{0, count}};
    return;
  }
  const auto add = [&](std::int64_t from, std::int64_t to, std::vector<Columns>& columns) {
    const std::int64_t begin = std::max(from - first, std::int64_t{0}),
                       end = std::min(to - first, static_cast<std::int64_t>(count));
    if (begin < end) columns.push_back({static_cast<Eigen::Index>(begin), static_cast<Eigen::Index>(end - begin)});
  };
  for (const BlindStretch& stretch : planned_->blind.stretches) {
    add(stretch.from, stretch.to, run_);
    add(stretch.scored_from, stretch.to, scored_);
  }
}

bool BlindRun::looks_ahead() const { return planned_->looks_ahead(); }

void BlindRun::look(std::int64_t first, const Eigen::MatrixXd& samples) {
  find_columns(first, samples.cols());
  for_each_part([&](Part& part) {
    for (const Columns& columns : run_) {
      part_ = samples.middleCols(columns.from, columns.count)(part.channels, Eigen::indexing::all);
      part.runner->look(part_);
    }
  });
}

void BlindRun::finish_looking() {
  if (looks_ahead()) for_each_part([](Part& part) { part.runner->finish_learning(); });
}

template <class Work>
void BlindRun::for_each_part(const Work& work) {
  for (std::vector<Part>* parts : {&others_, &halves_})
    for (Part& part : *parts) {
      if (!part.runner) continue;
      try {
        work(part);
      } catch (const Error&) {
        part.runner.reset();
      }
    }
}

bool BlindRun::step(Part& part, const Eigen::MatrixXd& samples, Eigen::MatrixXd& x) {
  if (!part.runner) return false;
  x.resize(array_->inputs(), samples.cols());
  variance_.resize(x.rows(), x.cols());
  for (const Columns& columns : run_) {
    part_ = samples.middleCols(columns.from, columns.count)(part.channels, Eigen::indexing::all);
    part.runner->run(part_, x.middleCols(columns.from, columns.count),
                     variance_.middleCols(columns.from, columns.count));
    steps_ += static_cast<std::uint64_t>(columns.count);
  }
  return true;
}

void BlindRun::run(std::int64_t first, const Eigen::MatrixXd& samples, Eigen::Index skip) {
  find_columns(first, samples.cols());
  score_others(samples, skip);
  score_halves(samples, skip);
}

void BlindRun::push_errors(Eigen::Index skip, ErrorMeter& meter) {
  meter.push(std::span(errors_).subspan(static_cast<std::size_t>(skip)));
}

void BlindRun::score_others(const Eigen::MatrixXd& samples, Eigen::Index skip) {
  const auto m = static_cast<std::size_t>(samples.cols());
  squares_.assign(m, 0);
  counts_.assign(m, 0);
  for (std::size_t i = 0; i < others_.size(); ++i) {
    if (!step(others_[i], samples, x_)) continue;
    errors_.assign(m, kNone);
    const auto row = static_cast<Eigen::Index>(i);
    for (const Columns& columns : scored_)
      for (Eigen::Index k = columns.from; k < columns.from + columns.count; ++k) {
        const double e = h_.row(row).dot(x_.col(k)) - samples(row, k);
        if (!std::isfinite(e)) continue;
        errors_[static_cast<std::size_t>(k)] = e;
        squares_[static_cast<std::size_t>(k)] += e * e;
        counts_[static_cast<std::size_t>(k)] += 1;
      }
    push_errors(skip, meters_[i]);
  }
  errors_.resize(m);
  for (std::size_t k = 0; k < m; ++k) errors_[k] = counts_[k] > 0 ? std::sqrt(squares_[k] / counts_[k]) : kNone;
  push_errors(skip, all_);
}

void BlindRun::score_halves(const Eigen::MatrixXd& samples, Eigen::Index skip) {
  const bool even = step(halves_[0], samples, x_), odd = step(halves_[1], samples, other_);
  if (!even || !odd) return;
  errors_.assign(static_cast<std::size_t>(samples.cols()), kNone);
  for (const Columns& columns : scored_)
    for (Eigen::Index k = columns.from; k < columns.from + columns.count; ++k) {
      const double e = 0.5 * (x_.col(k) - other_.col(k)).norm();
      if (std::isfinite(e)) errors_[static_cast<std::size_t>(k)] = e;
    }
  push_errors(skip, split_);
}

Meters BlindRun::meters() const {
  Meters out;
  for (const ErrorMeter& meter : meters_)
    if (score(meter, 1, {false}).samples > 0) out.push_back(&meter);
  return out;
}

BlindScore BlindRun::result(double rate_hz, const ScoreOptions& options) const {
  ScoreOptions without_interval = options;
  without_interval.intervals = false;
  BlindScore out;
  out.share = planned_->blind.share;
  const ErrorScore all = score(all_, rate_hz, options);
  out.leave_one_out_rms = all.rmse;
  out.leave_one_out_ci95 = all.rmse_ci95;
  double squares = 0, offsets = 0;
  for (const ErrorMeter& meter : meters_) {
    const ErrorScore one = score(meter, rate_hz, without_interval);
    out.leave_one_out.push_back(one.samples > 0 ? one.rmse : kNone);
    if (one.samples == 0) continue;
    squares += one.rmse * one.rmse;
    offsets += one.bias * one.bias;
  }
  out.offset_share = squares > 0 ? offsets / squares : 0;
  const GeometricRms predictive = geometric_rms(meters(), options);
  out.predictive_rms = predictive.rms;
  out.predictive_ci95 = predictive.ci95;
  out.split_rms = split_.cells().empty() ? kNone : score(split_, rate_hz, without_interval).rmse;
  return out;
}

}  // namespace libchar
