/* Of pair_style sph/artVisc/tensCorr: rows of one array at a time between owned particles and ghosts. */
#include "pair_sph_artvisc_tenscorr.h"

#include "lammps_compat.h"

#include "force.h"

#include <algorithm>
#include <cassert>
#include <cstring>

using namespace LAMMPS_NS;
using namespace StokesDyn;

void PairSph::forward(double *array, int columns)
{
  assert(columns <= comm_forward);
  comm_array = array;
  comm_columns = columns;
  Compat::forward_comm(comm, this);
}

void PairSph::reverse(double *array, int columns, bool largest)
{
  assert(columns <= comm_reverse);
  if (!shared || !force->newton_pair) return;    // ghosts got nothing
  comm_array = array;
  comm_columns = columns;
  comm_largest = largest;
  Compat::reverse_comm(comm, this);
}

int PairSph::pack_forward_comm(int n, int *list, double *buf, int /*pbc_flag*/, int * /*pbc*/)
{
  for (int k = 0; k < n; k++)
    for (int c = 0; c < comm_columns; c++) *buf++ = comm_array[(size_t) list[k] * comm_columns + c];
  return n * comm_columns;
}

void PairSph::unpack_forward_comm(int n, int first, double *buf)
{
  memcpy(comm_array + (size_t) first * comm_columns, buf, sizeof(double) * n * comm_columns);
}

int PairSph::pack_reverse_comm(int n, int first, double *buf)
{
  memcpy(buf, comm_array + (size_t) first * comm_columns, sizeof(double) * n * comm_columns);
  return n * comm_columns;
}

void PairSph::unpack_reverse_comm(int n, int *list, double *buf)
{
  for (int k = 0; k < n; k++)
    for (int c = 0; c < comm_columns; c++, buf++) {
      double &mine = comm_array[(size_t) list[k] * comm_columns + c];
      mine = comm_largest ? std::max(mine, *buf) : mine + *buf;
    }
}
