/* Of pair_style sph/artVisc/tensCorr: restart files. They hold the words of the pair_style command and the
 * values of pair_coeff. Each pair begins with its setflag, 0 or 1, plus twice the number of its values, which
 * has grown from version to version; files from before mu have the flag alone, and five. */
#include "pair_sph_artvisc_tenscorr.h"

#include "restart.h"

#include "atom.h"
#include "comm.h"
#include "utils.h"

#include <cmath>

using namespace LAMMPS_NS;
using namespace StokesDyn;

static const int BEFORE_MU = 5;

void PairSph::write_restart(FILE *fp)
{
  write_restart_settings(fp);
  for (int i = 1; i <= atom->ntypes; i++)
    for (int j = i; j <= atom->ntypes; j++) {
      double row[1 + NPARAMETERS] = {(double) (setflag[i][j] + 2 * NPARAMETERS)};
      for (int k = 0; k < NPARAMETERS; k++) row[1 + k] = given[k][i][j];
      fwrite(row, sizeof(double), 1 + NPARAMETERS, fp);
    }
}

void PairSph::read_restart(FILE *fp)
{
  read_restart_settings(fp);
  allocate();
  for (int i = 1; i <= atom->ntypes; i++)
    for (int j = i; j <= atom->ntypes; j++) {
      double row[1 + NPARAMETERS] = {0.0};
      for (int k = 0; k < NPARAMETERS; k++) row[1 + k] = NAN;
      if (comm->me == 0) {
        utils::sfread(FLERR, row, sizeof(double), 1, fp, nullptr, error);
        const int count = row[0] < 2.0 ? BEFORE_MU : (int) row[0] / 2;
        if (count > NPARAMETERS) voice.fail_one("the restart file is of a later version of this plugin");
        utils::sfread(FLERR, row + 1, sizeof(double), count, fp, nullptr, error);
      }
      MPI_Bcast(row, 1 + NPARAMETERS, MPI_DOUBLE, 0, world);
      setflag[i][j] = (int) row[0] % 2;
      for (int k = 0; k < NPARAMETERS; k++) given[k][i][j] = row[1 + k];
    }
}

void PairSph::write_restart_settings(FILE *fp)
{
  write_words(fp, args);
}

void PairSph::read_restart_settings(FILE *fp)
{
  args = read_words(lmp, fp, voice.command);
  parse();
}
