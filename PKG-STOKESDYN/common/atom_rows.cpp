#include "atom_rows.h"

#include <algorithm>
#include <new>

namespace StokesDyn {

/* The numbers move, not the rows, so that sorted atoms have sorted rows. */
void RowsOfAtoms::copy(int i, int j)
{
  if (has(i))
    std::copy_n((*this)[i], width, give(j));
  else
    take(j);
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
    take(i);
    return 1;
  }
  std::copy_n(buffer + 1, width, give(i));
  return 1 + width;
}

double *AtomRows::give(int i)
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

void AtomRows::take(int i)
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

double *AtomArray::give(int i)
{
  written[i] = 1;
  return rows[i];
}

void AtomArray::take(int i)
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

}    // namespace StokesDyn
