/* A file of VTK's XML format for data on a regular grid (.vti), as ParaView reads it. Numbers stand
 * in it as base64, so that it is valid XML; errors wait until finish(). */
#ifndef SD_IMAGE_FILE_H
#define SD_IMAGE_FILE_H

#include <cstdio>
#include <string>

namespace StokesDyn {

class ImageFile {
 public:
  struct Grid {
    /* [3] first point, spacing; number of points */
    const double *origin, *spacing;
    const int *n;
  };
  ImageFile(const std::string &path, const Grid &grid, double time);
  ~ImageFile();
  ImageFile(const ImageFile &) = delete;
  ImageFile &operator=(const ImageFile &) = delete;

  /* An array of so many components per point, x fastest; type: as VTK calls it. Its bytes may come in
   * several pieces. */
  void begin(const std::string &name, const std::string &type, int components, int bytes);
  void put(const void *data, size_t bytes);
  void end();
  /* Has all been written? A file that did not fit, or has no end, is removed. */
  bool finish();

 private:
  const std::string path;
  FILE *out;
  double points;
  /* bytes that have no group of three yet */
  unsigned char rest[3];
  int waiting = 0;

  void print(const std::string &line);
  void group();
  bool close(bool whole);
};

}    // namespace StokesDyn
#endif
