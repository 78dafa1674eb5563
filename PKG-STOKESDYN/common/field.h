/* A keyword's value that is a number or a variable "v_name": equal style (one value a step) or atom style (one value an atom). */
#ifndef SD_FIELD_H
#define SD_FIELD_H

#include "keywords.h"

namespace StokesDyn {

class Field {
 public:
  Field() = default;
  explicit Field(double number) : value(number) {}

  static Field parse(Keywords &in);    // the next word of a keyword

  bool is_variable() const { return !name.empty(); }
  bool is_atom_style() const { return atom_style; }
  double number() const
  {
    return value;
  }    // of a plain number, or the last value of an equal-style variable
  double *address() { return &value; }

  /* Find the variable; what: "Pair style x: keyword visc", for the error if it is missing or of another style. */
  void init(LAMMPS_NS::LAMMPS *lmp, const std::string &what);
  /* out[stride * i] for every atom i that this rank owns; of an atom-style variable, 0 for atoms outside the group. nullptr, if not of
   * atom style: only number() is brought up to date. */
  void evaluate(LAMMPS_NS::LAMMPS *lmp, int igroup, double *out, int stride);
  double evaluate(LAMMPS_NS::LAMMPS *lmp);    // of a number or an equal-style variable

 private:
  double value = 0.0;
  std::string name;
  bool atom_style = false;
};

}    // namespace StokesDyn
#endif
