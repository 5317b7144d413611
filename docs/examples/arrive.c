/* SPDX-License-Identifier: MIT
 * What a closed controller must be given so that the tool arrives: the signature's file, from C. */
#include <armsig.h>
#include <stdio.h>

int main(int count, char **files) {
  /* guide: begin */
  char problem[256];
  const double q[6] = {0.2, -1.2, 1.0, 0.3, 0.9, -0.5};
  double target[ARMSIG_POSE], told[ARMSIG_POSE];
  armsig_arm *arm = armsig_load(count > 1 ? files[1] : "signature.yaml", NULL, problem, sizeof problem);
  if (arm == NULL) return fprintf(stderr, "%s\n", problem), 1;
  if (armsig_forward(arm, q, NULL, target) != ARMSIG_OK) return 1;
  if (armsig_compensate(arm, target, NULL, q, told, NULL) != ARMSIG_OK) return 1;
  printf("x %.3f mm, instead of %.3f mm\n", 1e3 * told[0], 1e3 * target[0]);
  armsig_free(arm);
  /* guide: end */
  return 0;
}
