/* The problem of a step as the core solves it (sd_bodies.h): who belongs to whom, where the points stand,
 * and what is given. Bodies are lone spheres and rigid clumps; spheres are points, or shells of points
 * (keyword multiblob); near a wall each body is one with its image. Nobody else asks which.
 *
 *   place()      by spheres: what is given of them, and the fluid there
 *   assemble()   and as bodies, with the films between them
 *   rest_in()    where velocities are given: the same bodies in another slip */
#ifndef SD_BODY_SCENE_H
#define SD_BODY_SCENE_H

#include "callback.h"
#include "clump_poses.h"
#include "engine.h"
#include "lubrication.h"
#include "pointers.h"
#include "scene.h"
#include "shells.h"

#include "sd_bodies.h"
#include "sd_tie.h"

#include <deque>
#include <vector>

namespace StokesDyn {

class BodyScene : protected LAMMPS_NS::Pointers {
 public:
  BodyScene(const Voice &voice, const Scene &, Engine &, Shells &, const Ambient &, const ClumpPoses &,
            Lubrication &);

  /* The scene stands, and the clumps have been found. */
  void place();
  /* FILMS: those between the spheres where they stand, in the fluid of this step. NOISY_FILMS: the same, and
   * random forces will be drawn. STANDING_FILMS: those that stand_films() has left, with the arms of then */
  enum Films { NO_FILMS, FILMS, NOISY_FILMS, STANDING_FILMS };
  void assemble(Films films = NO_FILMS);
  /* Everybody rests in a fluid that moves with this slip [width spheres]; strained: and varies around each
   * sphere as the ambient one does. The bodies have been assembled. */
  void rest_in(const std::vector<double> &slip, bool strained = true);

  /* With shells of points: those of clumps turn with them. The rows of the scene stand. */
  void orient();

  /* Where velocities are given: is there more to it than points, each for itself? Shells of points, or
   * clumps with shells that interact */
  bool joined() const
  {
    return shells.on() || (rigid.on && !rigid.each_alone() && rigid.shell > 1);
  }

  /* By spheres, rows of the scene: loads; velocity of the fluid, where velocities are given less
   * that of the sphere; 6 pi eta a and 8 pi eta a^3 */
  std::vector<double> F, flow, resistance;

  /* The bodies, and the fluid at their points. velocities [6 bodies]: of those whose velocity is given;
   * empty: there are none, or all of them rest */
  sd_bodies bodies = {};
  std::vector<double> u, velocities;
  /* For noise: the bodies that have a shape, as if there were no wall */
  const std::vector<sd_body> &in_open_space() const { return slowed_by_wall() ? open : shaped; }
  /* Where the engine draws a part of its matrix at once (divides of sd_mobility.h): the bodies with the rest
   * of it. It stands as long as they do. */
  sd_bodies undrawn() const;
  /* The films where the scene stands now, before the points of the bodies go elsewhere */
  void stand_films();
  /* Is the factor of films (sd_tie.h) a matter of where lone spheres stand, and nothing else? Then it may be
   * that of other places [3 spheres], where films stand until they are back where the spheres do. */
  bool films_by_places() const;
  void films_at(const std::vector<double> &places)
  {
    lubrication.place_at(scene, places);
    tie.above = lubrication.those_above();
  }
  void films_back()
  {
    lubrication.place(scene, &ambient);
    tie.above = lubrication.those_above();
  }
  /* Those that stand, in a fluid at rest; random forces of them (Lubrication::draw) */
  void rest_films() { lubrication.place(scene, nullptr); }
  sd_status draw_films(const sd_random_key &key, double *forces) const
  {
    return lubrication.draw(scene, key, forces);
  }
  /* [3 spheres] from the centre of their body */
  const std::vector<double> &arms() const { return arm; }
  /* Those of clumps are the last ones */
  size_t first_clump() const { return sd_bodies_count(&bodies) - poses.clumps().size(); }

  double memory_usage() const;

 private:
  const Voice voice;
  const Scene &scene;
  Engine &engine;
  Shells &shells;
  const Ambient &ambient;
  const ClumpPoses &poses;
  const RigidClumps::Settings &rigid;
  const Given &given;
  Lubrication &lubrication;
  Owned<sd_tie, sd_tie_free> tie;

  /* for the core, by spheres, by points */
  std::vector<double> arm, film_arm, D;
  std::vector<int> member, whole, loner;
  std::vector<sd_body> shaped, open;
  /* [bodies] sd_body_known */
  std::vector<char> known;
  /* near a wall: blocks of the bodies where they stand */
  std::deque<Owned<sd_body_shape, sd_body_shape_free>> standing;
  /* with shells, by points: sphere, from its centre; by spheres: velocity of the fluid, its gradient,
   * and its second derivatives or nothing */
  std::vector<int> sphere;
  std::vector<double> r, velocity, slope, bend;
  sd_multiblob_additions of_points = {};
  sd_faces faces = {};
  std::vector<char> whole_shells;

  void tie_films(Films films);
  void arrange();
  void add_free(int row);
  void add(const ClumpPoses::Clump &clump);
  void find_arms(const ClumpPoses::Clump &clump, std::vector<double> &arms) const;
  void add_points(const sd_multiblob_shape &shape, const std::vector<int> &rows);
  const sd_multiblob_shape &points_of(const ClumpPoses::Clump &clump) const;
  /* near a wall no body moves by itself as it does in open space */
  bool slowed_by_wall() const { return scene.settings.boundary.walled() && scene.settings.rotation; }
  void stand_at_wall();
  sd_status stand_at_wall(sd_body &body, double count);
  std::vector<int> spheres_of(const sd_body &body) const;
  void put_together();
  void put_points();
  void find_known();
  void carry();
  void place_points();
  void flow_at_points(const double *velocity, int stride);
  void slip_at_points(const std::vector<double> &slip, bool strained);
  void slip_of_swimmers();
};

}    // namespace StokesDyn
#endif
