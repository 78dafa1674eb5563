/* Every clump on one rank: that which has its sphere of lowest tag. Rows go from the atoms, wherever
 * LAMMPS keeps them, to the members of the clumps that this rank owns, and back; what is said of a
 * clump is said once, and no ghosts are asked.
 *
 * Members stand side by side: each is the image closest to the first of its clump, moved by whole
 * edges of the box. In a box that shears with the fluid such an image moves otherwise than its atom,
 * by the steps times the jump of the fluid velocity across an edge: Ambient::jumps. */
#ifndef SD_WHOLE_CLUMPS_H
#define SD_WHOLE_CLUMPS_H

#include "epochs.h"
#include "keywords.h"
#include "pointers.h"
#include "ranks.h"

#include <cstdint>
#include <vector>

namespace StokesDyn {

class WholeClumps : protected LAMMPS_NS::Pointers {
 public:
  WholeClumps(const Voice &voice, Epochs &epochs);

  /* Those that this rank owns, in order of molecule ID; lone spheres (molecule 0) are none. */
  struct Clump {
    int64_t molecule;
    int begin, end;    // its members, in order of tag
  };
  std::vector<Clump> clumps;
  std::vector<int64_t> tag;    // of each member
  int size() const { return (int) tag.size(); }

  /* Finds them if LAMMPS has re-neighboured, and where the members stand now: x [3 size()], and by how many
   * edges each has been moved; with the box of now, which is kept. On all ranks together. Error: a
   * clump wider than half the periodic box. */
  void find();
  std::vector<double> x;
  std::vector<int> steps;
  double h[6] = {0.0};

  /* Rows [width size()], at least one: row(i, out) writes what goes of atom i. On all ranks together,
   * as scatter(), where take(i, row) is called for every atom of this rank that is in a clump. */
  template <class Row> std::vector<double> gather(int width, const Row &row) const
  {
    outbox.assign((size_t) width * away.size() + 1, 0.0);
    inbox.assign((size_t) width * (at_home.size() + post.rows_in()) + 1, 0.0);
    for (size_t k = 0; k < away.size(); k++) row(away[k], &outbox[width * k]);
    for (size_t k = 0; k < at_home.size(); k++) row(at_home[k], &inbox[width * k]);
    post.carry(outbox.data(), &inbox[width * at_home.size()], width);
    std::vector<double> rows((size_t) width * slot.size() + width);
    for (size_t k = 0; k < slot.size(); k++)
      std::copy_n(&inbox[width * (size_t) slot[k]], width, &rows[width * k]);
    return rows;
  }
  template <class Take> void scatter(int width, const double *rows, const Take &take) const
  {
    outbox.resize((size_t) width * away.size() + 1);
    inbox.resize((size_t) width * (at_home.size() + post.rows_in()) + 1);
    for (size_t k = 0; k < slot.size(); k++)
      std::copy_n(rows + width * k, width, &inbox[width * (size_t) slot[k]]);
    post.reversed().carry(&inbox[width * at_home.size()], outbox.data(), width);
    for (size_t k = 0; k < at_home.size(); k++) take(at_home[k], &inbox[width * k]);
    for (size_t k = 0; k < away.size(); k++) take(away[k], &outbox[width * k]);
  }

  double memory_usage() const;

 private:
  const Voice voice;
  Epochs &epochs;
  Since found;
  Post post;
  /* atoms of this rank in its own clumps, and in those of its partners, one after the other */
  std::vector<int> at_home, away;
  /* [members] place among at_home and, after them, the rows that come */
  std::vector<int> slot;
  mutable std::vector<double> outbox, inbox;

  std::vector<int> owners(const std::vector<int> &bound) const;
  void route(const std::vector<int> &bound);
  void arrange();
  void stand();
  void check_widths() const;
};

}    // namespace StokesDyn
#endif
