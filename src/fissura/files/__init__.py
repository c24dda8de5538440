"""Files, there as a whole or not at all; folders of results and who may write there; arrays and text on disk."""
