/* How two shells stand to each other: sets of orientations for means over all of them. */
#ifndef SD_SHELL_WAYS_H
#define SD_SHELL_WAYS_H

/* In the axes of shell 2: the orientation of shell 1, and the direction from 1 to 2 */
typedef struct {
  double Q[9], d[3];
} sd_shell_way;

/* Even over all rotations of both: out [count] */
void sd_shell_ways(int count, sd_shell_way *out);

/* Of shells that have the full symmetry of the icosahedron, its mirror planes as sd_shell.h has them: the
 * line of centres in one of 120 triangles of each shell, which is as evenly filled by 1/120 of the
 * orientations, and the turn of one about it against the other. 64 give means within 2e-3 of themselves,
 * as some 500 of those above do. */
void sd_shell_ways_of_icosahedra(int count, sd_shell_way *out);

#endif
