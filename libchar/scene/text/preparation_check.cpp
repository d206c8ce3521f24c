#include "libchar/scene/text/preparation_check.hpp"

namespace libchar {

std::string why_not_prepared(const Scene& scene) {
  const ScenePreparation& p = scene.preparation;
  if (p.from_hz < 0 || p.to_hz < 0 || (p.to_hz > 0 && !(p.from_hz > 0 && p.from_hz < p.to_hz)))
    return "a band goes from a frequency above zero to a higher one";
  if (scene.tilt && (p.filters() || p.detrend != "none"))
    return "the filters of a tilt need gravity, which this takes out";
  if (!scene.reference) return "";
  if (scene.reference->estimate_offset && (p.filters() || p.detrend != "none"))
    return "it leaves no offset of the reference to estimate";
  const bool offset = scene.reference->estimate_offset || scene.reference->offset != 0;
  if (offset && scene.reference->channels.size() > 1 && !scene.reference->mean)
    return "an offset is that of one true input";
  return "";
}

}  // namespace libchar
