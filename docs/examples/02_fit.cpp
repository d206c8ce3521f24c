// Samples that are in memory already: the coefficients without a file.
#include <cstdio>
#include <vector>

#include "libchar/libchar.hpp"

int main() {
  // White noise of 0.01 U at 100 Hz: N = 0.01 / √100 = 0.001 U·√s.
  libchar::DeviateStream deviates({.seed = 7});
  std::vector<double> record(100000);
  for (double& y : record) y = 0.01 * deviates.normal();

  const libchar::NoiseFit fit = libchar::fit(record, 100);
  for (const libchar::Term term : {libchar::Term::white, libchar::Term::flicker}) {
    const libchar::Coefficient& c = fit[term];
    const auto& name = libchar::kTermNames[static_cast<std::size_t>(term)];
    if (c.value)
      std::printf("%s %.2g\n", name.key.data(), *c.value);
    else
      std::printf("%s not detected, below %.1g\n", name.key.data(), c.upper95.value_or(0));
  }
}
