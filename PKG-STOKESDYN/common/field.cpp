#include "field.h"

#include "atom.h"
#include "input.h"
#include "variable.h"

using namespace LAMMPS_NS;

namespace StokesDyn {

Field Field::parse(Keywords &in, Kind kind)
{
  Field field;
  field.kind = kind;
  field.keyword = in.present();
  if (in.more() && in.peek().compare(0, 2, "v_") == 0) {
    field.name = in.word().substr(2);
    if (field.name.empty()) in.refuse("'v_' lacks the name of a variable");
  } else
    field.value = in.number();
  return field;
}

int Field::index(LAMMPS *lmp) const
{
  return lmp->input->variable->find(const_cast<char *>(name.c_str()));    // char * in older versions
}

void Field::init(LAMMPS *lmp)
{
  if (!is_variable()) return;
  Variable *variable = lmp->input->variable;
  const int i = index(lmp);
  const Voice what(lmp, keyword);
  if (i < 0) what.fail("variable '" + name + "' does not exist");
  atom_style = variable->atomstyle(i);
  if (!atom_style && !variable->equalstyle(i))
    what.fail("variable '" + name + "' is neither equal nor atom style");
  if (atom_style && kind == ONE_FOR_ALL)
    what.fail("the variable must be of equal style: one value for all");
}

double Field::evaluate(LAMMPS *lmp)
{
  if (is_variable()) value = lmp->input->variable->compute_equal(index(lmp));
  return value;
}

void Field::evaluate(LAMMPS *lmp, int igroup, double *out, int stride)
{
  if (is_atom_style()) {
    lmp->input->variable->compute_atom(index(lmp), igroup, out, stride, 0);
    return;
  }
  evaluate(lmp);
  if (out)
    for (int i = 0; i < lmp->atom->nlocal; i++) out[(long) stride * i] = value;
}

}    // namespace StokesDyn
