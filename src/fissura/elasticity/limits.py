"""Every number of this room that decides something: what it limits, and why it has its size."""

#: Sizes of cells and prisms in ``l_min``: smaller ones have bodies that touch themselves, larger ones take gigabytes.
SMALLEST, LARGEST = 4.0, 20.0

#: Most numbers in a list.
MOST_NUMBERS = 100

#: Probability of the intervals that are told, and the `alpha` of concrete, of which pictures over sizes are.
CONFIDENCE, CONCRETE = 0.95, 0.29

#: Distance of the two bands between which gauges measure, and their width, in lengths of the prism. In wide bands many
#: bodies take part, so that single ones do not matter (`benchmarks/elastic_specimens.py`).
GAUGE, BAND = 0.5, 0.2

#: Rounds in which contact constants are looked for that give those of a material as a whole; some ten are enough.
MOST_ROUNDS = 100
