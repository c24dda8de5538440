"""One run, from its case to its folder: loop, recording, checkpoints, pictures at the end; going on with it later."""
