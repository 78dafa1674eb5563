"""Moving pictures of the examples: figures of matplotlib, one after the other, as an animated GIF of few colours."""
import io

from runs import plt    # first: it looks for a python with all that is needed
from PIL import Image


def picture(figure):
    """The figure as an image; closes it."""
    with io.BytesIO() as png:
        figure.savefig(png, format="png")
        plt.close(figure)
        return Image.open(png).convert("RGB")


def write(pictures, path, colours=16, each=70):
    """pictures: images of one size; each: milliseconds, where the first and the last one stay longer."""
    palette = pictures[len(pictures) // 2].quantize(colours)
    first, *rest = [image.quantize(palette=palette, dither=Image.Dither.NONE) for image in pictures]
    first.save(path, save_all=True, append_images=rest, duration=[600] + [each] * (len(rest) - 1) + [1500], loop=0,
               optimize=True)


def frames(path):
    return Image.open(path).n_frames
