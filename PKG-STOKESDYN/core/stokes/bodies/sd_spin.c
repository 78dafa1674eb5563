#include "sd_spin.h"

#include "sd_linear.h"

double sd_spin_overload(const sd_spin_field *field, double now, const double W[3], const double by_fluid[3],
                        const double others[3])
{
  double needed[3];
  for (int d = 0; d < 3; d++) needed[d] = -by_fluid[d] - others[d];
  if (field->most == 0.0) return 0.0;
  if (now == 0.0 && sd_dot(needed, needed) > field->most * field->most)
    return sd_dot(needed, field->axis) < 0.0 ? -1.0 : 1.0;
  return now * (sd_dot(W, field->axis) - sd_dot(field->omega, field->axis)) >= 0.0 ? 0.0 : now;
}
