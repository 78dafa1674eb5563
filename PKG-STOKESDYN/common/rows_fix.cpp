#include "rows_fix.h"

#include "atom.h"

using namespace LAMMPS_NS;

namespace StokesDyn {

void RowsFix::keep(const std::vector<RowsOfAtoms *> &all, AtomArray *output, bool restarts)
{
  kept = all;
  shown = output;
  if (shown) {
    peratom_flag = 1;
    peratom_freq = 1;
    size_peratom_cols = shown->columns();
  }
  create_attribute = 1;
  // beyond a thousand numbers of all fixes LAMMPS's buffers hold what is announced
  maxexchange = 0;
  for (const RowsOfAtoms *rows : kept) maxexchange += rows->most_packed();
  restart_peratom = restarts;
  grow_arrays(atom->nmax);
  atom->add_callback(Atom::GROW);
  if (restarts) atom->add_callback(Atom::RESTART);
}

RowsFix::~RowsFix()
{
  if (kept.empty()) return;
  atom->delete_callback(id, Atom::GROW);
  if (restart_peratom) atom->delete_callback(id, Atom::RESTART);
}

void RowsFix::grow_arrays(int nmax)
{
  for (RowsOfAtoms *rows : kept) rows->grow(nmax);
  if (shown) array_atom = shown->array();
}

void RowsFix::copy_arrays(int i, int j, int /*delflag*/)
{
  for (RowsOfAtoms *rows : kept) rows->copy(i, j);
}

void RowsFix::set_arrays(int i)
{
  for (RowsOfAtoms *rows : kept) rows->take(i);
}

int RowsFix::pack_exchange(int i, double *buf)
{
  int m = 0;
  for (const RowsOfAtoms *rows : kept) m += rows->pack(i, buf + m);
  return m;
}

int RowsFix::unpack_exchange(int i, double *buf)
{
  int m = 0;
  for (RowsOfAtoms *rows : kept) m += rows->unpack(i, buf + m);
  return m;
}

/* All atoms take as much as the longest, so that the file tells whether it is of this kind. */
int RowsFix::maxsize_restart()
{
  int size = 1;
  for (const RowsOfAtoms *rows : kept) size += rows->most_packed();
  return size;
}

int RowsFix::pack_restart(int i, double *buf)
{
  record(i);
  buf[0] = maxsize_restart();
  pack_exchange(i, buf + 1);
  return maxsize_restart();
}

void RowsFix::unpack_restart(int i, int nth)
{
  double *extra = atom->extra[i];
  int m = 0;
  for (int k = 0; k < nth; k++) m += static_cast<int>(extra[m]);
  if (restored() && static_cast<int>(extra[m]) == maxsize_restart())
    unpack_exchange(i, extra + m + 1);
  else
    set_arrays(i);
}

double RowsFix::memory_usage()
{
  double bytes = 0.0;
  for (const RowsOfAtoms *rows : kept) bytes += rows->bytes();
  return bytes;
}

}    // namespace StokesDyn
