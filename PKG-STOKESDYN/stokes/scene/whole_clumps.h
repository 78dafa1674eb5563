/* Every clump on one rank: that which has its sphere of lowest tag. Rows go from the atoms, wherever
 * LAMMPS keeps them, to the members of the clumps that this rank owns, and back; what is said of a
 * clump is said once, and no ghosts are asked.
 *
 * Members stand side by side: each is the image closest to the first of its clump, moved by whole
 * edges of the box. In a box that shears with the fluid such an image moves otherwise than its atom,
 * by these edges times the jump of the fluid velocity across an edge: Ambient::jumps. */
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
  /* The atom of a clump's first member, its lowest tag: it is on this rank */
  int first_atom(const Clump &clump) const { return atom_of[clump.begin]; }

  /* Finds them if LAMMPS has re-neighboured, and where the members stand now: x [3 size()], and by how many
   * edges each has been moved; with the box of now, which is kept. On all ranks together. Error: a
   * clump wider than half the periodic box. */
  void find();
  std::vector<double> x;
  std::vector<int> edges;
  double h[6] = {0.0};

  /* Rows of numbers from atoms to members: row(i, out) writes what goes of atom i, over zeros, to where
   * room(m) says for member m, nullptr: nobody wants it. That of an atom that is here stays here. On all
   * ranks together, as what follows. */
  template <class Row, class Room> void gather_to(int width, const Row &row, const Room &room) const
  {
    bring(width, row);
    for (size_t m = 0; m < atom_of.size(); m++) {
      double *out = room(m);
      if (out && atom_of[m] < 0)
        std::copy_n(&inbox[(size_t) width * ~atom_of[m]], width, out);
      else if (out)
        row(atom_of[m], out);
    }
  }
  /* The same as rows [width members], at least one */
  template <class Row> std::vector<double> gather(int width, const Row &row) const
  {
    std::vector<double> rows((size_t) width * (atom_of.size() + 1));
    gather_to(width, row, [&](size_t m) { return &rows[width * m]; });
    return rows;
  }
  /* The same where nobody keeps the rows: take(m, row) has one after the other */
  template <int WIDTH, class Row, class Take> void gather(const Row &row, const Take &take) const
  {
    bring(WIDTH, row);
    for (size_t m = 0; m < atom_of.size(); m++) {
      double here[WIDTH] = {0.0};
      if (atom_of[m] >= 0) row(atom_of[m], here);
      take(m, atom_of[m] >= 0 ? here : &inbox[(size_t) WIDTH * ~atom_of[m]]);
    }
  }
  /* And back: all(give) calls give(m, row) for members that have one, and take(i, row) is called for
   * their atoms, wherever these are. */
  template <class All, class Take> void scatter(int width, const All &all, const Take &take) const
  {
    const size_t w = (size_t) width + 1;    // behind each row: is it one?
    inbox.assign(w * post.rows_in() + 1, 0.0);
    outbox.resize(w * away.size() + 1);
    all([&](size_t m, const double *row) {
      if (atom_of[m] >= 0) return (void) take(atom_of[m], row);
      double *out = &inbox[w * ~atom_of[m]];
      std::copy_n(row, width, out);
      out[width] = 1.0;
    });
    post.reversed().carry(inbox.data(), outbox.data(), (int) w);
    for (size_t k = 0; k < away.size(); k++)
      if (outbox[w * k + width] != 0.0) take(away[k], &outbox[w * k]);
  }

  double memory_usage() const;

 private:
  const Voice voice;
  Epochs &epochs;
  Stamp found;
  Post post;
  /* atoms of this rank in clumps of its partners, one partner after the other */
  std::vector<int> away;
  /* [members] its atom, which is here; or ~k, when it is row k of those that come */
  std::vector<int> atom_of;
  mutable std::vector<double> outbox, inbox;

  /* Rows of atoms of this rank to members elsewhere; in inbox those that come */
  template <class Row> void bring(int width, const Row &row) const
  {
    outbox.assign((size_t) width * away.size() + 1, 0.0);
    inbox.resize((size_t) width * post.rows_in() + 1);
    for (size_t k = 0; k < away.size(); k++) row(away[k], &outbox[width * k]);
    post.carry(outbox.data(), inbox.data(), width);
  }

  std::vector<int> owners(const std::vector<int> &bound) const;
  void route(const std::vector<int> &bound);
  void arrange();
  void stand();
  void check_widths() const;
};

}    // namespace StokesDyn
#endif
