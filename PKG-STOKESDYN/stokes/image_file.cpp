#include "image_file.h"

#include <cstdint>
#include <cstring>

namespace StokesDyn {

static std::string digits(double value)
{
  char buffer[32];
  snprintf(buffer, sizeof(buffer), "%.17g", value);
  return buffer;
}

static std::string three(const double *v)
{
  return digits(v[0]) + " " + digits(v[1]) + " " + digits(v[2]);
}

static const char *byte_order()
{
  const uint16_t one = 1;
  unsigned char first;
  memcpy(&first, &one, 1);
  return first ? "LittleEndian" : "BigEndian";
}

ImageFile::ImageFile(const std::string &path, const Grid &grid, double time) :
    path(path), out(fopen(path.c_str(), "wb")), points((double) grid.n[0] * grid.n[1] * grid.n[2])
{
  std::string extent;
  for (int d = 0; d < 3; d++) extent += (d ? " 0 " : "0 ") + std::to_string(grid.n[d] - 1);
  print("<?xml version=\"1.0\"?>");
  print(std::string("<VTKFile type=\"ImageData\" version=\"1.0\" byte_order=\"") + byte_order() +
        "\" header_type=\"UInt64\">");
  print("<ImageData WholeExtent=\"" + extent + "\" Origin=\"" + three(grid.origin) +
        "\" Spacing=\"" + three(grid.spacing) + "\">");
  print("<FieldData><DataArray type=\"Float64\" Name=\"TimeValue\" NumberOfTuples=\"1\" "
        "format=\"ascii\">" + digits(time) + "</DataArray></FieldData>");
  print("<Piece Extent=\"" + extent + "\">");
  print("<PointData Vectors=\"velocity\">");
}

ImageFile::~ImageFile()
{
  close(false);
}

bool ImageFile::close(bool whole)
{
  if (!out) return false;
  const bool well = !ferror(out);
  const bool kept = fclose(out) == 0 && well && whole;
  out = nullptr;
  if (!kept) remove(path.c_str());
  return kept;
}

void ImageFile::print(const std::string &line)
{
  if (out) fputs((line + "\n").c_str(), out);
}

/* Three bytes are four letters; of fewer, the last letters are =. */
void ImageFile::group()
{
  static const char LETTERS[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  for (int k = waiting; k < 3; k++) rest[k] = 0;
  const unsigned bits = rest[0] << 16 | rest[1] << 8 | rest[2];
  char four[4];
  for (int k = 0; k < 4; k++) four[k] = k <= waiting ? LETTERS[bits >> (18 - 6 * k) & 63] : '=';
  if (out) fwrite(four, 1, 4, out);
  waiting = 0;
}

void ImageFile::put(const void *data, size_t bytes)
{
  const unsigned char *from = static_cast<const unsigned char *>(data);
  for (size_t k = 0; k < bytes; k++) {
    rest[waiting++] = from[k];
    if (waiting == 3) group();
  }
}

/* The number of bytes, encoded on its own, stands before them. */
void ImageFile::begin(const std::string &name, const std::string &type, int components, int bytes)
{
  const uint64_t size = (uint64_t) points * (uint64_t) components * (uint64_t) bytes;
  print("<DataArray type=\"" + type + "\" Name=\"" + name + "\" NumberOfComponents=\"" +
        std::to_string(components) + "\" format=\"binary\">");
  put(&size, sizeof(size));
  if (waiting) group();
}

void ImageFile::end()
{
  if (waiting) group();
  print("\n</DataArray>");
}

bool ImageFile::finish()
{
  print("</PointData>\n</Piece>\n</ImageData>\n</VTKFile>");
  return close(true);
}

}    // namespace StokesDyn
