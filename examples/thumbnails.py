#!/usr/bin/env python3
"""Makes the small pictures of README.md: of each example the first picture of its own README.

    thumbnails.py [NAME ...]"""
import pathlib
import re
import sys

from PIL import Image

HERE = pathlib.Path(__file__).resolve().parent
SIZE = 170, 110


def main():
    for readme in sorted(HERE.glob("*/README.md")):
        folder = readme.parent
        found = re.search(r"!\[[^]]*\]\((\w+\.(?:png|gif))\)", readme.read_text())
        if not found or (sys.argv[1:] and folder.name not in sys.argv[1:]):
            continue
        picture = Image.open(folder / found.group(1))
        picture.seek(getattr(picture, "n_frames", 1) // 2)    # of a film, the middle
        picture = picture.convert("RGB")
        picture.thumbnail(SIZE, Image.LANCZOS)
        (HERE / "thumbnails").mkdir(exist_ok=True)
        picture.quantize(64).save(HERE / "thumbnails" / f"{folder.name}.png", optimize=True)


if __name__ == "__main__":
    main()
