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
  Variable *variable = lmp->input->variable;
  const int i = variable->find(const_cast<char *>(name.c_str()));    // char * in older versions
  const Voice what(lmp, keyword);
  if (i < 0) what.fail("variable '" + name + "' does not exist");
  if (!variable->atomstyle(i) && !variable->equalstyle(i))
    what.fail("variable '" + name + "' is neither equal nor atom style");
  if (variable->atomstyle(i) && kind == ONE_FOR_ALL)
    what.fail("the variable must be of equal style: one value for all");
  return i;
}

void Field::init(LAMMPS *lmp)
{
  if (is_variable()) atom_style = lmp->input->variable->atomstyle(index(lmp));
}

/* Before a run with 'pre no', or among the commands of run ... every, it may have been deleted or made anew. */
int Field::index_of_run(LAMMPS *lmp) const
{
  const int i = index(lmp);
  if ((bool) lmp->input->variable->atomstyle(i) != atom_style)
    Voice(lmp, keyword).fail("variable '" + name + "' is of another style than when the run was prepared: give the "
                             "next run without 'pre no'");
  return i;
}

double Field::evaluate(LAMMPS *lmp)
{
  if (is_variable()) value = lmp->input->variable->compute_equal(index_of_run(lmp));
  return value;
}

void Field::evaluate(LAMMPS *lmp, int igroup, double *out, int stride)
{
  if (is_atom_style()) {
    lmp->input->variable->compute_atom(index_of_run(lmp), igroup, out, stride, 0);
    return;
  }
  evaluate(lmp);
  if (out)
    for (int i = 0; i < lmp->atom->nlocal; i++) out[(long) stride * i] = value;
}

}    // namespace StokesDyn
