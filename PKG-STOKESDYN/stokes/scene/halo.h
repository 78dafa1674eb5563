/* Spheres that are near those of this rank, or near a block of space that it asks about: of other
 * ranks, and periodic images, also of its own.
 *
 * They are found from where the rows of the ranks stand, and not among LAMMPS's ghosts: a long
 * reach needs no comm_modify and costs other styles nothing, any decomposition will do, and the
 * reach may change in any step. All ranks tell each other the blocks that their rows fill; after
 * that a rank speaks only with those whose blocks, wider by the reach, meet its own. */
#ifndef SD_HALO_H
#define SD_HALO_H

#include "lattice.h"
#include "ranks.h"

#include "sd_lattice.h"
#include "sd_world.h"

#include <initializer_list>
#include <vector>

namespace StokesDyn {

class Halo {
 public:
  explicit Halo(MPI_Comm world) : post(world) {}

  /* Whom a rank gets. OTHERS: all spheres of other ranks and all images. ABOVE: of two that may see each
   * other across a border one side alone gets the other one, which is above it: beyond an upper face of the
   * box, or else on a higher rank. ALL: as OTHERS, and its own. */
  enum Whom { OTHERS, ABOVE, ALL };

  /* Copies of spheres within `reach` of the smallest parallelepiped, with faces as the lattice has
   * them, that holds this rank's rows x [3n]; they are there when extend() has brought them. On all ranks
   * together. false: more copies of this rank's spheres than 1e7 and than 1000 for each. */
  bool find(const Lattice &lattice, double reach, const std::vector<double> &x, Whom whom = OTHERS);
  /* The same, or the copies found before, in their order, as long as they hold: the lattice and `whom` are
   * the same, there are as many rows, and none stands farther than half a skin (sd_skin.h) from where it
   * stood then */
  bool find_or_keep(const Lattice &lattice, double reach, const std::vector<double> &x, Whom whom = OTHERS);
  /* The same within `reach` of what is from lo [3] to hi [3], other on each rank and nothing where
   * lo > hi; this rank's own spheres are among them. They are there at once. */
  bool find_around(const Lattice &lattice, double reach, const std::vector<double> &x,
                   const double lo[3], const double hi[3]);
  void clear();
  int count() const { return copies; }
  /* Since then, in one order: rows [width n] -> those of the copies [width count()] */
  void refresh(const double *rows, double *out, int width) const;
  /* And back: rows += those of their copies */
  void reduce(const double *of_copies, double *rows, int width) const;
  /* Positions x [3n] -> where the copies stand now; h: the lattice's edges now. Or of zeros and the
   * rates of the edges: the velocities of the copies beyond those of their spheres. x nullptr:
   * zeros */
  void place(const double h[6], const double *x, double *out) const;

  /* Behind the rows of x and the columns, those of the copies, in one message to each partner */
  void extend(const double h[6], std::vector<double> &x,
              std::initializer_list<std::vector<double> *> columns);

  /* Of the copies, 1: it would be there as one ABOVE, 0: as one of OTHERS alone */
  std::vector<double> above() const;

  /* The other ranks as the core asks them, of these rows and copies; as long as this halo stands here */
  sd_world ranks() const;

  /* The same for rows of which each sphere has as many as it likes, first [rows + copies + 1] where those of
   * each begin; for refresh and reduce alone */
  Halo refined(const std::vector<int> &first) const;

  double memory_usage() const;

 private:
  Post post;
  int copies = 0;
  /* the spheres of this rank that go, partner by partner, and by how many edges each is moved */
  std::vector<int> sphere, edges;
  mutable std::vector<double> outbox;
  /* of copies that may be kept: within which reach they were found, 0: they may not; which, in which lattice,
   * and where the rows of this rank stood */
  double reached = 0.0;
  Whom whom_then = OTHERS;
  Lattice lattice_then = {};
  std::vector<double> stood;

  /* the smallest parallelepiped that holds something: lower and upper faces, in units of the edges */
  struct Block {
    double face[6];
  };
  static Block around(const Lattice &lattice, const std::vector<double> &x, std::vector<double> &f);
  bool find(const Lattice &lattice, double reach, const Block &rows, const Block &wanted,
            const std::vector<double> &f, Whom whom);
  bool holds(const Lattice &lattice, double reach, const std::vector<double> &x, Whom whom) const;
  void tell(const int *to, int *from) const;
  void put_place(const double h[6], const double *x, size_t k, double *out) const;
  bool send_to(int p, const Lattice &lattice, const std::vector<double> &f, const double from[6],
               const double into[6], Whom whom);
};

}    // namespace StokesDyn
#endif
