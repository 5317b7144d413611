/* SPDX-License-Identifier: MIT
 * The arm of a signature file, from C: forward and inverse kinematics with gravity and joint error
 * maps, its uncertainty, and what a closed controller must be given so that the arm arrives.
 *
 * Units are metres and radians. A pose is seven numbers: x, y, z, and a quaternion w, x, y, z of
 * length 1. Poses are of the tool in the base: the base of the nominal model, laid over the
 * identified axes. `tool` is the tool on the flange, or NULL for the flange. Readings are what the
 * encoders show, one a joint.
 *
 * armsig_load() allocates, armsig_free() releases; nothing else allocates. Any number of threads
 * may use one arm at once. No function throws.
 */
#ifndef ARMSIG_H
#define ARMSIG_H

#include <stddef.h>

/* NOLINTBEGIN(readability-identifier-naming, modernize-use-using): the names and types of C */

#ifdef __cplusplus
extern "C" {
#endif

enum { ARMSIG_POSE = 7, ARMSIG_MAX_JOINTS = 8, ARMSIG_MAX_SOLUTIONS = 16 };

typedef enum armsig_status {
  ARMSIG_OK = 0,
  ARMSIG_SINGULAR = 1,       /* answered, near a singularity */
  ARMSIG_OUT_OF_REACH = 2,   /* no readings bring the tool there */
  ARMSIG_JOINT_LIMIT = 3,    /* a joint limit is in the way */
  ARMSIG_CONFIGURATION = 4,  /* in another configuration only */
  ARMSIG_NOT_FINITE = 5,     /* a number is not finite, or no quaternion of length 1 */
  ARMSIG_NO_UNCERTAINTY = 6, /* the signature has none, or no such target */
  ARMSIG_NO_ROOM = 7,        /* the caller's buffer is too small */
  ARMSIG_TOO_LARGE = 8       /* a correction of more than 20 mm: another arm, base or tool */
} armsig_status;

typedef struct armsig_arm armsig_arm;

/* Reads a signature file. NULL where it can't, with the reason in `problem` (always terminated;
 * may be NULL where `size` is 0). `nominal_model`: an arm description that the closed controller
 * computes with, or NULL for that of the signature. */
armsig_arm *armsig_load(const char *path, const char *nominal_model, char *problem, size_t size);
void armsig_free(armsig_arm *arm);

size_t armsig_joint_count(const armsig_arm *arm);
/* Its words, in English. */
const char *armsig_words(armsig_status status);

/* Where the tool is at `readings`: by the real arm, and by the nominal model. */
armsig_status armsig_forward(const armsig_arm *arm, const double *readings, const double *tool,
                             double *pose);
armsig_status armsig_nominal_forward(const armsig_arm *arm, const double *readings,
                                     const double *tool, double *pose);

/* The readings near `seed` at which the tool is at `pose`. */
armsig_status armsig_inverse(const armsig_arm *arm, const double *pose, const double *tool,
                             const double *seed, double *readings);

/* All readings at which it is, one after the other, inside the limits. `capacity`: solutions that
 * `readings` has room for; *count: how many there are. */
armsig_status armsig_solutions(const armsig_arm *arm, const double *pose, const double *tool,
                               double *readings, size_t capacity, size_t *count);

/* The pose to give a closed controller, so that the real tool arrives at `pose`. `seed`: readings
 * near those where the controller goes; it says the configuration. `readings`: where the arm goes,
 * or NULL. */
armsig_status armsig_compensate(const armsig_arm *arm, const double *pose, const double *tool,
                                const double *seed, double *corrected, double *readings);

/* 1 sigma along x, y, z of the sensor's frame of target `target`'s position at `readings`. */
armsig_status armsig_sigma(const armsig_arm *arm, const double *readings, int target,
                           double *sigma_m);

/* The same for `count` rows, one after the other, with one tool. A row without an answer is NaN.
 * `statuses`: one a row, or NULL. They return how many rows have an answer. */
size_t armsig_forward_rows(const armsig_arm *arm, size_t count, const double *readings,
                           const double *tool, double *poses, armsig_status *statuses);
size_t armsig_nominal_forward_rows(const armsig_arm *arm, size_t count, const double *readings,
                                   const double *tool, double *poses, armsig_status *statuses);
size_t armsig_inverse_rows(const armsig_arm *arm, size_t count, const double *poses,
                           const double *tool, const double *seeds, double *readings,
                           armsig_status *statuses);
size_t armsig_compensate_rows(const armsig_arm *arm, size_t count, const double *poses,
                              const double *tool, const double *seeds, double *corrected,
                              armsig_status *statuses);
size_t armsig_sigma_rows(const armsig_arm *arm, size_t count, const double *readings, int target,
                         double *sigma_m, armsig_status *statuses);

/* The base in the frame of the sensor that the signature was measured by, and the last link's
 * frame, which `armsig predict` answers for, on the flange. */
void armsig_base_in_sensor(const armsig_arm *arm, double *pose);
void armsig_last_link_on_flange(const armsig_arm *arm, double *pose);

#ifdef __cplusplus
}
#endif

/* NOLINTEND(readability-identifier-naming, modernize-use-using) */

#endif
