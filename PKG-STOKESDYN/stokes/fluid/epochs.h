/* Since when things are as they are. Whatever is derived from something keeps the epoch that this
 * had then (Stamp), and is made anew when it finds a later one: so nobody has to tell anybody that
 * what he has is out of date.
 *
 * Each epoch is advanced in the one place that is named. No two are alike, not those of another
 * pair style either. */
#ifndef SD_EPOCHS_H
#define SD_EPOCHS_H

namespace StokesDyn {

class Epoch {
 public:
  void advance() { number = ++latest; }

 private:
  friend class Stamp;
  inline static long latest = 0;
  long number = ++latest;
};

/* The epoch in which something was made, looked at or said; none in the beginning. */
class Stamp {
 public:
  bool is(const Epoch &now) const { return number == now.number; }
  void set(const Epoch &now) { number = now.number; }
  void never() { number = 0; }
  /* Was it another one until now? */
  bool first_in(const Epoch &now)
  {
    const bool first = !is(now);
    set(now);
    return first;
  }

 private:
  long number = 0;
};

struct Epochs {
  /* other settings, or a run that LAMMPS prepares: what is looked at or said once in each
   * (Hydrodynamics::set, init) */
  Epoch run;
  /* that, or LAMMPS has re-neighboured: atoms have come, gone, or other indices
   * (Hydrodynamics::begin) */
  Epoch lists;
  /* that, or a run begins, also with 'pre no': groups may have other atoms (as before) */
  Epoch groups;
  /* a step: where all stand and how they move, the fluid, the forces (as before) */
  Epoch step;
  /* who takes part, at which index (Ambient::select) */
  Epoch selection;
  /* the clumps of this rank and the order of their members (WholeClumps::find) */
  Epoch members;
  /* whose the rows of the scene are, on any rank (Scene::stand) */
  Epoch rows;
};

}    // namespace StokesDyn
#endif
