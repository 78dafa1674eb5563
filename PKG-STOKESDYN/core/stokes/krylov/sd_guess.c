#include "sd_guess.h"

void sd_guess_perturbation(size_t n, const double *D, const double *s, const double *exerted, double *v)
{
  for (size_t j = 0; j < n; j++) v[j] = -exerted[j] / D[j] - s[j];
}

void sd_guess_exerted(size_t n, const double *D, const double *s, double *v)
{
  for (size_t j = 0; j < n; j++) v[j] = -(D[j] * (s[j] + v[j]));
}
