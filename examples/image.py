"""Reads the files of fix stokes_dynamics/field (VTK's .vti) as numpy arrays."""
import base64
import xml.etree.ElementTree as xml

import numpy as np

TYPES = {"Float64": "<f8", "UInt8": "u1"}


class Image:
    """Of a file: origin, spacing, n (points along x, y, z), time, and arrays by name: [nz, ny, nx] or [nz, ny, nx,
    3]."""

    def __init__(self, path):
        root = xml.parse(path).getroot()
        image = root.find("ImageData")
        extent = np.array(image.get("WholeExtent").split(), int)
        self.n = extent[1::2] - extent[::2] + 1
        self.origin = np.array(image.get("Origin").split(), float)
        self.spacing = np.array(image.get("Spacing").split(), float)
        self.time = float(image.find("FieldData/DataArray").text)
        self.arrays = {}
        for array in image.find("Piece/PointData"):
            text = array.text.strip()
            size = np.frombuffer(base64.b64decode(text[:12]), "<u8")[0]
            data = base64.b64decode(text[12:])
            assert len(data) == size, (path, array.get("Name"), len(data), size)
            components = int(array.get("NumberOfComponents"))
            shape = tuple(self.n[::-1]) + ((components,) if components > 1 else ())
            self.arrays[array.get("Name")] = np.frombuffer(data, TYPES[array.get("type")]).reshape(shape)

    def __getitem__(self, name):
        return self.arrays[name]

    def axis(self, d):
        return self.origin[d] + self.spacing[d] * np.arange(self.n[d])

    def points(self):
        """[nz, ny, nx, 3]"""
        z, y, x = np.meshgrid(self.axis(2), self.axis(1), self.axis(0), indexing="ij")
        return np.stack([x, y, z], axis=-1)
