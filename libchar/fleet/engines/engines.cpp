#include "libchar/fleet/engines/engine_files.hpp"

namespace libchar {

const std::vector<Engine>& engines() {
  static const std::vector<Engine> all = {
      {"slurm", "job arrays of Slurm", "fleet.slurm.sh", "sh {}", slurm_files},
      {"snakemake", "rules of Snakemake", "Snakefile", "snakemake --cores all", snakemake_files},
      {"parallel", "commands for GNU parallel", "fleet.parallel.sh", "sh {}", parallel_files},
  };
  return all;
}

}  // namespace libchar
