#include "vans_settings.h"

#include "comm.h"

#include <cmath>
#include <cstdio>
#include <cstring>

#include <mpi.h>

using namespace LAMMPS_NS;

namespace StokesDyn {

static const double MOST_STEPS = 1e9;    // of one solve of the stream

std::vector<std::vector<double>> read_rows(LAMMPS *lmp, const std::string &what,
                                           const std::string &file)
{
  std::string text;
  int size = -1;
  if (lmp->comm->me == 0) {
    FILE *fp = fopen(file.c_str(), "r");
    if (fp) {
      char buffer[4096];
      size_t n;
      while ((n = fread(buffer, 1, sizeof(buffer), fp)) > 0) text.append(buffer, n);
      fclose(fp);
      size = (int) text.size();
    }
  }
  MPI_Bcast(&size, 1, MPI_INT, 0, lmp->world);
  if (size < 0) fail(lmp, what + ": cannot read file '" + file + "'");
  text.resize(size);
  MPI_Bcast(&text[0], size, MPI_CHAR, 0, lmp->world);

  std::vector<std::vector<double>> rows;
  int line_number = 0;
  for (size_t at = 0; at < text.size();) {
    size_t end = text.find('\n', at);
    if (end == std::string::npos) end = text.size();
    std::string line = text.substr(at, end - at);
    at = end + 1;
    line_number++;
    line = line.substr(0, line.find('#'));
    std::vector<double> row;
    for (size_t p = 0;;) {
      p = line.find_first_not_of(" \t\r,", p);
      if (p == std::string::npos) break;
      const size_t q = line.find_first_of(" \t\r,", p);
      const std::string word = line.substr(p, q == std::string::npos ? q : q - p);
      double value;
      if (!is_number(word, value) || !std::isfinite(value))
        fail(lmp,
             what + ": file '" + file + "', line " + std::to_string(line_number) + ": '" + word +
                 "' is not a finite number");
      row.push_back(value);
      if (q == std::string::npos) break;
      p = q;
    }
    if (!row.empty()) rows.push_back(row);
  }
  return rows;
}

static std::vector<double> read_list(LAMMPS *lmp, const std::string &what, const std::string &file,
                                     size_t expected, const std::string &count)
{
  std::vector<double> list;
  for (const auto &row : read_rows(lmp, what, file))
    list.insert(list.end(), row.begin(), row.end());
  if (expected && list.size() != expected)
    fail(lmp,
         what + ": file '" + file + "' has " + std::to_string(list.size()) + " values, " + count +
             " = " + std::to_string(expected) + " are needed");
  return list;
}

std::vector<double> read_profile(LAMMPS *lmp, const std::string &what, const std::string &file,
                                 int ncell)
{
  return read_list(lmp, what, file, ncell + 1, "ncell + 1");
}

static std::string file_name(Keywords &in)
{
  in.choice({"file"});
  return in.word();
}

void VansSettings::parse(LAMMPS *lmp, const std::vector<std::string> &args, size_t begin)
{
  const std::string command = COMMAND;
  const auto keyword = [&](const char *name) {
    return command + ": keyword " + name;
  };
  std::string mesh_file, profile_file, given_file, convective_file;
  bool have_mesh = false, have_fluid = false, have_gravity = false;
  bigint equal_cells = 0;

  Keywords in(lmp, command, args, begin);
  while (in.next()) {
    if (in.is("mesh")) {
      have_mesh = true;
      if (in.more() && in.peek() == "file")
        mesh_file = file_name(in);
      else {
        equal_cells = in.integer(2, 10000000);
        dz = in.positive();
        z_ref = in.number();
      }
    } else if (in.is("fluid")) {
      rho = in.positive();
      eta = in.positive();
      have_fluid = true;
    } else if (in.is("gravity")) {
      for (double &component : g) component = in.number();
      have_gravity = true;
    } else if (in.is("area"))
      area = in.positive();
    else if (in.is("couple"))
      couple = (decltype(couple)) in.choice({"none", "one", "two", "fluid"});
    else if (in.is("profile")) {
      profile_file.clear();
      if (in.more() && in.peek() == "zero")
        in.word();
      else
        profile_file = file_name(in);
    } else if (in.is("given")) {
      given_file.clear();
      if (in.more() && in.peek() == "averaged")
        in.word();
      else
        given_file = file_name(in);
    } else if (in.is("convective")) {
      convective_file.clear();
      if (in.more() && in.peek() == "off")
        in.word();
      else
        convective_file = file_name(in);
    } else if (in.is("solve")) {
      period = in.positive();
      dt = in.positive();
      if (dt > period * (1.0 + 1e-9))
        in.refuse("the step " + text(dt) + " is longer than the period " + text(period));
      if (!(period / dt <= MOST_STEPS))
        in.refuse("the step " + text(dt) + " is too short for the period " + text(period) +
                  ": more than " + text(MOST_STEPS) + " steps");
    } else if (in.is("stream"))
      rest = in.choice({"steady", "rest"}) == 1;
    else if (in.is("hindrance"))
      hindrance = in.number();
    else if (in.is("lift")) {
      if (in.more() && in.peek() == "off")
        in.word(), lift = 0.0;
      else
        lift = in.number();
    } else if (in.is("turbulence"))
      turbulence = (sd_vans_turbulence) in.choice(
          {"none", "kz", "parabolic", "li_sawamoto", "pore", "rousseau", "ni_capart", "pipe"});
    else if (in.is("kappa"))
      kappa = in.positive();
    else if (in.is("phi_max") || in.is("phi_bed")) {
      const double value = in.positive();
      if (value > 1.0) in.refuse("'" + text(value) + "' is a volume fraction and must be <= 1");
      (in.is("phi_max") ? phi_max : phi_bed) = value;
    } else if (in.is("bed_average"))
      bed_average = (int) in.integer(1, 1000000);
    else if (in.is("sublayer"))
      sublayer = in.yes_no();
    else if (in.is("viscosity"))
      viscosity = (sd_vans_viscosity) in.choice({"constant", "einstein", "power"});
    else if (in.is("surface")) {
      driven = in.choice({"free", "speed"}) == 1;
      if (driven) u_top = Field::parse(in);
    } else if (in.is("pressure_gradient"))
      dpdx = Field::parse(in);
    else if (in.is("sidewall")) {
      if (in.more() && in.peek() == "off")
        in.word(), width = 0.0;
      else {
        width = in.positive();
        wall_coef = in.not_negative();
      }
    } else if (in.is("radius"))
      radius = in.positive();
    else if (in.is("classes"))
      classes = in.yes_no();
    else if (in.is("class_radii")) {
      class_radii.resize(in.integer(1, 32));
      for (double &a : class_radii) a = in.positive();
    } else if (in.is("grains"))
      point = in.choice({"extended", "point"}) == 1;
    else if (in.is("fluctuation")) {
      fluctuation =
          (decltype(fluctuation)) in.choice({"none", "correlated", "uncorrelated", "depth"});
      if (fluctuation != NO_FLUCTUATION) {
        seed = (uint64_t) in.integer(1, std::numeric_limits<bigint>::max());
        find_bed = in.more() && in.peek() == "auto";
        if (find_bed)
          in.word();
        else
          bed = in.number();
      }
    } else if (in.is("renewal"))
      renewal = in.positive();
    else if (in.is("rules"))
      rules = in.choice({"consistent", "yade"}) == 1 ? SD_VANS_YADE : SD_VANS_CONSISTENT;
    else if (in.is("conserve"))
      conserve = in.yes_no();
    else if (in.is("overlap"))
      overlap_once = in.choice({"twice", "once"}) == 1;
    else if (in.is("region"))
      region = in.word();
    else if (in.is("average"))
      average = in.word();
    else
      in.unknown();
  }

  if (!have_mesh) fail(lmp, command + ": keyword mesh (ncell dz zref, or file NAME) is required");
  if (!have_fluid) fail(lmp, command + ": keyword fluid (density and viscosity) is required");
  if (!have_gravity)
    fail(lmp, command + ": keyword gravity (gx gy gz) is required; its x component is the slope");
  if (rules == SD_VANS_YADE) {
    if (!mesh_file.empty())
      fail(lmp, keyword("mesh") + ": rules yade knows slices of one height only");
    conserve = false;
  }
  if (couple != TWO) conserve = false;

  if (!mesh_file.empty()) {
    edge = read_list(lmp, keyword("mesh"), mesh_file, 0, "");
    if (edge.size() < 3)
      fail(lmp,
           keyword("mesh") + ": file '" + mesh_file + "' has " + std::to_string(edge.size()) +
               " edges, at least 3 are needed");
    z_ref = edge[0];
    for (size_t k = 0; k < edge.size(); k++) {
      edge[k] -= z_ref;
      if (k > 0 && !(edge[k] > edge[k - 1]))
        fail(lmp,
             keyword("mesh") + ": file '" + mesh_file + "': edge " + std::to_string(k + 1) + " (" +
                 text(edge[k] + z_ref) + ") is not above the one before");
    }
  } else
    for (bigint k = 0; k <= equal_cells; k++) edge.push_back(k * dz);
  const size_t N = ncell();

  if (!profile_file.empty()) profile = read_profile(lmp, keyword("profile"), profile_file, ncell());
  if (!convective_file.empty())
    convective = read_list(lmp, keyword("convective"), convective_file, N, "ncell");
  if (!given_file.empty()) {
    const auto rows = read_rows(lmp, keyword("given"), given_file);
    const size_t columns = 3 + 2 * class_radii.size();
    if (rows.size() != N)
      fail(lmp,
           keyword("given") + ": file '" + given_file + "' has " + std::to_string(rows.size()) +
               " rows, ncell = " + std::to_string(N) + " are needed");
    given.assign(columns, std::vector<double>(N));
    for (size_t n = 0; n < N; n++) {
      if (rows[n].size() != columns && rows[n].size() != 3)
        fail(lmp,
             keyword("given") + ": file '" + given_file + "', row " + std::to_string(n + 1) +
                 " has " + std::to_string(rows[n].size()) + " values; phi, velocity and drag" +
                 (columns > 3 ? ", then phi and drag of each of class_radii," : "") +
                 " are needed");
      if (rows[n].size() < given.size()) given.resize(3);
      for (size_t c = 0; c < given.size(); c++) given[c][n] = rows[n][c];
      if (!(rows[n][0] >= 0.0 && rows[n][0] < 1.0))
        fail(lmp,
             keyword("given") + ": file '" + given_file + "': phi = " + text(rows[n][0]) +
                 " in slice " + std::to_string(n + 1) + ", it must be in [0, 1)");
    }
  }
  if (couple == FLUID && given.empty()) given.assign(3, std::vector<double>(N, 0.0));
  if ((couple == TWO || couple == FLUID) && !rest && g[0] == 0.0 && !dpdx.is_variable() &&
      dpdx.number() == 0.0 && !driven && profile.empty())
    fail(lmp,
         command +
             ": nothing drives the stream: give gravity an x component (the slope), "
             "pressure_gradient, surface speed or a "
             "profile, or stream rest");
}

}    // namespace StokesDyn
