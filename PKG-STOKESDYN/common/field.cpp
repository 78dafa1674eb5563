#include "field.h"

#include "atom.h"
#include "input.h"
#include "variable.h"

#include <cmath>

using namespace LAMMPS_NS;

namespace StokesDyn {

Field Field::parse(Keywords &in)
{
  Field field;
  if (in.more() && in.peek().compare(0, 2, "v_") == 0) {
    field.name = in.word().substr(2);
    if (field.name.empty()) in.refuse("'v_' lacks the name of a variable");
  } else
    field.value = in.number();
  return field;
}

void Field::init(LAMMPS *lmp, const std::string &what)
{
  if (!is_variable()) return;
  Variable *variable = lmp->input->variable;
  // find() takes char * in older versions
  const int i = variable->find(const_cast<char *>(name.c_str()));
  if (i < 0) fail(lmp, what + ": variable '" + name + "' does not exist");
  atom_style = variable->atomstyle(i);
  if (!atom_style && !variable->equalstyle(i))
    fail(lmp, what + ": variable '" + name + "' is neither equal nor atom style");
}

void Field::evaluate(LAMMPS *lmp, int igroup, double *out, int stride)
{
  const int nlocal = lmp->atom->nlocal;
  if (is_variable()) {
    Variable *variable = lmp->input->variable;
    const int i = variable->find(const_cast<char *>(name.c_str()));
    if (atom_style) {
      variable->compute_atom(i, igroup, out, stride, 0);
      return;
    }
    value = variable->compute_equal(i);
  }
  if (out)
    for (int i = 0; i < nlocal; i++) out[(long) stride * i] = value;
}

double Field::evaluate(LAMMPS *lmp)
{
  if (is_variable())
    value = lmp->input->variable->compute_equal(
        lmp->input->variable->find(const_cast<char *>(name.c_str())));
  return value;
}

}    // namespace StokesDyn
