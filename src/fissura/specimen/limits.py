"""Every number of this room that decides something: what it limits, why it has its size, what it was measured by.

Where nothing is named, results do not depend on the number within wide bounds; what bounds them is said. Round-off of
coordinates is 1e-16 of the distance from the origin, up to `FARTHEST` times the size of a specimen.
"""

# Round-off

#: Of the extent of the whole: lengths below it are round-off. Planes nearer to each other are one, and so are corners.
#: Coordinates err by up to 1e-12 of the extent, farther from the origin than `FARTHEST` by more.
SAME = 1e-9

#: Components of unit vectors below it are zero: what turning by right angles leaves of them.
CLEAN = 1e-14

#: Of the extent: a plane that cuts off less of a cell only touches it; far below `SAME`, so that no plane is lost.
IN_PLANE = 1e-11

#: Of the squared extent: faces of less area are none.
NO_AREA = 1e-12

#: Volume that three unit normals span: planes that span less meet in no definite point. A corner moves by round-off
#: over this volume, which must stay below `SAME`.
SHARP = 1e-3

#: Share of a length, or of a unit normal, that is round-off where it is compared with another one.
ROUND_OFF = 1e-9

#: Size of a specimen over the distance of its middle from the origin, at most: coordinates beyond are blurred.
FARTHEST = 1e4

# Places, notches

#: Of the extent: points nearer to a flat surface, or a cell, are on it. What is written with six digits is found.
ON_SURFACE = 1e-6

#: Components of unit vectors below it count as none: directions that are parallel or perpendicular as far as a file of
#: six digits can tell.
NO_COMPONENT = 1e-6

#: Sample points of a place in the spacing of fine nuclei, at least, so that even fine bodies take their proper share;
#: sums over all of them are exact (`tests/specimen/test_place.py`).
SAMPLES = 5.0

#: Rows of sample points, at most: surfaces of more bodies than that across are too large for a run.
MOST_ROWS = 1000

# Thin parts (`benchmarks/thin_parts.py`)

#: Thickness of a part in spacings below which it is refused, and below which it is warned of.
LEAST, USUAL = 1.0, 3.0

#: Thickness in spacings below which some facets span a part alone.
SINGLE = 1.5

#: Cosine of the angle between surfaces that count as parallel: those of a wedge of 25 degrees do not.
FACING = 0.9

# Cross-sections

#: Share of the volume that a section must leave on either side: ends of a cylinder seen from its side are no sections.
LEAST_SIDE = 0.1

#: Levels at which the smallest section is sought, at most; between two of them it is exact where no corner lies.
MOST_LEVELS = 400

# Shapes

#: How far a side of a polygon may lie from the arc that it stands for, over `l_f`. With areas kept, both corners
#: and sides stay within a tenth of `l_f` of it, as docs/specimens.md says.
SAGITTA = 0.075

#: Sides of a circle, at least and at most; the latter are enough for circles of 4000 bodies across.
FEWEST_SIDES, MOST_SIDES = 8, 400

#: Sides of a circle in surfaces that gmsh meshes.
SIDES_OF_MESHER = 24

#: Orders in which sides of triangles are tried besides the longest and the shortest first; the least number of parts
#: counts, which is not known to be the least possible.
TRIES = 10

#: Most tetrahedra of a mesh, triangles of a surface, and bytes of a file: their sizes have nothing to do with those of
#: bodies, so that coarse ones do.
MOST_TETRAHEDRA, MOST_TRIANGLES, MOST_BYTES = 100_000, 100_000, 500_000_000

#: Volume of a tetrahedron over the cube of its longest edge: below the first it has none, below the second it is almost
#: flat, and volumes of bodies are exact to 1e-6 only.
FLAT, SLIVER = 1e-10, 1e-3

#: Tetrahedra whose middles are looked for in others, at most: what overlaps does so in many places.
LOOKED_AT = 2000

#: Least coordinate of a mesh [m]: below it a unit is wrong.
LEAST_COORDINATE = 1e-9
