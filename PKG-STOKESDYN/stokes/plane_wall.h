/* The plane of keyword wall: where it stands, and what does not go with it. Free functions, each
 * called with the name of the command that the user is told. */
#ifndef SD_PLANE_WALL_H
#define SD_PLANE_WALL_H

#include "ambient.h"
#include "scene.h"

#include <string>

namespace StokesDyn {

/* "zlo at 0.5", as a user would say it */
std::string wall_name(const sd_wall &wall);

/* Before a run: puts a wall at the side of the box where that is now. Errors: a periodic direction;
 * a side that moves or leans. */
void find_wall(const Voice &voice, Scene::Settings &settings);

/* The stream must rest where the wall is. Error: a number for its velocity across the wall; warning:
 * numbers along it. */
void check_stream_at_wall(const Voice &voice, const sd_wall &wall,
                          const Ambient::Settings &fluid);

/* Where the rows of the scene stand. Errors: the side of the box has left the wall; a centre that is
 * not in front of it. Returns how many spheres cut it, on all ranks. */
double spheres_cut_by_wall(const Voice &voice, const Scene &scene);

}    // namespace StokesDyn
#endif
