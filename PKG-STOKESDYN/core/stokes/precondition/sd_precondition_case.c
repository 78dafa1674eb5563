#include "sd_precondition_case.h"

/* Ranks that went different ways would wait for each other for ever: one failure is everybody's. */
sd_status sd_precondition_agree(const sd_precondition_case *c, sd_status mine)
{
  if (!c->sum) return mine;
  double failed = mine != SD_OK;
  const sd_status summed = c->sum(c->sum_ctx, &failed, 1);
  if (summed != SD_OK) return summed;
  return mine == SD_OK && failed > 0.0 ? SD_EINDEFINITE : mine;
}
