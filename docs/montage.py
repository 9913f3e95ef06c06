"""Pictures of one size side by side, row by row, with captions above the columns and left of the rows."""

import argparse

from PIL import Image, ImageDraw, ImageFont

GAP = 4  # pixels between pictures
STEP = 4  # values are rounded to its multiples: below the noise of a rendering, and a third less to store
BACKGROUND = "white"
FONT = ImageFont.truetype("/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf", 12)
LINE = sum(FONT.getmetrics())


def rounded(picture):
    return picture.convert("RGB").point(lambda v: min(255, (v + STEP // 2) // STEP * STEP))


def montage(pictures, columns, top, left):
    width, height = pictures[0].size
    rows = -(-len(pictures) // columns)
    margin_x = int(max((FONT.getlength(text) for text in left), default=-2 * GAP)) + 2 * GAP
    margin_y = LINE if top else 0
    sheet = Image.new("RGB", (margin_x + columns * (width + GAP) - GAP, margin_y + rows * (height + GAP) - GAP), BACKGROUND)
    draw = ImageDraw.Draw(sheet)
    for i, text in enumerate(top):
        draw.text((margin_x + i * (width + GAP) + width // 2, 0), text, "black", FONT, "ma")
    for j, text in enumerate(left):
        draw.text((margin_x - GAP, margin_y + j * (height + GAP) + height // 2), text, "black", FONT, "rm")
    for k, picture in enumerate(pictures):
        sheet.paste(rounded(picture), (margin_x + k % columns * (width + GAP), margin_y + k // columns * (height + GAP)))
    return sheet


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("out")
    parser.add_argument("columns", type=int)
    parser.add_argument("pictures", nargs="+")
    parser.add_argument("--top", default="", help="captions of the columns, separated by |")
    parser.add_argument("--left", default="", help="captions of the rows, separated by |")
    arguments = parser.parse_args()
    pictures = [Image.open(name) for name in arguments.pictures]
    if len({picture.size for picture in pictures}) != 1:
        parser.error(f"found sizes {sorted({picture.size for picture in pictures})}; allowed: one size")
    captions = [text.split("|") if text else [] for text in (arguments.top, arguments.left)]
    montage(pictures, arguments.columns, *captions).save(arguments.out, optimize=True)


main()
