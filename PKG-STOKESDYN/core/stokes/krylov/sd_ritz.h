/* Ritz values: what conjugate gradients know of the eigenvalues of their matrix. */
#ifndef SD_RITZ_H
#define SD_RITZ_H

#ifdef __cplusplus
extern "C" {
#endif

/* Step lengths alpha_k and beta_k, from direction k to k + 1, of the first iterations. Beyond
 * SD_RITZ_KEPT of them the extreme values hardly change. */
enum { SD_RITZ_KEPT = 128 };
typedef struct {
  int count;
  double alpha[SD_RITZ_KEPT], beta[SD_RITZ_KEPT];
} sd_ritz;

void sd_ritz_add(sd_ritz *r, double alpha, double beta);

/* Smallest and largest Ritz value, to six digits of the largest; both 0 without an iteration. They
 * lie within the spectrum of the (preconditioned) matrix, and near its ends once these show. */
void sd_ritz_extremes(const sd_ritz *r, double *smallest, double *largest);

#ifdef __cplusplus
}
#endif
#endif
