"""Every number of this room that decides something: what it limits, and why it has its size."""

#: Helpers that share the work well: more would wait for each other.
MOST_HELPERS = 3

#: Time between two looks at a claim of another process [s].
LOOK = 0.01

#: Function that is not in the cache, counted from the start, at which compiling is announced: one alone is quick.
TOLD_AT = 2

#: Compiling that takes less [s] is not worth a word, nor the start of other processes.
SHORT = 2.0
