#include "libchar/replay/estimates_writer.hpp"

#include <span>
#include <utility>

#include "libchar/log/recording.hpp"

namespace libchar {

EstimatesWriter::EstimatesWriter(std::string path, bool overwrite) : path_(std::move(path)) {
  writing_.overwrite = overwrite;
}

void EstimatesWriter::begin(const std::vector<std::string>& labels,
                            const std::vector<InputResult>& inputs,
                            double rate_hz,
                            double start_s,
                            std::uint64_t instants) {
  LogInfo info;
  info.file = path_;
  info.samples = info.rows = instants;
  info.time.rate_hz = rate_hz;
  // Seconds from the recording's first sample, as everything else in the report.
  info.channels.push_back({"t", "s", false});
  writing_.time_column = false;
  rate_hz_ = rate_hz;
  start_s_ = start_s;
  inputs_ = inputs.size();
  labels_ = labels.size();
  for (const InputResult& input : inputs) info.channels.push_back({input.name, input.unit, false});
  for (const std::string& label : labels)
    for (const InputResult& input : inputs)
      info.channels.push_back(
          {inputs.size() == 1 ? label : label + " " + input.name, input.unit, false});
  writer_ = open_log_writer(path_, info, writing_);
}

void EstimatesWriter::block(const std::vector<std::vector<double>>& columns) {
  times_.clear();
  const std::size_t rows = columns.empty() ? 0 : columns[0].size();
  for (std::size_t k = 0; k < rows; ++k)
    times_.push_back(start_s_ + static_cast<double>(done_ + k) / rate_hz_);
  done_ += rows;
  std::vector<std::span<const double>> out = {times_};
  // Without a reference the columns of the truth are missing.
  if (columns.size() < inputs_ * (labels_ + 1)) {
    missing_.assign(columns.empty() ? 0 : columns[0].size(), kMissing);
    out.insert(out.end(), inputs_, missing_);
  }
  out.insert(out.end(), columns.begin(), columns.end());
  writer_->write(out);
}

std::vector<std::string> EstimatesWriter::files() const {
  return writer_ ? writer_->files() : std::vector<std::string>{};
}

std::vector<std::string> EstimatesWriter::finish() {
  writer_->finish();
  return writer_->files();
}

}  // namespace libchar
