"""Two scenes for films of layers: a jewel beetle and a slick of oil on water. python3 docs/film_scenes.py FOLDER RECIPES writes
beetle.toml and slick.toml with their meshes into FOLDER; RECIPES is the folder of the recipes as FOLDER sees it.

Each thickness of a film has a mesh of its own: a film that is constant over a mesh renders fast live."""

import math
import pathlib
import sys

SCENE = """\
recipe = "{recipe}"

[camera]
position = {position}
look_at = {look_at}
fov_deg = {fov}

[render]
width = 240
height = 240
spp = 256
max_bounces = 4
"""

SKIN = """
[[material]]
name = "{name}"
type = "skin"
film_thickness_nm = {nm}
"""

MESH = SKIN + """
[[object]]
type = "mesh"
file = "{file}"
material = "{name}"
"""

SKY = """
[environment]
color = 5.0
"""

WATER = """
[[object]]
type = "plane"
center = [0.0, 0.0, -0.001]
material = "water"
"""

ROOM = """
[environment]
color = 0.25

[[light]] # softbox overhead
type = "quad"
center = [-0.8, 1.6, 6.5]
edge_u = [0.0, 5.0, 0.0]
edge_v = [5.5, 0.0, 0.0]
radiance = 3.5

[[light]] # strip on the left
type = "quad"
center = [-5.0, 0.0, 1.8]
edge_u = [0.0, 0.0, 3.0]
edge_v = [0.0, -5.0, 0.0]
radiance = 4.0

[[material]]
name = "ground"
type = "diffuse"
albedo = 0.12

[[object]]
type = "plane"
material = "ground"

[[material]]
name = "eye"
type = "gloss"
"""

EYE = """
[[object]]
type = "sphere"
center = [{x}, -0.55, 0.11]
radius = 0.075
material = "eye"
"""


class Meshes:
    """Quads with normals, one mesh for each thickness of the film."""

    def __init__(self):
        self.corners = {}

    def add(self, nm, corners):
        """Each corner is a position and a normal."""
        self.corners.setdefault(nm, []).extend(corners)

    def write(self, scene):
        """Writes the meshes beside the scene; returns what the scene says of them."""
        text = ""
        for nm, corners in sorted(self.corners.items()):
            mesh = scene.with_name(f"{scene.stem}_{nm}.obj")
            rows = ["v %.5f %.5f %.5f\nvn %.4f %.4f %.4f\n" % (*position, *normal) for position, normal in corners]
            rows += ["f " + " ".join(f"{k + i}//{k + i}" for i in range(4)) + "\n" for k in range(1, len(corners), 4)]
            mesh.write_text("".join(rows))
            text += MESH.format(name=f"{nm} nm", nm=nm, file=mesh.name)
        return text


# The slick of oil.

CELLS = 300  # along a side of its square, of half a side 1
THICKEST, STEP = 700, 10  # nm


def stirred(x, y):
    """Where a point was before the water moved."""
    for turn in (1.0, 1.9, 3.4, 6.1):
        x, y = x + 0.3 / turn * math.sin(2.3 * turn * y + turn), y + 0.3 / turn * math.sin(1.9 * turn * x - 2 * turn)
    return x, y


def oil_nm(x, y):
    """Thick where the oil was spilt and nothing far from there, in steps."""
    u, v = stirred(x, y)
    share = 1.25 * math.exp(-1.6 * (u * u + 1.5 * v * v)) + 0.12 * math.sin(3.1 * u - 1) * math.cos(4.3 * v) - 0.18
    edge = min(1, 3 * (1 - max(abs(x), abs(y))))
    return round(max(0, share) * edge * THICKEST / STEP) * STEP


def slick(scene, recipes):
    meshes, d = Meshes(), 2 / CELLS
    for i in range(CELLS):
        for j in range(CELLS):
            x, y = i * d - 1, j * d - 1
            square = ((x, y, 0), (x + d, y, 0), (x + d, y + d, 0), (x, y + d, 0))
            if nm := oil_nm(x + d / 2, y + d / 2):
                meshes.add(nm, [(corner, (0, 0, 1)) for corner in square])
    head = SCENE.format(recipe=f"{recipes}/oil.toml", position=[0, -3.0, 2.7], look_at=[0.02, 0.03, 0], fov=23)
    scene.write_text(head + SKY + SKIN.format(name="water", nm=0) + WATER + meshes.write(scene))


# The beetle. It lies along y with its head at y < 0.

GREEN, PURPLE = 1352, 1745  # nm


def wing_cases(t, turn):
    """t from the shoulders (0) to the tip (1), turn from the right rim (0) to the left one (pi)."""
    width, height = 0.42 * (1 - t ** 2.5) ** 0.75, 0.3 * (1 - t ** 2.2) ** 0.7 * (1 - 0.3 * math.exp(-(t / 0.04) ** 2))
    seam = 1 - 0.07 * math.exp(-((turn - math.pi / 2) / 0.035) ** 2)
    ribs = 1 - 0.008 * (1 + math.cos(32 * turn))
    return width * math.cos(turn), 1.5 * t, height * math.sin(turn) * seam * ribs


def neck_shield(t, turn):
    ends = 1 - 0.3 * math.exp(-(t / 0.12) ** 2) - 0.3 * math.exp(-((1 - t) / 0.1) ** 2)
    width, height = (0.27 + 0.13 * t ** 0.7) * (0.8 + 0.2 * ends), (0.2 + 0.08 * t) * ends
    return width * math.cos(turn), -0.42 + 0.42 * t, height * math.sin(turn)


def head(t, turn):
    size = math.sin(math.pi * (0.1 + 0.5 * t)) ** 0.6
    return 0.22 * size * math.cos(turn), -0.62 + 0.22 * t, 0.17 * size * math.sin(turn)


def is_stripe(part, t, turn):
    return part is wing_cases and abs(abs(turn - math.pi / 2) - 0.62) < 0.17 and t < 0.93


def vertex(part, t, turn):
    """A point of a part and its normal."""
    h = 1e-4
    (x0, y0, z0), (x1, y1, z1) = part(max(0, t - h), turn), part(min(1, t + h), turn)
    (x2, y2, z2), (x3, y3, z3) = part(t, turn - h), part(t, turn + h)
    (a, b, c), (d, e, f) = (x3 - x2, y3 - y2, z3 - z2), (x1 - x0, y1 - y0, z1 - z0)
    n = (c * e - b * f, a * f - c * d, b * d - a * e)
    length = math.hypot(*n) or 1
    return part(t, turn), tuple(v / length for v in n)


def beetle(scene, recipes):
    meshes = Meshes()
    for part, rows in ((wing_cases, 160), (neck_shield, 60), (head, 40)):
        columns = 240
        grid = [[vertex(part, 0.9995 * i / rows, math.pi * j / columns) for j in range(columns + 1)] for i in range(rows + 1)]
        for i in range(rows):
            for j in range(columns):
                nm = PURPLE if is_stripe(part, (i + 0.5) / rows, math.pi * (j + 0.5) / columns) else GREEN
                meshes.add(nm, [grid[i][j], grid[i + 1][j], grid[i + 1][j + 1], grid[i][j + 1]])
    text = SCENE.format(recipe=f"{recipes}/chrysochroa.toml", position=[1.7, -1.6, 5.6], look_at=[0, 0.44, 0.1], fov=17.5)
    scene.write_text(text + ROOM + "".join(EYE.format(x=x) for x in (-0.14, 0.14)) + meshes.write(scene))


def main():
    folder, recipes = pathlib.Path(sys.argv[1]), sys.argv[2]
    slick(folder / "slick.toml", recipes)
    beetle(folder / "beetle.toml", recipes)


main()
