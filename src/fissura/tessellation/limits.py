"""Every number of this room that decides something: what it limits, why it has its size, what it was measured by.

Results do not depend on these numbers within wide bounds; what bounds them is said. `tests/tessellation` compares
volumes, areas and shared corners with exact ones.
"""

# Placement

#: Halvings of voxels, at most: voxels are then 6e-8 of a grid cell, and gaps that are left smaller than that.
MOST_LEVELS = 24

#: Trials for each active voxel before they are divided: fewer divide too often, more fall on covered ground. The
#: structure of a seed depends on it.
TRIALS_PER_VOXEL = 2.0

#: Share of a squared spacing by which given nuclei may be closer to each other: regular grids lose none by round-off.
REGULAR = 1e-9

#: Of a voxel's side: a given nucleus may lie so far outside of a convex cell, on a face.
ON_FACE = 1e-9

#: Of a box's side: planes that reach less into it do not cut.
IN_BOX = 1e-14

#: Of a root's volume: what round-off may leave out of one that lies inside.
FULL = 1e-9

#: Smallest side of a periodic cube in spacings: no body then touches another one twice, or itself.
SMALLEST_SIDE = 4.0

#: Thickness of the layer of images around the cube, in gaps. No point is farther than one gap from a nucleus, so no
#: nucleus farther than two has any influence on a cell; the rest keeps the outer box out of reach.
LAYER = 2.5

# Placement in blocks

#: Levels of spacing, each twice as wide as the one before: the specimen depends on it, so it is the same for all cases.
LEVELS = 5

#: Width of a block in spacings of its level: 2 would do for blocks of one colour to be apart; wider ones have less in
#: common with their neighbours, and more of them that nobody asked for (`benchmarks/placement.py`).
WIDTH = 4

#: Grid cells along a block: their diagonal is 0.99 spacings, so that each holds one nucleus at most.
CELLS = 7

#: Grid cells beyond the faces of a block where it may have nuclei, and within which it leaves room to later blocks:
#: with one, blocks of one colour stay apart, and a block needs eight of the next coarser level.
RIM = 1

#: Trials at random in a cube of one spacing before a block is saturated, and how fast they get fewer beyond its faces:
#: by `exp(-2)` in a grid cell. Density by distance from a face, in layers of a quarter of a spacing, scatters by 6 %
#: (39 % without them, and with blocks that end at their faces), in layers of one spacing by 1 % (16 %).
ARRIVALS, FADING = 12.0, 2.0

#: Identities that a block takes: a power of two above the number of balls of one spacing that its grid may hold, 330.
MOST_IN_BLOCK = 512

#: Share by which a wanted spacing may miss that of a level, by round-off, and still do without finer nuclei; also of
#: a radius.
BELOW = 1e-6

# Files of nuclei

#: Largest files, of numbers and of text [bytes]: what a machine can hold.
MOST_BYTES, MOST_BYTES_OF_TEXT = 2_000_000_000, 100_000_000

#: Of the specimen's size: nuclei nearer to the surface are on it, where round-off would decide about their side.
ON_SURFACE = 1e-9

# Bodies

#: Growth of the squared radius within which further nuclei are sought, one ring after another.
GROWTH = 2.0

#: Of a piece's radius, and of coordinates: planes that reach less into a piece do not cut it.
IN_PIECE, IN_COORDINATES = 1e-13, 1e-15

#: Of their distance: two nuclei are mirror images in a plane when they are less off.
MIRRORED = 1e-8

#: Of a piece's radius: a corner computed again from its planes may lie this far off, else they are almost parallel.
SAME_CORNER = 1e-7

#: Of the squared radius of a body: a smaller opening does not lead to another cell.
NO_OPENING = 1e-10

#: How often a nucleus may come back into a cell from which it was excluded, so that the rounds end.
RETURNS = 3

# Facets

#: Of the squared spacing: smaller facets exist by round-off only.
NEGLIGIBLE = 1e-10

#: Of the volume: what round-off may lose, in general and where convex cells are nearly flat.
LOST, LOST_IN_SLIVERS = 1e-9, 1e-6

#: Height of a convex cell over its longest diagonal, below which it is nearly flat.
SLIVER = 1e-3

#: Cosine of an angle less 1, and distance in sizes of a part of the surface, up to which a facet lies in its plane.
SAME_NORMAL, SAME_PLANE = 1e-6, 1e-6

#: Share of a facet's area below which what lies under a part is round-off.
NOTHING = 1e-9
