// A channel sees the common input late, scaled, shifted and with some of the other axes:
//   y(t) = b + (1 + g) x(t - d) + sum_k m_k c_k(t)   so that
//   z(t) = (y(t + d) - b - sum_k m_k c_k(t)) / (1 + g)   is x again.
#include "libchar/fusion/aligner.hpp"

#include <cmath>

namespace libchar::fusion {
void cross_means(const Alignment& alignment, const Eigen::Ref<const Eigen::VectorXd>& column, Eigen::VectorXd& means) {
  const auto n = static_cast<Eigen::Index>(alignment.channels.size());
  means.resize(column.size() / n - 1);
  for (Eigen::Index k = 0; k < means.size(); ++k) {
    double sum = 0;
    Eigen::Index count = 0;
    for (Eigen::Index i = 0; i < n; ++i)
      if (const double c = column((k + 1) * n + i); std::isfinite(c)) {
        sum += c;
        ++count;
      }
    means(k) = 2 * count >= n ? sum / static_cast<double>(count) : ChannelAlignment::kUnknown;
  }
}

Eigen::VectorXd in_time(const Alignment& alignment, const Eigen::VectorXd& aligned, const Eigen::VectorXd& cross) {
  Eigen::VectorXd out(aligned.size());
  for (Eigen::Index i = 0; i < aligned.size(); ++i) {
    const ChannelAlignment& channel = alignment.channels[static_cast<std::size_t>(i)];
    out(i) = channel.bias + (1 + channel.gain) * aligned(i);
    for (Eigen::Index k = 0; k < cross.size(); ++k)
      if (const double m = channel.cross[static_cast<std::size_t>(k)]; m != 0) out(i) += m * cross(k);
  }
  return out;
}

Aligner::Aligner(const Alignment& alignment) : alignment_(&alignment) {
  for (const ChannelAlignment& channel : alignment.channels) taps_.emplace_back(channel.delay, alignment.interpolation);
}

void Aligner::clip(Eigen::MatrixXd& samples) const {
  for (Eigen::Index i = 0; i < samples.rows(); ++i) {
    const ChannelLimits& limits = alignment_->limits[static_cast<std::size_t>(i)];
    if (std::isinf(limits.low) && std::isinf(limits.high)) continue;
    for (Eigen::Index t = 0; t < samples.cols(); ++t)
      if (!limits.hold(samples(i, t))) samples(i, t) = ChannelAlignment::kUnknown;
  }
}

void Aligner::column(const Eigen::MatrixXd& samples, Eigen::Index t, Eigen::VectorXd& out) const {
  const auto n = static_cast<Eigen::Index>(alignment_->channels.size());
  out.resize(n);
  Eigen::VectorXd cross;
  cross_means(*alignment_, samples.col(t), cross);
  for (Eigen::Index i = 0; i < n; ++i) {
    const ChannelAlignment& channel = alignment_->channels[static_cast<std::size_t>(i)];
    double y = taps_[static_cast<std::size_t>(i)].at(samples.data() + i, samples.rows(), samples.cols(), t);
    y -= channel.bias;
    for (Eigen::Index k = 0; k < cross.size(); ++k)
      if (const double m = channel.cross[static_cast<std::size_t>(k)]; m != 0) y -= m * cross(k);
    out(i) = y / (1 + channel.gain);
  }
}

}  // namespace libchar::fusion
