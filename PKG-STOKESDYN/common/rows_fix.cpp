#include "rows_fix.h"

#include "atom.h"
#include "comm.h"
#include "update.h"

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <new>

using namespace LAMMPS_NS;

namespace StokesDyn {

/* The numbers move, not the rows, so that sorted atoms have sorted rows. */
void RowsOfAtoms::copy(int i, int j)
{
  if (has(i))
    std::copy_n((*this)[i], width, writable(j));
  else
    erase(j);
}

int RowsOfAtoms::pack(int i, double *buffer) const
{
  buffer[0] = has(i);
  if (!has(i)) return 1;
  std::copy_n((*this)[i], width, buffer + 1);
  return 1 + width;
}

int RowsOfAtoms::unpack(int i, const double *buffer)
{
  if (buffer[0] == 0.0) {
    erase(i);
    return 1;
  }
  std::copy_n(buffer + 1, width, writable(i));
  return 1 + width;
}

double *AtomRows::writable(int i)
{
  if (has(i)) return rows[i];
  if (spare.empty()) {
    blocks.emplace_back(new double[(size_t) width * ROWS_OF_A_BLOCK]);
    for (int k = ROWS_OF_A_BLOCK - 1; k >= 0; k--)    // so that they are given in order of memory
      spare.push_back(blocks.back().get() + (size_t) width * k);
  }
  rows[i] = spare.back();
  spare.pop_back();
  std::fill_n(rows[i], width, 0.0);
  return rows[i];
}

void AtomRows::erase(int i)
{
  if (!has(i)) return;
  spare.push_back(rows[i]);
  rows[i] = nothing.data();
}

void AtomRows::clear()
{
  std::fill(rows.begin(), rows.end(), nothing.data());
  blocks.clear();
  spare.clear();
}

double AtomRows::bytes() const
{
  return sizeof(double *) * ((double) rows.capacity() + spare.capacity()) +
      sizeof(double) * (double) blocks.size() * width * ROWS_OF_A_BLOCK;
}

void AtomArray::erase(int i)
{
  if (written[i]) std::fill_n(rows[i], width, 0.0);
  written[i] = 0;
}

void AtomArray::grow(int nmax)
{
  std::unique_ptr<double[], Free> larger((double *) calloc((size_t) width * nmax + 1, sizeof(double)));
  if (!larger) throw std::bad_alloc();
  for (size_t i = 0; i < rows.size(); i++)
    if (written[i]) std::copy_n(rows[i], width, &larger[width * i]);
  block.swap(larger);
  rows.resize(nmax);
  written.resize(nmax, 0);
  for (size_t i = 0; i < rows.size(); i++) rows[i] = &block[width * i];
}

// --- the fix ---------------------------------------------------------------------------------

void RowsFix::keep(const std::vector<RowsOfAtoms *> &all, AtomArray *output, bool restarts,
                   Borders borders, const std::vector<RowsOfAtoms *> &moving)
{
  kept = all;
  in_files = all.size();
  kept.insert(kept.end(), moving.begin(), moving.end());
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
  wanted = {Atom::GROW};
  if (restarts) wanted.push_back(Atom::RESTART);
  if (borders == WITH_BORDERS) wanted.push_back(Atom::BORDER);
}

void RowsFix::listen()
{
  for (int kind : wanted) atom->add_callback(kind);
  added.swap(wanted);
}

RowsFix::~RowsFix()
{
  for (int kind : added) atom->delete_callback(id, kind);
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
  for (RowsOfAtoms *rows : kept) rows->erase(i);
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

bool RowsFix::within_run() const
{
  return update->whichflag == 1;
}

/* Size, atom ID, rows. All atoms take as much as the longest, so that the file tells whether it is of this kind. */
int RowsFix::maxsize_restart()
{
  int size = 2;
  for (size_t k = 0; k < in_files; k++) size += kept[k]->most_packed();
  return size;
}

int RowsFix::pack_restart(int i, double *buf)
{
  if (within_run()) record(i);
  const int64_t id = atom->tag[i];
  buf[0] = maxsize_restart();
  memcpy(buf + 1, &id, sizeof(id));
  for (size_t k = 0, m = 2; k < in_files; k++) m += kept[k]->pack(i, buf + m);
  return maxsize_restart();
}

/* LAMMPS's delete_atoms moves atoms, and leaves what the file says of them where it was. */
void RowsFix::unpack_restart(int i, int nth)
{
  const double *row = atom->extra[i];
  for (int k = 0; k < nth; k++) row += static_cast<int>(*row);
  const int size = static_cast<int>(*row), whole = maxsize_restart();
  const bool without_id = size == whole - 1;    // of a former version
  if (!restored() || (size != whole && !without_id)) return set_arrays(i);
  int64_t id = atom->tag[i];
  if (!without_id) memcpy(&id, row + 1, sizeof(id));
  if (id != atom->tag[i]) return another_in_file(i);
  row += without_id ? 1 : 2;
  for (size_t k = 0; k < in_files; k++) row += kept[k]->unpack(i, row);
}

void RowsFix::another_in_file(int i)
{
  voice.fail_one("atom " + std::to_string(atom->tag[i]) + " stands where the restart file has another one: give "
                 "this fix before delete_atoms");
}

void RowsFix::write_restart(FILE *fp)
{
  NamedState state(style);
  write_state(state);
  state.put(world, saved());
  if (comm->me == 0) state.write(fp);
}

void RowsFix::restart(char *buffer)
{
  NamedState state(style);
  if (!state.read(lmp, buffer)) return;
  state.get(world, saved());
  read_state(state);
}

double RowsFix::memory_usage()
{
  double bytes = 0.0;
  for (const RowsOfAtoms *rows : kept) bytes += rows->bytes();
  return bytes;
}

}    // namespace StokesDyn
