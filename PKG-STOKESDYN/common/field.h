/* A keyword's value that is a number or a variable "v_name": equal style (one value a step) or atom
 * style (one value an atom). */
#ifndef SD_FIELD_H
#define SD_FIELD_H

#include "keywords.h"

namespace StokesDyn {

class Field {
 public:
  Field() = default;
  explicit Field(double number) : value(number) {}

  /* The next word of a keyword, ONE_FOR_ALL: no variable of atom style. */
  enum Kind { ANY, ONE_FOR_ALL };
  static Field parse(Keywords &in, Kind kind = ANY);

  bool is_variable() const { return !name.empty(); }
  bool is_atom_style() const { return atom_style; }
  /* Of a plain number, or the last value of an equal-style variable. */
  double number() const { return value; }
  double *address() { return &value; }

  /* Find the variable. Errors, which name command and keyword: it is missing, or of another style. */
  void init(LAMMPS_NS::LAMMPS *lmp);
  /* out[stride * i] for every atom i that this rank owns; of an atom-style variable, 0 for atoms
   * outside the group. nullptr, if not of atom style: only number() is brought up to date. Errors: the
   * variable has gone, or has another style, since init(). */
  void evaluate(LAMMPS_NS::LAMMPS *lmp, int igroup, double *out, int stride);
  /* Of a number or an equal-style variable. */
  double evaluate(LAMMPS_NS::LAMMPS *lmp);

 private:
  double value = 0.0;
  std::string name, keyword;
  Kind kind = ANY;
  bool atom_style = false;

  /* LAMMPS's index of the variable. Errors as init(); of_run: or it is of another style than then. */
  int index(LAMMPS_NS::LAMMPS *lmp) const;
  int index_of_run(LAMMPS_NS::LAMMPS *lmp) const;
};

}    // namespace StokesDyn
#endif
